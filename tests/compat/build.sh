#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Build the plugins that are to be kept, into the folder given or into one called
# after this machine. README.md tells when.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
out=${1:-$here/$(uname -m)}
mkdir -p "$out"
for source in "$here"/compat.*.c; do
  [ -f "$source" ] || continue
  id=$(basename "$source" .c)
  ${CC:-cc} -std=c99 -Os -fPIC -shared -nostartfiles -fvisibility=hidden \
    -fno-asynchronous-unwind-tables -ffp-contract=off -Wall -Wextra -Werror \
    -I"$root/include" -I"$root/subprojects/base/include" \
    -I"$root/subprojects/eda/include" "$source" -o "$out/$id.so" \
    -Wl,-s,--build-id=none,-z,noseparate-code,--hash-style=gnu,--allow-shlib-undefined
  strip --remove-section=.comment "$out/$id.so"
done
