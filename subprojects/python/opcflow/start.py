# SPDX-License-Identifier: BSD-3-Clause
"""Start of the process of a plugin: start.py CACHE PLUGIN ID. Parts of NumPy that most plugins do
not use are executed at their first use, which saves a third of the import. The bytecode of the
package is kept in the folder CACHE, unless CACHE is empty."""
import os
import sys
from importlib.machinery import PathFinder
from importlib.util import LazyLoader

LATER = ("numpy.ctypeslib", "numpy.fft", "numpy.ma", "numpy.polynomial", "numpy.random")


class Later:
    """Finder of modules that are executed at their first use."""

    @staticmethod
    def find_spec(name, path, target=None):
        spec = PathFinder.find_spec(name, path) if name in LATER else None
        if spec:
            spec.loader = LazyLoader(spec.loader)
        return spec


sys.path[0] = os.path.dirname(sys.path[0])  # the folder of this package
sys.meta_path.insert(0, Later)
import numpy  # noqa: E402, F401

sys.meta_path.remove(Later)
sys.pycache_prefix, sys.dont_write_bytecode = sys.argv[1] or None, not sys.argv[1]
from opcflow.worker import main  # noqa: E402

# Python does not detect two changes of a file within a second: no bytecode of plugins.
sys.pycache_prefix, sys.dont_write_bytecode = None, True
main(*sys.argv[2:])
