#!/usr/bin/env python3
# Copyright (c) the opcflow authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulate the device table ptm65.yaml from the PTM 65 nm bulk card with ngspice.

    python3 make_ptm65.py CARD [OUTPUT]         (default output: ptm65.yaml here)

For every drawn length one transistor is biased on (|Vgs| = |Vds| = supply) and
one off (Vgs = 0, |Vds| = supply), each in a circuit of its own: ngspice does not
converge well with all in one.  The card is used as it is, but for igbmod = 0;
README.md says why.
"""

import os
import re
import subprocess
import sys
import tempfile

SUPPLY = 1.1                    # V
TEMPERATURE = 27                # C
WIDTH = 10                      # um
LENGTHS = range(44, 121)        # nm, drawn
MODELS = ("nmos", "pmos")
STATES = ("ion", "ioff")


def deck(card, model, state, length):
    sign = -1 if model == "pmos" else 1
    gate = sign * SUPPLY if state == "ion" else 0
    return f"""device table
.include "{card}"
.options temp={TEMPERATURE} gmin=1e-15 reltol=1e-6 abstol=1e-15
m1 drain gate 0 0 {model} w={WIDTH}u l={length}n
vdrain drain 0 {sign * SUPPLY}
vgate gate 0 {gate}
.control
set numdgt=12
altermod {model} igbmod = 0
op
print i(vdrain)
.endc
.end
"""


def ngspice(*arguments):
    result = subprocess.run(("ngspice",) + arguments, capture_output=True, text=True, check=False)
    return result.stdout + result.stderr


def current(card, *case):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "table.sp")
        with open(path, "w") as file:
            file.write(deck(card, *case))
        output = ngspice("-b", path)
    found = re.search(r"^i\(vdrain\) = (\S+)", output, re.MULTILINE)
    if not found:
        sys.exit(f"ngspice gave no current for {case}:\n{output}")
    return abs(float(found.group(1)))


def simulate(card):
    cases = [(model, state, length) for model in MODELS for state in STATES for length in LENGTHS]
    return {case: current(os.path.abspath(card), *case) for case in cases}


def check(table):
    for model in MODELS:
        for state in STATES:
            values = [table[model, state, length] for length in LENGTHS]
            if any(b >= a or b <= 0 for a, b in zip(values, values[1:])):
                sys.exit(f"{model} {state} does not fall steadily with length")


def flow_list(values, indent):
    """A YAML list in brackets, broken into lines of eight."""
    values = list(values)
    rows = [", ".join(values[i:i + 8]) for i in range(0, len(values), 8)]
    return "[" + (",\n" + " " * indent).join(rows) + "]"


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__.strip())
    here = os.path.dirname(os.path.abspath(__file__))
    output = sys.argv[2] if len(sys.argv) == 3 else os.path.join(here, "ptm65.yaml")
    version = re.search(r"ngspice-\S+", ngspice("--version")).group()
    table = simulate(sys.argv[1])
    check(table)

    lengths = flow_list((str(length) for length in LENGTHS), 28)
    lines = ["# On and off current against drawn channel length, from the PTM 65 nm bulk card;",
             "# simulated by make_ptm65.py.",
             "opcflow-devices: 1",
             "name: PTM 65 nm bulk",
             f"source: PTM 65 nm bulk BSIM4 card of 2006-02-22, simulated with {version}",
             f"supply: {SUPPLY} V",
             f"temperature: {TEMPERATURE} C",
             f"width: {WIDTH} um",
             'ion: "Vgs = Vds = supply"',
             'ioff: "Vgs = 0, Vds = supply"',
             f"length: {{unit: nm, values: {lengths}}}"]
    for model in MODELS:
        lines.append(f"{model}:")
        for state in STATES:
            values = flow_list((f"{table[model, state, length]:.6e}" for length in LENGTHS), 12)
            lines += [f"  {state}: {{unit: A, values:", f"           {values}}}"]
    with open(output, "w", newline="\n") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
