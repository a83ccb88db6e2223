# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the benchmarks in Python; bench.c does the same for those in C."""
import json
import os
import tempfile


def run(name, main):
    """Execute main() in an empty working folder, and write the list of figures that it returns to
    NAME.json in the folder OPCFLOW_BENCH. A figure has name, value, unit, reach and better."""
    home = os.environ["OPCFLOW_BENCH"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        figures = main()
        os.chdir("/")
    with open(os.path.join(home, name + ".json"), "w") as f:
        json.dump(figures, f, indent=1)
