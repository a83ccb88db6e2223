#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Each public header by itself, in any order with itself: as C99 without
# extensions and, where there is a compiler for it, as C++. TAP.
# OPCFLOW_SOURCE: the tree; $@: the C compiler.
include=$OPCFLOW_SOURCE/include
strict="-fsyntax-only -pedantic-errors -Wall -Wextra -Wundef -Werror -I$include"
cxx=${CXX:-$(command -v c++ || command -v g++ || command -v clang++)}
number=0

# NAME SKIP COMMAND...: compile a file that includes the header twice.
check() {
  name=$1
  reason=$2
  shift 2
  number=$((number + 1))
  if [ -n "$reason" ]; then
    echo "ok $number $name # SKIP $reason"
  elif printf '#include <opcflow/%s>\n#include <opcflow/%s>\n' \
    "$header" "$header" | "$@" - >&2; then
    echo "ok $number $name"
  else
    echo "not ok $number $name"
  fi
}

for path in "$include"/opcflow/*.h; do
  header=$(basename "$path")
  check "$header as C99" '' "$@" -x c -std=c99 $strict
  if [ -n "$cxx" ]; then
    check "$header as C++" '' $cxx -x c++ -std=c++11 $strict
  else
    check "$header as C++" 'there is no C++ compiler'
  fi
done
echo "1..$number"
