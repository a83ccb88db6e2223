#!/usr/bin/env python3
# Copyright (c) the opcflow authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fit the BSIM4 card opcflow65.pm to the device table ptm65.yaml.

    python3 fit_opcflow65.py [OUTPUT]           (default: opcflow65.pm here)

Needs scipy and the shared library of ngspice.  The fit uses the logarithms of the
on and off currents from 54 to 82 nm, in units of 0.3 % and 3 %.  Lengths from 50 to
120 nm and the shares of Ion at three other voltages have less weight.  Fixed values
are round ones for a 65 nm bulk process; parameters that are not in the card have
BSIM4's default.
"""

import ctypes
import os
import re
import sys

import numpy
from scipy.optimize import least_squares

HERE = os.path.dirname(os.path.abspath(__file__))
LENGTHS = [50, 52, 54, 55, 56, 57, 58, 60, 62, 64, 65, 66, 68, 70, 73, 76, 80, 82, 90, 100, 110, 120]
SUPPLY = 1.1
# Gate and drain voltage, and the round share of Ion that flows there at 65 nm:
# the table does not contain how a transistor switches.
SHAPE = [(0.8, 1.1, 0.6), (0.55, 1.1, 0.28), (1.1, 0.05, 0.15)]

FIXED = {
    "level": "54", "version": "4.5", "binunit": "1", "paramchk": "1",
    "mobmod": "0", "capmod": "2", "rdsmod": "0", "tnom": "27",
    "toxe": "1.8e-9", "nsd": "2e20", "ngate": "2e20",
    "k1": "0.4", "k2": "0", "k3": "0", "dvt0w": "0", "delta": "0.01", "bgidl": "2.3e8",
    "cjs": "5e-4", "cjd": "5e-4", "cjsws": "5e-10", "cjswd": "5e-10",
    "cjswgs": "3e-10", "cjswgd": "3e-10",
}

# name: (least, first, largest)
FITTED = {
    "nmos": {
        "vth0": (0.2, 0.42, 0.7), "u0": (0.01, 0.04, 0.065), "vsat": (4e4, 1.2e5, 4e5),
        "lint": (1.2e-8, 1.9e-8, 2.2e-8), "rdsw": (20, 160, 400), "nfactor": (0.8, 1.8, 3.5),
        "voff": (-0.2, -0.12, -0.02), "eta0": (1e-4, 0.006, 0.3), "dsub": (0.02, 0.1, 1.5),
        "dvt0": (0.05, 1, 6), "dvt1": (0.2, 2, 4), "pclm": (0.005, 0.05, 3),
        "cdscd": (0, 1e-5, 5e-3), "lpe0": (-2e-8, 0, 3e-8), "a0": (0.05, 1, 5),
        "ndep": (1e18, 2.5e18, 7e18), "agidl": (1e-11, 3e-9, 1e-7),
        "voffl": (-6e-9, 0, 6e-9), "minv": (-1, 0, 1), "xj": (1e-8, 2e-8, 4e-8),
        "pdiblc1": (5e-4, 1e-2, 0.5), "pdiblc2": (1e-5, 1e-3, 2e-2), "ua": (1e-10, 6e-10, 3e-9),
    },
}
FITTED["pmos"] = dict(FITTED["nmos"], vth0=(-0.7, -0.38, -0.2), u0=(0.003, 0.007, 0.02),
                      vsat=(3e4, 8e4, 4e5))


def column(text, model, state):
    """The values of a current, or of the lengths, in the table."""
    part = text if model is None else text[text.index(f"\n{model}:"):]
    found = re.search(rf"{state}: *{{unit: \w+, values:\s*\[([^]]*)\]", part)
    return [float(value) for value in found.group(1).split(",")]


def read_table():
    with open(os.path.join(HERE, "ptm65.yaml")) as file:
        text = file.read()
    place = [column(text, None, "length").index(length) for length in LENGTHS]
    return {(model, state): numpy.array([column(text, model, state)[i] for i in place])
            for model in ("nmos", "pmos") for state in ("ion", "ioff")}


def card(model, values):
    known = dict(FIXED, **{name: f"{value:.5g}" for name, value in values.items()})
    lines = [f".model {model} {model}"]
    items = [f"{name} = {value}" for name, value in known.items()]
    lines += ["+ " + "  ".join(items[i:i + 5]) for i in range(0, len(items), 5)]
    return "\n".join(lines) + "\n"


class Simulator:
    """ngspice's shared library, which has one circuit at a time."""

    class Vector(ctypes.Structure):
        _fields_ = [("name", ctypes.c_char_p), ("type", ctypes.c_int), ("flags", ctypes.c_short),
                    ("real", ctypes.POINTER(ctypes.c_double)), ("complex", ctypes.c_void_p),
                    ("length", ctypes.c_int)]

    def __init__(self):
        said = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_char_p, ctypes.c_int, ctypes.c_void_p)
        ended = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int, ctypes.c_bool, ctypes.c_bool,
                                 ctypes.c_int, ctypes.c_void_p)
        thread = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_bool, ctypes.c_int, ctypes.c_void_p)
        self.callbacks = (said(lambda *_: 0), ended(lambda *_: sys.exit("ngspice gave up")),
                          thread(lambda *_: 0))
        self.library = ctypes.CDLL("libngspice.so.0")
        self.library.ngGet_Vec_Info.restype = ctypes.POINTER(self.Vector)
        self.library.ngSpice_Init(self.callbacks[0], None, self.callbacks[1], None, None,
                                  self.callbacks[2], None)
        self.command("set num_threads=1")

    def command(self, text):
        self.library.ngSpice_Command(text.encode())

    def circuit(self, lines):
        self.library.ngSpice_Circ((ctypes.c_char_p * (len(lines) + 1))(
            *[line.encode() for line in lines], None))

    def value(self, name):
        found = self.library.ngGet_Vec_Info(name.encode())
        good = found and found.contents.length == 1 and found.contents.real
        return found.contents.real[0] if good else float("nan")


def currents(simulator, model, values):
    """Ion and Ioff at all lengths, of W = 10 um, and the shares of SHAPE; None if
    the card will not do."""
    sign = -1 if model == "pmos" else 1
    simulator.circuit(["fit", *card(model, values).splitlines(),
                       ".options temp=27 gmin=1e-15 reltol=1e-6 abstol=1e-15",
                       f"m1 drain gate 0 0 {model} w=10u l=100n",
                       f"vdrain drain 0 {sign * SUPPLY}", "vgate gate 0 0", ".end"])
    found, shape = {}, []
    for state, gate in (("ion", sign * SUPPLY), ("ioff", 0)):
        simulator.command(f"alter vgate = {gate}")
        found[state] = numpy.zeros(len(LENGTHS))
        for i, length in enumerate(LENGTHS):
            simulator.command(f"alter @m1[l] = {length}n")
            simulator.command("op")
            found[state][i] = -sign * simulator.value("vdrain#branch")
            simulator.command("destroy all")
    simulator.command("alter @m1[l] = 65n")
    for gate, drain, _ in SHAPE:
        simulator.command(f"alter vgate = {sign * gate}")
        simulator.command(f"alter vdrain = {sign * drain}")
        simulator.command("op")
        shape.append(-sign * simulator.value("vdrain#branch"))
        simulator.command("destroy all")
    simulator.command("remcirc")
    found["shape"] = numpy.array(shape) / found["ion"][LENGTHS.index(65)]
    return found if all((found[state] > 0).all() for state in found) else None


def fit(simulator, model, table):
    names = list(FITTED[model])
    least, first, largest = (numpy.array([FITTED[model][name][i] for name in names])
                             for i in range(3))
    inside = numpy.array([54 <= length <= 82 for length in LENGTHS])
    unit = {"ion": numpy.where(inside, 0.003, 0.03), "ioff": numpy.where(inside, 0.03, 0.3)}
    # Parameters of unknown order of magnitude are fitted by their logarithm.
    decades = (least > 0) & (largest > 50 * least)
    low, high = (numpy.where(decades, numpy.log(numpy.where(decades, bound, 1)), bound)
                 for bound in (least, largest))

    def values(x):
        scaled = low + x * (high - low)
        return dict(zip(names, numpy.where(decades, numpy.exp(numpy.where(decades, scaled, 0)), scaled)))

    def residuals(x):
        got = currents(simulator, model, values(x))
        if got is None:
            return numpy.full(2 * len(LENGTHS) + len(SHAPE) + len(x), 1e3)
        of_table = [numpy.log(got[state] / table[model, state]) / unit[state]
                    for state in ("ion", "ioff")]
        # A weak pull to the first values keeps parameters that the currents do not determine.
        shape = numpy.log(got["shape"] / [share for *_, share in SHAPE]) / 0.1
        return numpy.concatenate(of_table + [shape, 0.3 * (x - start)])

    start = (numpy.where(decades, numpy.log(numpy.where(decades, first, 1)), first) - low) \
        / (high - low)
    found = least_squares(residuals, start, bounds=(0, 1), diff_step=1e-4, x_scale=0.1,
                          max_nfev=200)
    best = {name: float(f"{value:.5g}") for name, value in values(found.x).items()}
    got = currents(simulator, model, best)
    for state in ("ion", "ioff"):
        off = 100 * (got[state] / table[model, state] - 1)
        worst = max(abs(off[i]) for i, length in enumerate(LENGTHS) if 55 <= length <= 80)
        print(f"{model} {state}: worst {worst:.2f} % from 55 to 80 nm", file=sys.stderr)
    print(f"{model} shares of Ion: {got['shape'].round(3)}", file=sys.stderr)
    return best


def main():
    table = read_table()
    simulator = Simulator()
    output = sys.argv[1] if len(sys.argv) > 1 else os.path.join(HERE, "opcflow65.pm")
    text = ("* SPDX-License-Identifier: BSD-3-Clause\n"
            "* A BSIM4 card of opcflow's own, for simulating its circuits: no foundry's, and a\n"
            "* model of nothing but the currents of ptm65.yaml. Made by fit_opcflow65.py.\n")
    for model in ("nmos", "pmos"):
        text += "\n" + card(model, fit(simulator, model, table))
    with open(output, "w", newline="\n") as file:
        file.write(text)


if __name__ == "__main__":
    main()
