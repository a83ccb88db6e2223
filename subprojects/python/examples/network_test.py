# SPDX-License-Identifier: BSD-3-Clause
"""Test resist.network: the gradient of the network by differences, and the thresholds of the
formula from which the table was made."""
import os
import unittest

import numpy as np
from opcflow import testing

HERE = os.path.dirname(os.path.abspath(__file__))


def formula(m, s):
    """Return the threshold of thresholds.csv."""
    return 0.28 + 0.12 * m + 4 * s - 0.15 * (m - 0.9) ** 2


def make(**more):
    plugin = testing.make(os.path.join(HERE, "resist.network.py"), units=6, iterations=200,
                          limit=0.005, table=os.path.join(HERE, "thresholds.csv"), **more)
    plugin.prepare(None)
    return plugin


class Learned(unittest.TestCase):
    def test_jacobian(self):
        network = make().network
        x, step = np.array([[0.3, -0.7], [-1.1, 0.4]]), 1e-6
        found = network.jacobian(x)
        for k in range(len(network.weights)):
            network.weights[k] += step
            high = network(x)
            network.weights[k] -= 2 * step
            np.testing.assert_allclose(found[:, k], (high - network(x)) / (2 * step), atol=1e-7)
            network.weights[k] += step

    def test_formula(self):
        """A wave of intensity: the maximum and the slope follow from the definition."""
        n, side, plugin = 96, 480.0, make()
        x = np.arange(n) * side / n
        values = np.tile(0.5 + 0.3 * np.cos(2 * np.pi * x / side), (n, 1))
        level = plugin.level(0, testing.field(values, (0, 0, side, side)))

        def mean(of, radius):
            """The Gaussian mean at x = 0 by a sum."""
            d = np.linspace(-4 * radius, 4 * radius, 4001)
            weight = np.exp(-2 * (d / radius) ** 2)
            return (weight * of(2 * np.pi * d / side)).sum() / weight.sum()

        m = mean(lambda a: (0.5 + 0.3 * np.cos(a)) ** 8, 200) ** 0.125
        s = mean(lambda a: (0.3 * 2 * np.pi / side * np.sin(a)) ** 2, 60) ** 0.5
        self.assertAlmostEqual(level[5, 0], formula(m, s) - 0.8, delta=0.002)

    def test_limit(self):
        plugin = make()
        plugin.units, plugin.iterations = 1, 1
        with self.assertRaisesRegex(ValueError, "expected at most 0.005"):
            plugin.prepare(None)


if __name__ == "__main__":
    unittest.main()
