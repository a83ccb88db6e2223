#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Build the plugins from source/ and headers/ for this machine: `build.sh FOLDER_OF_LIBEDA
# [OUT]`. README.md says when this is done.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=${2:-$here/$(uname -m)}
mkdir -p "$out"
for source in "$here"/source/*.c; do
  id=$(basename "$source" .c)
  ${CC:-cc} -std=gnu99 -Os -fPIC -shared -nostartfiles -fvisibility=hidden \
    -fno-asynchronous-unwind-tables -ffp-contract=off -Wall -Wextra -Werror \
    -I"$here/headers" "$source" -o "$out/$id.so" -Wl,--as-needed "$1/libeda.so.0" \
    -Wl,-s,--build-id=none,-z,noseparate-code,--hash-style=gnu,--allow-shlib-undefined
  strip --remove-section=.comment "$out/$id.so"
done
