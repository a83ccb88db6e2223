#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test work units in one process: results are compared with sums computed here, and stored units
are reused after faults, kills and damage. PIECES_KILLS is the number of kills."""
import glob
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import traceback

BUILD = os.environ["OPCFLOW_BUILD"]
OPCFLOW = os.path.join(BUILD, "opcflow")
KILLS = int(os.environ.get("PIECES_KILLS", "4"))
FLOW = """opcflow: 1
name: shared
steps:
  a: { use: test.kept, number: 3 }
  b: { use: test.pieces, add: "${a}", journal: JOURNAL }
  c: { use: test.kept, number: 2, add: "${b}", file: c.txt }
"""
number = 0


def truth(count=12, size=3, add=1.0):
    """Return the metric b.sum, and the table of the second list."""
    total = 0.0
    for which in range(2):
        if which:
            total += 1
        taken = [0.0] * count
        for i in range(count):
            for k in range(size):
                taken[i] += 1 / (1.0 + i + k * 0.37 + total + add)
        for value in taken:
            total = total * 0.9 + value
    return total, taken


def call(*words, store="store", code=0, **more):
    env = dict(os.environ, OPCFLOW_STORE=os.path.abspath(store) if store else "", **more)
    done = subprocess.run([OPCFLOW, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env)
    assert code is None or done.returncode == code, (words, done.returncode, done.stderr)
    return done


def run(*sets, options=(), **more):
    """Return a new run folder, the finished command, and the work units that ran."""
    global number
    number += 1
    folder = "runs/%d" % number
    open("journal", "w").close()
    words = [word for s in sets for word in ("--set", s)]
    done = call("run", "shared.yaml", "--quiet", "--output", folder, *words, *options, **more)
    with open("journal") as f:
        lines = [line.split() for line in f]
    return folder, done, [(w, int(i)) for w, i, _ in lines]


def check(folder, **more):
    total, taken = truth(**more)
    with open(folder + "/metrics.json") as f:
        assert json.load(f)["b"]["sum"]["value"] == total
    with open(folder + "/pieces.csv") as f:
        assert [float(line) for line in f.read().split()[1:]] == taken
    with open(folder + "/c.txt") as f:
        assert float.fromhex(f.read()) == 2 / 3 + total


def pieces():
    return glob.glob("store/entries/*/*.piece")


def fresh():
    for name in ("store", "runs"):
        shutil.rmtree(name, ignore_errors=True)
    with open("shared.yaml", "w") as f:
        f.write(FLOW.replace("JOURNAL", os.path.abspath("journal")))
    os.makedirs("runs")


ALL = [(w, i) for w in ("first", "second") for i in range(12)]
UNKEPT = [9]  # units of each list that have no key


# ---- results ----

def test_truth():
    folder, _, done = run("b.kept=false", options=["--no-cache"])
    check(folder)
    assert done == ALL
    folder, _, done = run()
    check(folder)
    assert done == ALL
    assert not pieces()  # the result of the step replaces those of the units
    folder, _, done = run()
    check(folder)
    assert done == []
    fresh()
    folder, _, done = run("b.kept=false")  # no unit has a key
    check(folder)
    assert done == ALL and not pieces()


def test_sizes():
    for sets in ({"count": 0}, {"size": 0}, {"count": 1, "size": 100000}):
        folder, _, done = run(*("b.%s=%d" % s for s in sets.items()))
        check(folder, **sets)
        assert len(done) == 2 * sets.get("count", 12)


def test_alone():
    """Test work units in a unit test and in another work unit: results are neither stored nor distributed."""
    said = call("lint", "--strict", os.path.join(BUILD, "tests", "test.alone.so"), code=None)
    assert "the same work again" in said.stderr.split("not checked")[0], said.stderr
    assert said.stdout == "", said.stdout
    folder, _, done = run("b.fault=nest")
    check(folder)


# ---- found again ----

def test_fault():
    for fault, said in (("work", "second 7: does not want to"), ("take", "second 7: is not taken"),
                        ("huge", "second 7: the result of a work unit exceeds 1073741824 bytes"),
                        ("publish", "'sum' is published by a work unit"), ("crash", "crashed in plugin")):
        fresh()
        _, failed, done = run("b.fault=" + fault, code=4)
        assert said in failed.stderr and failed.stderr.count("error") <= 1, failed.stderr
        assert done == ALL[:12 + (8 if fault in ("take", "huge") else 7)], (fault, done)
        kept = ALL[:12 + (8 if fault == "take" else 7)]
        folder, _, done = run()
        check(folder)
        assert done == [p for p in ALL if p[1] in UNKEPT or p not in kept], (fault, done)
        assert not pieces()


def test_said():
    """A run that reuses a work unit from the store repeats the warnings of the unit."""
    text = "b: piece 1 is odd"
    folder, said, _ = run("b.fault=warn", "b.at=1")
    assert said.stderr.count("warning: " + text) == 1 and said.stderr.count("finding: " + text) == 1, said.stderr
    fresh()
    os.mkdir("hold")
    open("hold/4", "w").close()
    process = start("b.fault=warn", "b.at=1", "b.hold=hold")
    while not os.path.exists("hold/4.here"):  # the second list has 4 results, including unit 1
        assert process.poll() is None
        time.sleep(0.002)
    process.kill()
    process.wait()
    folder, said, done = run()
    check(folder)
    assert ("second", 1) not in done
    assert said.stderr.count("warning: " + text) == 1 and said.stderr.count("finding: " + text) == 1, said.stderr


def start(*sets):
    global number
    number += 1
    words = [word for s in sets for word in ("--set", s)]
    return subprocess.Popen([OPCFLOW, "run", "shared.yaml", "--quiet", "--output", "runs/%d" % number, *words],
                            env=dict(os.environ, OPCFLOW_STORE=os.path.abspath("store")), stderr=subprocess.DEVNULL)


def test_kills():
    for i in range(KILLS):
        fresh()
        open("journal", "w").close()
        process = start("b.wait=5")
        moment = random.randrange(24)
        while process.poll() is None and os.path.getsize("journal") < moment * len("first 0 1\n"):
            time.sleep(0.001)
        process.kill()
        process.wait()
        kept = len(pieces())
        folder, _, done = run()
        check(folder)
        assert len(done) in (24 - kept, 0), (kept, done)  # 0: the run had ended before the kill


def test_damage():
    def flip(path):
        with open(path, "r+b") as f:
            f.seek(-1, os.SEEK_END)
            last = f.read(1)[0]
            f.seek(-1, os.SEEK_END)
            f.write(bytes([last ^ 1]))
    for harm in (flip, os.unlink, lambda path: os.truncate(path, 40), lambda path: open(path, "w").close()):
        fresh()
        run("b.fault=work", code=4)
        kept = pieces()
        assert len(kept) == 11 + 7
        for path in kept[:5]:
            harm(path)
        folder, said, done = run()
        check(folder)
        assert len(done) == 24 - 18 + 5
        assert ("was damaged and has been removed" in said.stderr) == (harm is not os.unlink), said.stderr


def test_limits():
    """Test that a too small or missing store does not change the results."""
    for more in ({"OPCFLOW_STORE_LIMIT": "100 B"}, {"store": ""}):
        _, _, _ = run("b.fault=work", code=4, **more)
        folder, _, done = run(**more)
        check(folder)
        assert done == ALL
    fresh()
    run("b.fault=work", code=4)
    assert pieces()
    _, _, done = run("b.count=11", "b.fault=work", code=4)  # another step
    assert len(done) == 11 + 7
    call("cache", "clear")
    assert not pieces()


def main():
    random.seed(int(os.environ.get("PIECES_SEED", "1")))
    os.environ["OPCFLOW_PLUGIN_PATH"] = os.path.join(BUILD, "tests")
    tests = [(n, f) for n, f in globals().items() if n.startswith("test_")]
    failed = 0
    print("1..%d" % len(tests))
    for i, (name, test) in enumerate(tests):
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            fresh()
            try:
                test()
                print("ok %d - %s" % (i + 1, name))
            except Exception:
                failed += 1
                for line in traceback.format_exc().splitlines():
                    print("# " + line)
                print("not ok %d - %s" % (i + 1, name))
            os.chdir("/")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
