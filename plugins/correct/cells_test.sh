#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The results store keeps corrected cells for other layouts, and only for equal cells and
# settings.
# cells_test.sh OPCFLOW
set -u
opcflow=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
number=0 failed=0
export OPCFLOW_STORE=$work/store

# check NAME CONDITION...
check() {
  name=$1
  shift
  number=$((number + 1))
  if "$@"; then echo "ok $number $name"; else
    echo "not ok $number $name"
    failed=1
    sed 's/^/# /' "$work/log"
  fi
}

# A layout with NAND2 in two orientations, as CIF; W of its n-transistors can be changed.
layout() {
  sed -e '/^C 1;/,$d' -e "s/ 600 / $2 /;s/ 600 / $2 /;s/ 600;/ $2;/" "$OPCFLOW_SOURCE/data/cells65/nand2.cif"
  printf 'DS 2 1 10;\n9 top;\nC 1 T 60000 0;\nC 1 %s T 1230 4560;\nDF;\nC 2;\nE\n' "$1"
}

run() {
  out=$work/run
  "$opcflow" run "$work/flow.yaml" --force --output "$out" "$@" >"$work/log" 2>&1
}

# metric NAME: its value
metric() {
  python3 -c 'import json,sys; print(json.load(open(sys.argv[1]))["mask"][sys.argv[2]]["value"])' "$out/metrics.json" "$1"
}
is() { [ "$(metric "$1")" = "$2" ]; }

cat >"$work/flow.yaml" <<FLOW
opcflow: 1
extends: $OPCFLOW_SOURCE/flows/library.yaml
name: test
steps:
  layout: { use: read.cif, file: $work/r0.cif, layers: { poly: CP, active: CA, contact: CC, nwell: CW } }
  mask: { fine: off, verify: false, max_diff: ~ }
  gds: { use: write.gds, mask: "\${mask}", file: mask.gds }
FLOW
layout "" 600 >"$work/r0.cif"
layout "M X R 0 1" 600 >"$work/turned.cif"
layout "" 610 >"$work/wider.cif"

run
check "a cell is corrected once" is cells_corrected 1.0
cp "$out/mask.gds" "$work/mask.gds"
run --set "layout.file=$work/turned.cif"
check "another layout reuses the cell" is cells_corrected 0.0
run --set "layout.file=$work/wider.cif"
check "a changed cell is corrected" is cells_corrected 1.0
run --set mask.litho.na=0.74
check "a cell of another process is corrected" is cells_corrected 1.0
run --set mask.ion_limit="0.4 %"
check "a cell with another limit is corrected" is cells_corrected 1.0
run --set mask.rounds=1 --set mask.window="50 um"
check "a setting that does not concern the cell reuses the cell" is cells_corrected 0.0
run --no-cache
check "without a store, the cell is corrected" is cells_corrected 1.0
check "to the same mask" cmp -s "$work/mask.gds" "$out/mask.gds"

# A dipole images lines along x unlike lines along y.
run --set "layout.file=$work/turned.cif" \
  --set "mask.litho={ use: litho.hopkins, wavelength: 193 nm, na: 0.75, source: dipole, sigma: 0.9, sigma_in: 0.6 }"
check "transistors of a turned cell are corrected in place" is outside_cells 2.0

# After kills at random moments, the cells that are kept are those of a whole run.
rm -rf "$work/store"
for wait in 0.01 0.05 0.1 0.15 0.2; do
  timeout -s KILL "$wait" "$opcflow" run "$work/flow.yaml" --force --output "$work/killed" >"$work/log" 2>&1
done
run
check "after kills, the mask is the same" cmp -s "$work/mask.gds" "$out/mask.gds"

# A placed transistor that deviates by less than max_diff, but by more than as drawn, is refined.
name="a refined layout has no transistor that is worse than drawn"
c17=${OPCFLOW_TEST_DATA:-$OPCFLOW_SOURCE/../shared/data}/iscas85/c17/c17.gds
if [ -f "$c17" ]; then
  out=$work/run
  "$opcflow" run "$OPCFLOW_SOURCE/flows/library-methods.yaml" --variant dpb_2 --force --output "$out" \
    --set "layout.file=$c17" --set layout.scale=1.3 --set layout.layers.outline=235/0 \
    --set mask.neighbours=outline >"$work/log" 2>&1
  check "$name" is worse 0.0
else
  number=$((number + 1))
  echo "ok $number $name # SKIP $c17 is missing"
fi
echo "1..$number"
exit $failed
