#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Kill one or all of four ranks of a flow at random moments, and continue the flow
with another number of ranks. Then kill some of eight independent processes with one
store, and replace them by others. The results must be bit-identical to those of one
process. KILLS: number of kills of each kind; KILL_FLOW: the arguments of
`opcflow run`."""
import glob
import os
import random
import shutil
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True
import figures

OPCFLOW = os.environ["OPCFLOW_COMMAND"]
SOURCE = os.environ["OPCFLOW_SOURCE"]
KILLS = int(os.environ.get("KILLS", "20"))
DATA = os.environ.get("OPCFLOW_TEST_DATA")
CELLS = "--set layout.file=%s/iscas85/c432/c432.gds --set layout.scale=1.3 --set mask.window=8um" % DATA
WORDS = os.environ.get("KILL_FLOW", "%s/flows/chip.yaml --variant cheap %s" % (SOURCE, CELLS if DATA else "--set mask.window=3um"))


def command(ranks, out="out"):
    start = ["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none"] if ranks else []
    return [*start, OPCFLOW, "run", *WORDS.split(), "--threads", "1", "--force", "--output", out]


def result(out="out"):
    """Return the files of a run, and its kept tasks and outputs."""
    found = {}
    for path in glob.glob(out + "/**", recursive=True):
        if os.path.isfile(path) and not path.endswith("manifest.json"):
            with open(path, "rb") as f:
                found[path[len(out) + 1:]] = f.read()
    for path in glob.glob("store/entries/*/*.piece") + glob.glob("store/entries/*/*.outputs"):
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


def launch(out):
    return out, subprocess.Popen(command(0, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def kill_workers(dice, seconds, kills):
    """Start eight processes, kill and replace random ones at random moments, and return the numbers of
    killed processes that ran, and of the processes with a result."""
    workers = [launch("w%d" % i) for i in range(8)]
    killed = 0
    for i in range(kills):
        time.sleep(dice.uniform(0, 2) * seconds / kills)
        _, victim = workers.pop(dice.randrange(len(workers)))
        victim.kill()
        killed += victim.wait() == -signal.SIGKILL
        workers.append(launch("w%d" % (8 + i)))
    for _, process in workers:
        assert process.wait() in (0, 1)
    return killed, [out for out, _ in workers]


def count_worker_kills(truth, seconds, dice):
    """Return the number of killed processes and the number of results that differ."""
    killed = differs = 0
    while killed < KILLS:
        shutil.rmtree("store")
        now, outs = kill_workers(dice, seconds, dice.randrange(4, 12))
        killed += now
        for out in outs:  # units stay in the store if the last process that needs them is killed
            found = {n: v for n, v in result(out).items() if not n.endswith(".piece")}
            names = [n for n in {**truth, **found} if found.get(n) != truth.get(n)]
            differs += bool(names)
            if names:
                print("%s differs: %s" % (out, ", ".join(names[:3])))
        for path in glob.glob("w*") + glob.glob(".w*"):
            shutil.rmtree(path)
    return killed, differs


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
    killed, different = count_worker_kills(truth, seconds, dice)
    print("%d of the processes with one store killed, %d results differ" % (killed, different))
    differs += different
    return [{"name": "kills.differ", "value": differs, "unit": "", "reach": 0, "better": "lower"},
            {"name": "kills.resumed", "value": middle, "unit": "", "reach": None, "better": "higher"}]


if not shutil.which("mpirun"):
    print("skipped: mpirun is missing")
    sys.exit(0)
figures.run("kills", main)
