# SPDX-License-Identifier: BSD-3-Clause
"""Plugins for opcflow in Python, and runs of flows.

A file KIND.NAME.py on the plugin path defines one subclass of Synthesizer, Regulator,
Extractor, Resist, Litho or Step; NumPy is the only dependency. run() runs a flow, Run reads a
run folder.
"""
from .data import (ACTIVE, END, NMOS, OPEN, PARTS, PMOS, POLY, VETO_LONGER, VETO_NARROWER,
                   VETO_SHORTER, VETO_WIDER)
from .parameters import (Invalid, boolean, choice, file, gates_input, integer, mapping, mask_input,
                         metric, output, real, reals, text)
from .plugins import Extractor, Litho, Regulator, Resist, Step, Synthesizer

RUNS = ("Comparison", "Failed", "Run", "compare", "run")

__all__ = ["ACTIVE", "END", "NMOS", "OPEN", "PARTS", "PMOS", "POLY", "VETO_LONGER",
           "VETO_NARROWER", "VETO_SHORTER", "VETO_WIDER", "Invalid", "boolean", "choice", "file",
           "integer", "mapping", "metric", "output", "real", "reals", "text", "Extractor",
           "Litho", "Regulator", "Resist", "Step", "Synthesizer", "gates_input", "mask_input"]


def __getattr__(name):
    """Import the module of runs at the first use: processes of plugins do not need it."""
    if name not in RUNS:
        raise AttributeError("module 'opcflow' has no attribute '%s'" % name)
    from . import runs
    return getattr(runs, name)
