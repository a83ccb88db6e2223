#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measure the correction by classes of logic without repetition: copies of c7552, in
which the cells of each row have a random order. Report processor time, s; processor
time per transistor, ms; peak memory, MB; and the ratio of the forecast to the peak. The
environment variable TILES lists the numbers of copies. Requires the Python module
klayout and OPCFLOW_TEST_DATA."""
import os
import random
import re
import subprocess
import sys

sys.dont_write_bytecode = True
import figures

OPCFLOW = os.environ["OPCFLOW_COMMAND"]
SOURCE = os.environ["OPCFLOW_SOURCE"]
DATA = os.environ.get("OPCFLOW_TEST_DATA")
TILES = [int(n) for n in os.environ.get("TILES", "1 2 13").split()]
TRANSISTORS = 7858  # of c7552


def write_tiles(path, count):
    """Write `count` copies of c7552 in a grid of about equal rows and columns. The cells of
    the first copy keep their order."""
    layout = db.Layout()
    layout.read(DATA + "/iscas85/c7552/c7552.gds")
    top = layout.cell("c7552")
    outline = layout.layer(235, 0)
    size = top.bbox(outline)
    rows = {}
    for i in top.each_inst():
        box = i.bbox(outline)
        way = db.Trans(i.trans.angle, i.trans.is_mirror(), i.trans.disp.x - box.left, i.trans.disp.y)
        rows.setdefault(box.bottom, []).append((box.left, box.width(), i.cell_index, way))
    tiled = layout.create_cell("tiled")
    columns = max(1, round(count ** 0.5))
    for k in range(count):
        dice = random.Random(k)
        corner = db.Vector(k % columns * size.width(), k // columns * size.height())
        for _, row in sorted(rows.items()):
            cells = sorted(row, key=lambda cell: cell[0])
            x = cells[0][0]
            if k:
                dice.shuffle(cells)
            for _, width, cell, way in cells:
                at = db.Trans(corner + db.Vector(x, 0)) * way
                tiled.insert(db.CellInstArray(cell, at))
                x += width
    top.delete()
    layout.write(path)


def measure(count):
    """Correct `count` copies with one thread and fast simulations. Return the processor
    time, s, the peak memory, MB, and the forecast of memory, MB."""
    write_tiles("tiled.gds", count)
    words = [SOURCE + "/flows/chip.yaml", "--variant", "cheap", "--set", "layout.file=tiled.gds",
             "--set", "layout.scale=1.3", "--threads", "1"]
    check = subprocess.run([OPCFLOW, "check", *words[:-2]], check=True, capture_output=True, text=True)
    number, unit = re.search(r"windows.*, ([0-9.]+) ([MG])B", check.stdout + check.stderr).groups()
    process = subprocess.Popen([OPCFLOW, "run", *words, "--force", "--quiet", "--output", "out"],
                               stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    assert os.waitstatus_to_exitcode(status) in (0, 1)  # 1: a requirement is violated
    forecast = float(number) * {"M": 1, "G": 1000}[unit]
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024e-6, forecast


def main():
    found = []
    for count in TILES:
        seconds, peak, forecast = measure(count)
        for name, value, unit in (("seconds", seconds, "s CPU"), ("memory", peak, "MB"),
                                  ("per_transistor", 1e3 * seconds / count / TRANSISTORS, "ms CPU"),
                                  ("forecast", forecast / peak, "of the peak")):
            print("tiles_%d.%s %.3g %s" % (count, name, value, unit), flush=True)
            found.append({"name": "tiles_%d.%s" % (count, name), "value": value, "unit": unit,
                          "reach": None, "better": "lower"})
    return found


try:
    import klayout.db as db
except ImportError:
    db = None
if not db or not DATA:
    print("skipped: the Python module klayout, or OPCFLOW_TEST_DATA, is missing")
    sys.exit(0)
figures.run("tiles", main)
