#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Compile each public header alone, included twice, as C99 without extensions and, if a C++ compiler
# exists, as C++. The include path has only the folder of the header, base.h and cairo. Output: TAP.
# OPCFLOW_SOURCE: source folder; $@: C compiler.
strict="-fsyntax-only -pedantic-errors -Wall -Wextra -Wundef -Werror"
cxx=${CXX:-$(command -v c++ || command -v g++ || command -v clang++)}
cairo=$(pkg-config --cflags-only-I cairo 2>/dev/null | sed 's/-I/-isystem /g')
number=0

# check NAME SKIP COMMAND...: compile a file that includes the header twice; SKIP is the reason to
# skip the test.
check() {
  name=$1
  reason=$2
  shift 2
  number=$((number + 1))
  if [ -n "$reason" ]; then
    echo "ok $number $name # SKIP $reason"
  elif printf '#include <%s>\n#include <%s>\nextern int x;\n' "$header" "$header" |
    "$@" $strict -I"$include" -I"$base" $cairo - >&2; then
    echo "ok $number $name"
  else
    echo "not ok $number $name"
  fi
}

base="$OPCFLOW_SOURCE/subprojects/base/include"
for include in "$base" "$OPCFLOW_SOURCE/include" "$OPCFLOW_SOURCE/subprojects/eda/include"; do
  for path in "$include"/opcflow/*.h "$include"/eda/*.h; do
    [ -f "$path" ] || continue
    header=${path#"$include/"}
    check "$header as C99" '' "$@" -x c -std=c99
    if [ -n "$cxx" ]; then
      check "$header as C++" '' $cxx -x c++ -std=c++11
    else
      check "$header as C++" 'there is no C++ compiler'
    fi
  done
done
echo "1..$number"
