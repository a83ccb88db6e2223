#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Build the kept plugins anew, into the folder given or into one called after
# this machine. README.md tells when.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=${1:-$here/$(uname -m)}
mkdir -p "$out"
for source in "$here"/compat.*.c; do
  id=$(basename "$source" .c)
  ${CC:-cc} -std=c99 -Os -fPIC -shared -nostartfiles -fvisibility=hidden \
    -fno-asynchronous-unwind-tables -ffp-contract=off -Wall -Wextra -Werror \
    -I"$here/../../include" "$source" -o "$out/$id.so" \
    -Wl,-s,--build-id=none,-z,noseparate-code,--hash-style=gnu
  strip --remove-section=.comment "$out/$id.so"
done
