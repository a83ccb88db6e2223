#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Run the flow with the plugins of this project, and check the metrics of the
# run by the verb of command.metrics: run.sh OPCFLOW FLOW FOLDER.
set -eu
opcflow=$1 flow=$2 folder=$3

fail() {
  echo "$*" >&2
  exit 1
}

"$opcflow" run --force --output "$folder" "$flow"
"$opcflow" metrics --step worst "$folder" | tee /dev/stderr |
  grep -q '^worst *worst *% ' || fail "no metric of list.worst"
"$opcflow" metrics --json "$folder" | grep -q '"slower"' ||
  fail "no metric of list.delays"
grep -q '"synthesizer.bisect"' "$folder/manifest.json" ||
  fail "the manifest does not name synthesizer.bisect"

# The largest deviation must be below 1 %.
worst=$(sed -n '2s/.*,//p' "$folder/worst.csv" | tr -d '\r-')
echo "$worst" | awk '{ exit !($1 > 0 && $1 < 1) }' ||
  fail "worst deviation: $worst %"
