# SPDX-License-Identifier: BSD-3-Clause
"""Test synthesizer.pydpb by the hand calculations of plugins/synthesizer/dpb/dpb_test.c:
Ion deviates by offset + by_l * l + by_w * w, %."""
import os
import unittest

from opcflow import testing

PLUGIN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "synthesizer.pydpb.py")


def trace(offset, by_l, by_w, open_until=None, **parameters):
    """Return the moves (l, w) of one transistor of W 200 nm."""
    plugin = testing.make(PLUGIN, **{"max_bias": 110, "ion_limit": 0.5, "w_step": "unit",
                                     **parameters})
    run = testing.loop(plugin, lambda l, w: 1 + (offset + by_l * l + by_w * w) / 100,
                       testing.sample_gates(1),
                       flags=open_until and (lambda l, w: l < open_until))
    assert run.done
    return " ".join("%d,%d" % (l[0], w[0]) for l, w in run.trace), plugin.verdict(0)


class ByHand(unittest.TestCase):
    def test_longer(self):
        self.assertEqual(trace(7, -3, 0.8),
                         ("1,0 2,0 3,0 2,0 2,-1 2,-1 2,-1", "within limit"))

    def test_shorter(self):
        self.assertEqual(trace(-7, -3, 0.2)[0],
                         "-1,0 -2,0 -3,0 -2,0 -2,1 -2,2 -2,3 -2,3 -2,3")

    def test_open(self):
        moves, verdict = trace(12, -3, 1, open_until=3)
        self.assertTrue(moves.startswith("1,0 2,0 3,0 4,0 4,0"), moves)
        self.assertEqual(verdict, "within limit")


if __name__ == "__main__":
    unittest.main()
