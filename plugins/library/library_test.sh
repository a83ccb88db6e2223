#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The library of corrected cells: a cell in each of the eight orientations, and which
# cells are corrected again.
# library_test.sh OPCFLOW
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

# A layout of NAND2 in an orientation, as CIF has it; W of its n-transistors can
# be changed.
layout() {
  sed -e '/^C 1;/,$d' -e "s/ 600 / $2 /;s/ 600 / $2 /;s/ 600;/ $2;/" "$OPCFLOW_SOURCE/data/cells65/nand2.cif"
  printf 'DS 2 1 10;\n9 top;\nC 1 %s T 1230 4560;\nDF;\nC 2;\nE\n' "$1"
}

run() {
  out=$work/run
  "$opcflow" run "$work/flow.yaml" --force --output "$out" "$@" >"$work/log" 2>&1
}

# metric STEP NAME: its value
metric() {
  python3 -c 'import json,sys; print(json.load(open(sys.argv[1]))[sys.argv[2]][sys.argv[3]]["value"])' \
    "$out/metrics.json" "$1" "$2"
}

is() { [ "$(metric "$1" "$2")" = "$3" ]; }
below() { python3 -c 'import sys; sys.exit(not float(sys.argv[1]) < float(sys.argv[2]))' "$(metric "$1" "$2")" "$3"; }
says() { grep -q "$1" "$work/log"; }
exits() { [ "$code" = "$1" ]; }

cat >"$work/flow.yaml" <<FLOW
opcflow: 1
extends: $OPCFLOW_SOURCE/flows/library.yaml
name: test
steps:
  layout: { use: read.cif, file: $work/r0.cif, layers: { poly: CP, active: CA, contact: CC, nwell: CW } }
  sheet: { neighbours: none }
  library: { fine: off }
  placed: { fine: off, picture: ~ }
  mask: ~
  gds: { use: write.cif, mask: "\${placed}", file: mask.cif }
FLOW

layout "" 600 >"$work/r0.cif"
layout "" 610 >"$work/wider.cif"
run
check "a cell is corrected" is library corrected 1.0
cp "$out/mask.cif" "$work/mask.cif"

# Turned back, the placed mask is that of the cell, corner by corner.
same_mask() {
  python3 - "$work/mask.cif" "$out/mask.cif" "$1" <<'PY'
import re, sys
def turn(text):
    m = (1, 0, 0, 1)
    for word in re.findall(r'M [XY]|R -?\d+ -?\d+', text):
        if word == 'M X': a = (-1, 0, 0, 1)
        elif word == 'M Y': a = (1, 0, 0, -1)
        else:
            x, y = map(int, word.split()[1:])
            a = (x, -y, y, x)
        m = (a[0]*m[0]+a[1]*m[2], a[0]*m[1]+a[1]*m[3], a[2]*m[0]+a[3]*m[2], a[2]*m[1]+a[3]*m[3])
    return m
def cells(path, m):
    """The unit squares' edges as sets: vertical edges of each polygon, turned."""
    shapes, layer, scale = set(), None, 1
    for command in open(path).read().split(';'):
        words = command.split()
        if words[:1] == ['L']: layer = words[1]
        if words[:1] == ['B']:
            w, h, x, y = map(int, words[1:5])
            corners = [(x-w//2, y-h//2), (x-w//2+w, y-h//2), (x-w//2+w, y-h//2+h), (x-w//2, y-h//2+h)]
        elif words[:1] == ['P']:
            v = list(map(int, words[1:]))
            corners = list(zip(v[::2], v[1::2]))
        else: continue
        turned = [((m[0]*(x-1230*S)+m[1]*(y-4560*S)), (m[2]*(x-1230*S)+m[3]*(y-4560*S))) for x, y in corners]
        shapes.add((layer, frozenset(turned)))
    return shapes
S = 1
for command in open(sys.argv[1]).read().split(';'):
    w = command.split()
    if w[:1] == ['P'] and max(map(abs, map(int, w[1:]))) > 20000: S = 10
a, b = cells(sys.argv[1], turn(sys.argv[3])), cells(sys.argv[2], (1, 0, 0, 1))
if a != b or not a:
    print(len(a), len(b), len(a ^ b))
sys.exit(a != b or not a)
PY
}
for turn in "R 0 1" "R -1 0" "R 0 -1" "M X" "M Y" "M X R 0 1" "M Y R 0 1"; do
  layout "$turn" 600 >"$work/turned.cif"
  run --set "layout.file=$work/turned.cif"
  check "$turn: the mask is the cell's, turned" same_mask "$turn"
  check "$turn: it prints as in the cell" below placed disturbance_max 0.01
done
check "the cell was not corrected again" is library kept 1.0

run --set "layout.file=$work/wider.cif"
check "a changed cell is" is library corrected 1.0

# The library of one layout, the circuit of another.
sed "s#  layout: {.*#&\n  other: { use: read.cif, file: $work/wider.cif, layers: { poly: CP, active: CA, contact: CC, nwell: CW } }\n  gates: { layout: '\${other}' }#; s#placed: {#placed: { layout: '\${other}',#" \
  "$work/flow.yaml" >"$work/two.yaml"
cp "$work/flow.yaml" "$work/one.yaml"
cp "$work/two.yaml" "$work/flow.yaml"
run
code=$?
check "a cell that is not as in the library: exit 2" exits 2
check "and says which" says "cell 'nand2' differs in the library"
sed 's/^9 nand2/9 other/' "$work/wider.cif" >"$work/other.cif"
sed -i "s#$work/wider.cif#$work/other.cif#" "$work/flow.yaml"
run
code=$?
check "a cell that is not in the library: exit 2" exits 2
check "and says which" says "cell 'other' is missing"
run --set placed.missing=drawn
check "or is as drawn" is placed unknown 4.0
cp "$work/one.yaml" "$work/flow.yaml"
run --set placed.litho.na=0.74
code=$?
check "another process: exit 2" exits 2
check "and says what differs" says "the library was built with another litho"

# ---- illumination that is not equivalent in all orientations ----

# A dipole images lines along x unlike lines along y. Mirrored lines are equivalent.
dipole() {
  layout "$1" 600 >"$work/turned.cif"
  run --set "layout.file=$work/turned.cif" \
    --set "library.litho={ use: litho.hopkins, wavelength: 193 nm, na: 0.75, source: dipole, sigma: 0.9, sigma_in: 0.6 }" \
    --set "placed.litho={ use: litho.hopkins, wavelength: 193 nm, na: 0.75, source: dipole, sigma: 0.9, sigma_in: 0.6 }"
}
dipole "M X"
check "a mirrored cell by a dipole" is placed unknown 0.0
dipole "R 0 1"
code=$?
check "a turned one: exit 2" exits 2
check "and says why" says "cell 'nand2' is rotated by 90 degrees, and the optics image this orientation differently"

# ---- without prints, and by cheap ones ----

run
cp "$out/mask.cif" "$work/printed.cif"
run --set placed.print=false
check "placed without a print: the same mask" cmp -s "$work/printed.cif" "$out/mask.cif"
check "and no disturbance is written" test ! -e "$out/disturbance.csv"
run --set placed.print=false --set placed.picture=d.png
code=$?
check "a picture of it: exit 2" exits 2

# Two cells side by side, which are not as alone.
sed 's/^C 1 .*;$/C 1 T 0 0;\nC 1 T 1700 0;/' "$work/r0.cif" >"$work/pair.cif"
near() { python3 -c 'import sys; a, b, most = map(float, sys.argv[1:]); sys.exit(not abs(a - b) < most)' "$@"; }
sed '/^  mask: ~/d' "$work/one.yaml" >"$work/flow.yaml"
set -- --set "layout.file=$work/pair.cif" --set library.fine=5e-5 --set mask.max_diff=0 --set "placed.margin=3 um"
run "$@"
check "the circuit disturbs its cells" near "$(metric mask refined)" 6 2.5
check "refining takes that back" near "$(metric mask ion_mean)" 0 "$(metric placed disturbance_mean)"
check "by four cheap prints of each layer at most" near "$(metric mask simulations)" 0 8.5
check "and no fine one" is mask fine_simulations 0.0
cheap=$(metric placed ion_mean)
# Transistors on the far sides print as those of a single cell. The fast simulation
# alone does not show this: it deviates by up to 0.15 %.
far_as_alone() {
  python3 - "$out/disturbance.csv" <<'PY'
import csv, sys
off = [abs(float(r["disturbance (%)"])) for r in csv.DictReader(open(sys.argv[1]))]
sys.exit(not (len(off) == 8 and sorted(off)[3] < 0.01))
PY
}
check "fast and fine simulation find the same reach" far_as_alone
run "$@" --set placed.fine=5e-5
check "which it does" near "$cheap" "$(metric placed ion_mean)" 0.05
cp "$work/one.yaml" "$work/flow.yaml"

# ---- kept cells ----

# A marker of the circuit over a cell: its transistors are none of the library's.
rm -rf "$work/store"
table=$OPCFLOW_SOURCE/data/devices/ptm65.yaml
{
  cat "$table"
  echo ---
  sed 's/^opcflow-devices: 1/&\nflavour: lvt/' "$table"
} >"$work/two.yaml"
sed 's/^C 1 /L LV;\nB 60000 60000 1230 4560;\n&/' "$work/r0.cif" >"$work/marked.cif"
run --set "library.extractor.devices=$work/two.yaml" --set "placed.extractor.devices=$work/two.yaml"
code=$?
check "two flavours: exit 0" exits 0
run --set "library.extractor.devices=$work/two.yaml" --set "placed.extractor.devices=$work/two.yaml" \
  --set "layout.file=$work/marked.cif" --set 'layout.layers.lvt=LV' --set 'gates.flavours={ lvt: lvt }'
code=$?
check "a marker over a cell: exit 2" exits 2
check "and says so" says "4 of 4 transistors are not in the library.*flavour"

# A correction that depends on more than the settings and the cell is not kept.
rm -rf "$work/store"
run --set 'library.resist.anchor.gates=${cells}'
code=$?
check "an anchor of the layout's gates: exit 2" exits 2
check "and says why" says "resist (resist.threshold): results kept beyond a run cannot depend on 'cells'"

# After kills at random moments, the cells that are kept are those of a whole run.
rm -rf "$work/store"
run
cp "$out/mask.cif" "$work/whole.cif"
for wait in 0.01 0.05 0.1 0.15 0.2; do
  timeout -s KILL "$wait" "$opcflow" run "$work/flow.yaml" --force --output "$work/killed" \
    --set "layout.file=$work/wider.cif" >"$work/log" 2>&1
done
run --set "layout.file=$work/pair.cif"
check "after kills, the cell is kept" is library kept 1.0
run --no-cache
check "without a store, it is corrected" is library corrected 1.0
check "to the same mask" cmp -s "$work/whole.cif" "$out/mask.cif"
echo "1..$number"
exit $failed
