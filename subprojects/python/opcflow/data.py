# SPDX-License-Identifier: BSD-3-Clause
"""Data that plugins receive. Fields have the names and units of the structs of the library eda,
which the headers eda/gates.h, eda/synthesizer.h and eda/extractor.h document.

Gates, layers and parameters stay valid. All other arrays are in memory that the host shares:
they keep their contents after the call only if the plugin keeps a reference.
"""
import numpy as np

POLY, ACTIVE = 0, 1
NMOS, PMOS = 0, 1
VETO_LONGER, VETO_SHORTER, VETO_WIDER, VETO_NARROWER = 1, 2, 4, 8
OPEN = 1              # flag of a transistor whose poly does not print
PARTS = 18            # parts of a gate
END = 1 << 20         # end of the fragments of a gate

TYPES = {"f8": np.float64, "f4": np.float32, "i4": np.int32, "u4": np.uint32, "u1": np.uint8}


class Record:
    """Named values."""

    def __init__(self, **fields):
        self.__dict__.update(fields)

    def __repr__(self):
        return "Record(%s)" % ", ".join(self.__dict__)


class Shapes:
    """Polygons of a layer in grid steps: polygon p has points[start[p]:start[p + 1]], and is a
    hole if hole[p]."""

    def __init__(self, start, points, hole):
        self.start, self.points, self.hole = start, points.reshape(-1, 2), hole

    def __len__(self):
        return max(0, len(self.start) - 1)

    def __getitem__(self, p):
        if not 0 <= p < len(self):
            raise IndexError(p)
        return self.points[self.start[p]:self.start[p + 1]]


def part_of(arrays, prefix):
    """Return the arrays PREFIX.NAME by NAME."""
    return {name[len(prefix) + 1:]: array for name, array in arrays.items()
            if name.startswith(prefix + ".") and "." not in name[len(prefix) + 1:]}


def performance(arrays, prefix):
    """Return the performance PREFIX: ion, ioff, leq_ion, leq_ioff, weq, area, outside; None if
    the request has none."""
    own = part_of(arrays, prefix)
    return Record(**own) if own else None


def shapes(arrays, prefix, count):
    """Return the shapes of all layers."""
    empty = np.zeros(0, np.int32)
    return [Shapes(*(arrays.get("%s.shapes.%d.%s" % (prefix, k, name), empty)
                     for name in ("start", "points", "hole"))) for k in range(count)]


def gates(values, arrays, prefix):
    """Return copies of all data of transistors and layers."""
    own = Record(**values[prefix])
    arrays = {name: array.copy() for name, array in arrays.items()
              if name.startswith(prefix + ".")}
    own.__dict__.update(part_of(arrays, prefix))
    own.box = own.box.reshape(-1, 4)
    own.space = own.space.reshape(-1, 2)
    own.extension = own.extension.reshape(-1, 2)
    own.drawn = shapes(arrays, prefix, len(own.layers))
    return own


def mask(values, arrays, prefix):
    """Return a mask: gates, design, before, after, flags, and the shapes of each layer."""
    own = Record(gates=gates({prefix + ".gates": values[prefix + ".gates"]}, arrays,
                             prefix + ".gates"), flags=arrays[prefix + ".flags"])
    for name in ("design", "before", "after"):
        setattr(own, name, performance(arrays, prefix + "." + name))
    own.shapes = shapes(arrays, prefix, len(own.gates.layers))
    return own
