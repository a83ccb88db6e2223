# SPDX-License-Identifier: BSD-3-Clause
"""Unit tests of plugins without opcflow: make an instance, and call its methods with data of
the form that the host passes.

    plugin = make("synthesizer.mine.py", ion_limit=0.5)
    run = loop(plugin, lambda l, w: 1 + (7 - 3 * l) / 100, gates=sample_gates(1))
"""
import os

import numpy as np

from . import data
from .parameters import Parameter
from .plugins import Step
from .worker import load


def make(path, **parameters):
    """Return an instance of the plugin in the file `path`. Parameters that are not passed are
    None; defaults in flow notation are converted by opcflow only."""
    plugin = load(os.path.abspath(path), os.path.basename(path)[:-len(".py")])()
    known = {name: member for name, member in
             ((name, getattr(type(plugin), name)) for name in dir(type(plugin)))
             if isinstance(member, Parameter)}
    for name, value in parameters.items():
        if name not in known:
            raise TypeError("the plugin has no parameter '%s'" % name)
        setattr(plugin, name, value)
    if isinstance(plugin, Step):
        plugin.asked = []
        plugin.ask = lambda what, **fields: plugin.asked.append((what, fields))
    return plugin


def sample_gates(count, length=65.0, width=200.0):
    """Return `count` transistors of one size, in nm, on a grid of 1 nm."""
    boxes = np.array([[300 * i, 0, 300 * i + length, width] for i in range(count)], np.int32)
    return data.Record(
        name="sample", grid=1.0, count=count, layers=["poly", "active"], instance=[""] * count,
        cell=["sample"] * count, flavour=[], extent=np.zeros(4, np.int32),
        corrected=np.ones(2, np.uint8), box=boxes.reshape(-1, 4), type=np.zeros(count, np.uint8),
        axis=np.zeros(count, np.uint8), length=np.full(count, float(length)),
        width=np.full(count, float(width)), space=np.full((count, 2), 200.0),
        extension=np.full((count, 2), 100.0), number=np.arange(1, count + 1, dtype=np.uint32),
        drawn=[])


def field(values, frame=(0, 0, 100, 100)):
    """Return a field with the given values at the nodes; frame: x0, y0, width, height in nm."""
    return data.Record(values=np.array(values, np.float32), frame=np.array(frame, float))


def clear_mask(band, side=500.0):
    """Return the spectrum of a clear mask up to a frequency in 1/nm."""
    n = int(band * side)
    spectrum = np.zeros((2 * n + 1, 2 * (n + 1)), np.float32)
    spectrum[0, 0] = 1
    return data.Spectrum(frame=np.array([0, 0, side, side]), band=band, spectrum=spectrum)


def simulation(gates):
    """Return the arguments of Regulator.rule: a simulation with line ends of 100 nm, and the
    ruling that the method changes."""
    n, zeros = gates.count, np.zeros(gates.count, np.int32)
    printed = data.Record(
        iteration=1, gates=gates, flags=zeros.astype(np.uint32), l=zeros, w=zeros.copy(),
        aside=zeros.copy(), extension=np.full((n, 2), 100.0), want_extension=None, want_head=None,
        shapes=gates.drawn, print=[])
    ruling = data.Record(vetoes=np.zeros(n, np.uint32), end=np.zeros((n, 2), np.int32),
                         transistors=n, added=[[] for _ in gates.layers],
                         cutouts=[[] for _ in gates.layers])
    return printed, ruling


def slices(width, length):
    """Return slices of NMOS gates from arrays of the shape (gates, slices), in nm."""
    middle = np.cumsum(width, axis=1) - width / 2
    return data.Record(type=np.zeros(len(width), np.uint8), flavour=[], width=width,
                       length=length,
                       edge=np.minimum(middle, width.sum(axis=1, keepdims=True) - middle))


def figures(ion):
    """Return a performance with the given Ion; the other figures are 1."""
    ion = np.asarray(ion, float)
    return data.Record(ion=ion, **{name: np.ones_like(ion) for name in
                                   ("ioff", "leq_ion", "leq_ioff", "weq", "area")},
                       outside=np.zeros(len(ion), np.uint8))


def loop(plugin, ion, gates, most=200, flags=None, vetoes=None, ion_limit=0.5):
    """Run the correction loop of a synthesizer. `ion(l, w)` returns the printed Ion relative to
    the drawn Ion for the biases l and w. `flags` and `vetoes` are functions of l and w. Returns
    a record: l, w, done, and `trace`, a list of (l, w) of each iteration."""
    n = gates.count
    plugin.gates = gates
    moves = data.Record(l=np.zeros(n, np.int32), w=np.zeros(n, np.int32),
                        jog=np.zeros(n, np.int32), aside=np.zeros(n, np.int32),
                        part=np.zeros((n, data.PARTS, 3), np.int32))
    feedback = data.Record(iteration=0, gates=gates, design=figures(np.ones(n)), printed=None,
                           flags=np.zeros(n, np.uint32), vetoes=np.zeros(n, np.uint32),
                           end=np.zeros((n, 2), np.int32), next_end=np.zeros((n, 2), np.int32),
                           scanner=data.Record(wavelength=193.0, na=0.75), ion_limit=ion_limit)
    plugin.begin(feedback)
    trace, done = [], False
    while not done and feedback.iteration < most:
        l, w = moves.l.copy(), moves.w.copy()
        feedback.printed = figures(np.broadcast_to(ion(l, w), (n,)))
        for name, source in (("flags", flags), ("vetoes", vetoes)):
            if source:
                setattr(feedback, name, np.broadcast_to(source(l, w), (n,)).astype(np.uint32))
        done = plugin.update(feedback, moves)
        trace.append((moves.l.copy(), moves.w.copy()))
        feedback.iteration += 1
    return data.Record(l=moves.l, w=moves.w, done=bool(done), trace=trace)
