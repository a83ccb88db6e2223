# SPDX-License-Identifier: BSD-3-Clause
"""Data that plugins receive. Fields have the names and units of the structs of the library eda,
which the headers eda/gates.h, eda/synthesizer.h, eda/regulator.h and eda/extractor.h document.

All arrays are in memory that the host shares. Arrays that a plugin keeps after a call do not
change later. Only arrays of the arguments moves, ruling, out and image can be written.
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
        return "%s(%s)" % (type(self).__name__, ", ".join(self.__dict__))


class Shapes(Record):
    """Polygons of a layer in grid steps: polygon p has points[start[p]:start[p + 1]], and is a
    hole if hole[p]."""

    def __len__(self):
        return max(0, len(self.start) - 1)

    def __getitem__(self, p):
        if not 0 <= p < len(self):
            raise IndexError(p)
        return self.points[self.start[p]:self.start[p + 1]]


class Spectrum(Record):
    """Spectrum of a mask in `frame` (x0, y0, width, height in nm) up to the frequency `band` in
    1/nm; see eda_spectrum in eda/imaging.h. `spectrum` has the shape (rows, 2 * columns)."""

    def coherent(self, transfer, step=32.0):
        """Return |E|^2 at nodes at most `step` nm apart, shape (ny, nx). E is the mask filtered
        by transfer(fx, fy), a function of arrays of frequencies in 1/nm."""
        half = self.spectrum.view(np.complex64)
        rows, columns = half.shape
        k = np.arange(1 - columns, columns)
        l = np.arange(rows) - rows // 2
        # The mask is real: a[-k, -l] is the conjugate of a[k, l].
        right = half[l % rows]
        whole = np.hstack([right[::-1, :0:-1].conj(), right])
        width, height = self.frame[2:]
        whole = whole * transfer(k[None, :] / width, l[:, None] / height)
        nodes = [2 * max(int(np.ceil(side / step / 2)), n)
                 for side, n in ((height, rows), (width, 2 * columns - 1))]
        field = np.zeros(nodes, np.complex64)
        field[np.ix_(l % nodes[0], k % nodes[1])] = whole
        return np.abs(np.fft.ifft2(field) * field.size) ** 2


def decode(value, array):
    """Return the data of a request: records of values and arrays. array(type, offset, count,
    width, file, writable) returns an array."""
    if isinstance(value, list):
        return [decode(v, array) for v in value]
    if not isinstance(value, dict):
        return value
    if "array" in value:
        return array(*value["array"])
    fields = {name: decode(v, array) for name, v in value.items()}
    return (Shapes if "hole" in fields else Spectrum if "spectrum" in fields
            else Record)(**fields)


def copied(value):
    """Return a copy of the data that stays valid."""
    if isinstance(value, list):
        return [copied(v) for v in value]
    if isinstance(value, Record):
        return type(value)(**{name: copied(v) for name, v in vars(value).items()})
    return value.copy() if isinstance(value, np.ndarray) else value
