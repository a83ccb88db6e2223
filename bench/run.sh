#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Run benchmark programs one after another; fail if a program fails.
code=0
for program in "$@"; do
  "$program" || code=1
done
exit $code
