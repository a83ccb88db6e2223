#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Kill one or all of four ranks of a flow at random moments, and continue the flow
with another number of ranks. The result must be bit-identical to that of one
process. KILLS: number of kills; KILL_FLOW: the arguments of `opcflow run`."""
import glob
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

OPCFLOW = os.environ["OPCFLOW_COMMAND"]
SOURCE = os.environ["OPCFLOW_SOURCE"]
KILLS = int(os.environ.get("KILLS", "20"))
DATA = os.environ.get("OPCFLOW_TEST_DATA")
CELLS = "--set layout.file=%s/iscas85/c432/c432.gds --set layout.scale=1.3 --set mask.window=8um" % DATA
WORDS = os.environ.get("KILL_FLOW", "%s/flows/chip.yaml --variant cheap %s" % (SOURCE, CELLS if DATA else "--set mask.window=3um"))


def command(ranks):
    start = ["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none"] if ranks else []
    return [*start, OPCFLOW, "run", *WORDS.split(), "--threads", "1", "--force", "--output", "out"]


def result():
    """Return the files of a run, and its kept tasks and outputs."""
    paths = [p for p in glob.glob("out/**", recursive=True) if os.path.isfile(p) and not p.endswith("manifest.json")]
    found = {}
    for path in paths + glob.glob("store/entries/*/*.piece") + glob.glob("store/entries/*/*.outputs"):
        with open(path, "rb") as f:
            found[path] = f.read()
    return found


def run(ranks):
    done = subprocess.run(command(ranks), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    assert done.returncode in (0, 1), done.stderr  # 1: a requirement is violated
    return result()


def kill(dice, seconds, all_of_them):
    """Start the flow with four ranks, kill one or all ranks after a random time, and return the
    number of work units in the store."""
    process = subprocess.Popen(command(4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(dice.uniform(0.1, 1) * seconds)
    ranks = []
    if process.poll() is None:
        with open("/proc/%d/task/%d/children" % (process.pid, process.pid)) as f:
            ranks = [int(pid) for pid in f.read().split()]
    for pid in ranks if all_of_them else dice.sample(ranks, min(1, len(ranks))):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait()
    return len(glob.glob("store/entries/*/*.piece"))


def main():
    os.environ.update(OPCFLOW_STORE=os.path.join(os.getcwd(), "store"), OMPI_ALLOW_RUN_AS_ROOT="1",
                      OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    truth = run(0)
    shutil.rmtree("store")
    start = time.time()
    differs = middle = 0
    assert run(4) == truth
    seconds = time.time() - start
    dice = random.Random(1)
    for i in range(KILLS):
        shutil.rmtree("store")
        shutil.rmtree("out", ignore_errors=True)
        kept = kill(dice, seconds, i % 2)
        middle += kept > 0
        differs += run(dice.choice((0, 2, 4))) != truth
        differs += any(name.startswith(".") for name in os.listdir("."))
    print("%d kills, %d with work units in the store, %d results differ" % (KILLS, middle, differs))
    return [{"name": "kills.differ", "value": differs, "unit": "", "reach": 0, "better": "lower"},
            {"name": "kills.resumed", "value": middle, "unit": "", "reach": None, "better": "higher"}]


if not shutil.which("mpirun"):
    print("skipped: mpirun is missing")
    sys.exit(0)
home = os.environ["OPCFLOW_BENCH"]
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    figures = main()
    os.chdir("/")
with open(os.path.join(home, "kills.json"), "w") as f:
    json.dump(figures, f, indent=1)
