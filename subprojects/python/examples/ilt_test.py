# SPDX-License-Identifier: BSD-3-Clause
"""Test opc.ilt: raster and rectangles keep areas, images agree with an analytic one, and the mask
of dense lines prints closer to the drawn width than the drawn mask."""
import os
import sys
import unittest

import numpy as np
import torch
from opcflow import data, testing

HERE = os.path.dirname(os.path.abspath(__file__))
PLUGIN = testing.make(os.path.join(HERE, "opc.ilt.py"), iterations=60, steepness=100.0,
                      gate_weight=20.0)
ilt = sys.modules[type(PLUGIN).__module__]
SHAPE = 64, 192


def lines(*places, width=65):
    """Return vertical lines over the whole height, in nm."""
    top = SHAPE[0] * ilt.PIXEL
    points = [(x + a, y) for x in places for a, y in ((0, 0), (width, 0), (width, top), (0, top))]
    return data.Shapes(start=4 * np.arange(len(places) + 1), points=np.array(points),
                       hole=np.zeros(len(places)))


def widths(values, level):
    """Return the widths of the dark parts in the middle row, nm."""
    row = values[SHAPE[0] // 2]
    at = np.flatnonzero((row[:-1] > level) != (row[1:] > level))
    edges = (at + (row[at] - level) / (row[at] - row[at + 1])) * ilt.PIXEL
    return edges[1::2] - edges[::2]


class Ilt(unittest.TestCase):
    def test_raster(self):
        drawn = ilt.raster(lines(300, 553, 801), 1.0, (0, 0), SHAPE)
        self.assertAlmostEqual(drawn.sum() * ilt.PIXEL ** 2, 3 * 65 * 512)
        np.testing.assert_allclose(drawn[9, 69:72], [7 / 8, 1, 1])

    def test_rectangles(self):
        drawn = ilt.raster(lines(300, 553, 801), 1.0, (0, 0), SHAPE)
        found = [[int(v) for v in line[2:-1].split()] for line in ilt.rectangles(drawn, 10, -20)]
        self.assertEqual(sorted(found), sorted([x, -20, x + 65, -20, x + 65, 492, x, 492]
                                               for x in (310, 563, 811)))

    def test_image(self):
        """A coherent image of a grating that passes orders 0 and 1 only."""
        n, pitch = 48, 48 * ilt.PIXEL
        mask = torch.ones(4, n)
        mask[:, :12] = 0
        image = ilt.Imaging((4, n), 193.0, 0.75, 1e-9)(mask)[0].numpy()
        x = np.arange(n) * ilt.PIXEL
        first = np.fft.fft(mask[0].numpy())[1] / n
        field = 0.75 + 2 * (first * np.exp(2j * np.pi * x / pitch)).real
        self.assertGreater(2 * 193 / 0.75, pitch)
        np.testing.assert_allclose(image, field ** 2, atol=1e-5)

    def test_lines(self):
        imaging = ilt.Imaging(SHAPE, 193.0, 0.75, 0.75)
        drawn = ilt.raster(lines(300, 550, 800), 1.0, (0, 0), SHAPE)
        plugin, level = PLUGIN, 0.40394
        plugin.progress = lambda done, total: None
        mask, loss = plugin.optimise(drawn, torch.ones(SHAPE), imaging, level, 0)
        errors = [abs(widths(imaging(torch.from_numpy(1 - m).float()).numpy(), level) - 65).max()
                  for m in (drawn, mask)]
        self.assertGreater(errors[0], 1.2)
        self.assertLess(errors[1], 0.5)


if __name__ == "__main__":
    unittest.main()
