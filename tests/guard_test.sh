#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Test the guard of the step `correct`, which reverts displacements that made a transistor
# worse, for each method. If a transistor deviates more than on the drawn mask and more
# than the limit, its row in gates.csv must name a rule or a neighbour as the reason.
# Without the guard, some transistors are worse without a reason. Accurate simulation of
# the drawn mask determines Ion to a tenth of the limit, 0.05 %.
set -u
opcflow=$OPCFLOW_BUILD/opcflow
cells=$OPCFLOW_SOURCE/data/cells65
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# correct METHOD LAYOUT [--set ...]: correct a layout; gates.csv lists the transistors
correct() {
  local method=$1 layout=$2
  shift 2
  "$opcflow" run "$OPCFLOW_SOURCE/flows/$method.yaml" --quiet --force --output "$work/run" \
    --set 'picture=~' --set 'gds=~' --set 'cost=~' --set "layout=$layout" "$@" >"$work/said" 2>&1
  [ $? -le 1 ] || { sed 's/^/# /' "$work/said"; return 1; }
}

# Print three numbers: of worse transistors, of worse transistors without a reason, and of
# all transistors.
count() {
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i }; next }
    { was = $at["ion_before"]; is = $at["ion_after"]
      lost = is == "" && was != ""
      if (was < 0) was = -was
      if (is < 0) is = -is
      if (was < 0.5) was = 0.5
      if (!lost && (was == "" || is <= was + 0.0515)) next
      worse++
      # The verdict contains a comma and is therefore in quotes.
      if (lost || $0 !~ /"(rule: |neighbour )[^"]*at \(/) unnamed++ }
    END { print worse + 0, unnamed + 0, NR - 1 }' "$work/run/gates.csv"
}

sram="{ use: read.gds, file: $cells/sram4.gds, layers: { poly: 9/0, active: 1/0, contact: 10/0, nwell: 3/0 } }"
chain="{ use: read.cif, file: $cells/inverter_chain.cif, layers: { poly: CP, active: CA, contact: CC, nimplant: CSN, pimplant: CSP } }"

echo 1..10
n=0
report() { # RESULT NAME
  n=$((n + 1))
  [ "$1" = 0 ] && echo "ok $n - $2" || echo "not ok $n - $2"
}

for method in pb dpb ic epe newton; do
  if [ "$1" = sanitized ] && [ $method != newton ]; then
    report 0 "with $method, each worse transistor has a reason # SKIP sanitized, other tests run this code"
    continue
  fi
  result=0
  for layout in "$sram" "$chain"; do
    correct $method "$layout" --set mask.guard=on || { result=1; continue; }
    read -r worse unnamed all < <(count)
    echo "# $method: $worse of $all worse than drawn, $unnamed of them without a reason"
    [ "$all" -ge 100 ] && [ "$unnamed" = 0 ] || result=1
  done
  report $result "with $method, each worse transistor has a reason"
done

correct ic "$sram" --set mask.guard=off
read -r worse unnamed all < <(count)
[ "$worse" -gt 0 ] && [ "$unnamed" = "$worse" ] &&
  grep -q "guard: off: $worse transistors are worse than drawn" "$work/said"
report $? "without the guard some are worse, and a message reports them ($worse of $all)"

# says TEXT NAME: test that the last run printed TEXT.
says() {
  grep -q "$1" "$work/said"
  report $? "$2"
}

exchanged="{ use: read.gds, file: $cells/sram4.gds, layers: { poly: 1/0, active: 9/0, contact: 10/0, nwell: 3/0 } }"
small="{ use: read.gds, file: $cells/sram4.gds, scale: 0.66, layers: { poly: 9/0, active: 1/0, contact: 10/0, nwell: 3/0 } }"
correct newton "$exchanged"
says 'transistors are drawn longer than wide: check that the layers poly and active are not exchanged' \
  'exchanged layers are reported'
correct newton "$small"
says 'are drawn with lengths (42.9 to 42.9 nm) beyond the device table (44 to 120 nm): check the .scale. of the layout' \
  'a missing scale is reported'
says '^finding: mask: no transistor of the drawn mask prints: check the .scale. of the layout' \
  'a layout that does not print as drawn is reported'
says "^finding: mask: results of [0-9]* of 192 transistors are extrapolated beyond the device table" \
  'figures from outside the device table are reported'
