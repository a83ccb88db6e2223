#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test a flow that several processes run together, by mpirun. The results must be bit-identical
to those of one process and to sums computed here, also after failures, kills and damage.
RANKS_KILLS: number of kills; RANKS_SEED: seed of the random moments."""
import concurrent.futures
import fcntl
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
import traceback

from pieces_test import truth

BUILD = os.environ["OPCFLOW_BUILD"]
OPCFLOW = os.path.join(BUILD, "opcflow")
MPIRUN = shutil.which("mpirun")
KILLS = int(os.environ.get("RANKS_KILLS", "3"))
LONG = 250  # s; a sanitized build on a loaded machine is slow
FLOW = """opcflow: 1
name: shared
steps:
  a: { use: test.kept, number: 3 }
  b: { use: test.pieces, add: "${a}", journal: JOURNAL }
  c: { use: test.kept, number: 2, add: "${b}", file: c.txt }
  d: { use: test.pieces, add: "${b}", count: 5 }
"""
ENV = dict(os.environ, OPCFLOW_PLUGIN_PATH=os.path.join(BUILD, "tests"), OMPI_ALLOW_RUN_AS_ROOT="1",
           # MPI does not free its memory at the end.
           ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0",
           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_btl_vader_single_copy_mechanism="none")
ALL = sorted((w, i) for w in ("first", "second") for i in range(12))


def wait_for(condition, process=None):
    """Wait until a condition holds; fail if a process that must run has ended."""
    end = time.monotonic() + LONG
    while not condition():
        assert process is None or process.poll() is None, process.communicate()
        assert time.monotonic() < end, "the awaited state did not occur in %d s" % LONG
        time.sleep(0.002)


class Place:
    """A temporary folder with a flow, a store and runs."""

    def __init__(self, folder):
        self.folder = folder
        self.number = 0
        os.makedirs(os.path.join(folder, "tmp"))
        self.write("shared.yaml", FLOW.replace("JOURNAL", self.path("journal")))
        self.env = dict(ENV, OPCFLOW_STORE=self.path("store"), TMPDIR=self.path("tmp"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w") as f:
            f.write(text)

    def start(self, n, *sets, flow="shared.yaml", options=(), joins=False):
        """Start n ranks, or one process if n is 0. If `joins` is set, keep the journal of earlier processes."""
        self.number += 1
        if not joins:
            self.write("journal", "")
        words = [word for s in sets for word in ("--set", s)]
        ranks = [MPIRUN, "-n", str(n), "--oversubscribe"] if n else []
        return subprocess.Popen([*ranks, OPCFLOW, "run", flow, "--output", "runs/%d" % self.number, *words, *options],
                                cwd=self.folder, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def hold(self, *units):
        """Return a new folder in which `units` of the second list are held (test.pieces)."""
        folder = tempfile.mkdtemp(dir=self.folder)
        for unit in units:
            open("%s/%d" % (folder, unit), "w").close()
        return folder

    def run(self, n, *sets, code=0, **more):
        """Return the run folder, the finished command, and the work units that ran."""
        process = self.start(n, *sets, **more)
        process.out, process.err = process.communicate(timeout=LONG)
        assert process.returncode == code, (process.returncode, process.out, process.err)
        return self.path("runs/%d" % self.number), process, self.done()

    def done(self):
        """Return (list, number, process) of each computed work unit."""
        with open(self.path("journal")) as f:
            return [(w, int(i), pid) for w, i, pid in (line.split() for line in f)]

    def hidden(self):
        return [n for n in os.listdir(self.path("runs")) if n.startswith(".")]

    def forget(self):
        shutil.rmtree(self.path("store"), ignore_errors=True)

    def pieces(self):
        return glob.glob(self.path("store/entries/*/*.piece"))


def check(folder, **more):
    total, taken = truth(**more)
    last, _ = truth(count=5, add=total)
    with open(folder + "/metrics.json") as f:
        metrics = json.load(f)
    assert (metrics["b"]["sum"]["value"], metrics["d"]["sum"]["value"]) == (total, last)
    with open(folder + "/pieces.csv") as f:
        assert [float(line) for line in f.read().split()[1:]] == taken
    with open(folder + "/c.txt") as f:
        assert float.fromhex(f.read()) == 2 / 3 + total


def names(done):
    return sorted((w, i) for w, i, _ in done)


# ---- results ----

def test_same(place):
    alone = place.run(0, options=["--no-cache"])[0]
    for n in (1, 2, 4):
        folder, said, done = place.run(n, "b.wait=5", "b.hold=" + place.hold(), "b.crowd=%d" % n,
                                       options=["--no-cache", "--log", "info"])
        check(folder)
        assert names(done) == ALL and len({pid for _, _, pid in done}) == n, done
        assert said.out.count("runs/") == 1 and said.err.count("c: ran") == 1, (said.out, said.err)
        for name in ("pieces.csv", "d.pieces.csv", "c.txt", "metrics.json"):
            with open(os.path.join(alone, name), "rb") as a, open(os.path.join(folder, name), "rb") as b:
                assert a.read() == b.read(), name
    assert done[0][1] % 3 == 2  # the most expensive unit was first
    assert os.listdir(place.path("tmp")) == []


def test_chip(place):
    """Test the windows of a chip: equal tables and figures, and equal results of each work unit."""
    env = dict(place.env, OPCFLOW_PLUGIN_PATH=os.path.join(BUILD, "plugins"))
    flow = os.path.join(os.environ["OPCFLOW_SOURCE"], "flows/chip.yaml")
    found = []
    for n in (1, 2, 3):
        place.forget()
        os.makedirs(place.path("store"))
        place.write("store/opcflow-store", "")
        words = ["run", flow, "--variant", "cheap", "--set", "mask.window=3um", "--output", "runs/%d" % n]
        with open(place.path("store/claims"), "a+") as claims:
            if n > 1:  # ranks do not remove the results of work units while another process may need them
                fcntl.lockf(claims, fcntl.LOCK_SH)
            subprocess.run([MPIRUN, "-n", str(n), "--oversubscribe", OPCFLOW, *words], cwd=place.folder, env=env,
                           check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        found.append({})
        for path in glob.glob(place.path("runs/%d/*" % n)) + place.pieces():
            with open(path, "rb") as f:
                found[-1][os.path.basename(path)] = f.read()
        del found[-1]["manifest.json"]
        assert (len(place.pieces()) > 2) == (n > 1), place.pieces()
    assert found[1] == found[2] and {k: v for k, v in found[1].items() if not k.endswith(".piece")} == found[0]


def test_sizes(place):
    for sets in ({"count": 0}, {"size": 0}, {"count": 3, "size": 1000000}):
        folder, _, _ = place.run(2, *("b.%s=%d" % s for s in sets.items()))
        check(folder, **sets)


def test_said(place):
    """Test that a message of a work unit is printed once, for any process that computed the unit."""
    for n in (1, 3):
        _, said, _ = place.run(n, "b.fault=warn", "b.at=1", options=["--no-cache", "--log", "debug"])
        assert said.err.count("warning: b: piece 1 is odd") == said.err.count("finding: b: piece 1 is odd") == 1, said.err
        assert "24 bytes per result" in said.err, said.err


def test_again(place):
    """Test that one process reuses results stored by several processes, and vice versa. Lost outputs
    are computed again."""
    place.run(2)
    assert not place.pieces()
    folder, said, done = place.run(0)
    assert done == [] and "4 of 4 steps reused" in said.out, said.out
    folder, said, done = place.run(2)
    assert done == [] and "4 of 4 steps reused" in said.out, said.out
    folder, said, done = place.run(2, "d.wait=0", "d.size=3", "d.count=6")
    assert done == [] and "3 of 4 steps reused" in said.out, said.out
    for path in glob.glob(place.path("store/entries/*/*.outputs")):
        os.unlink(path)
    folder, said, done = place.run(2, "d.count=7")
    assert names(done) == ALL
    folder, said, done = place.run(2, "c.number=5", options=["--log", "info"])  # the first rank runs this step
    assert folder and "c: ran" in said.err


def test_sweep(place):
    folder, said, done = place.run(2, options=["--sweep", "b.count=[2, 3]", "--json"])
    printed = json.loads(said.out)
    column = [c["name"] for c in printed["sweep"]["columns"]].index("b.sum")
    assert [row[column] for row in printed["sweep"]["rows"]] == [truth(count=2)[0], truth(count=3)[0]]


# ---- faults ----

def test_faults(place):
    said = place.run(2, "b.count=x", code=2)[1].err
    assert said.count("shared.yaml") + said.count("--set") <= 2 and "rank" not in said.split("---")[0], said
    for fault, text in (("work", "second 7: does not want to"), ("take", "second 7: is not taken"),
                        ("rank", "rank 1 on %s: shared.yaml:5:3: step 'b' (test.pieces): second 4: is not taken" % os.uname().nodename),
                        ("crash", "crashed in plugin 'test.pieces'")):
        _, failed, done = place.run(3, "b.fault=" + fault, "b.at=%d" % (1 if fault == "rank" else 7), code=4)
        assert failed.err.count(text) == 1 and failed.err.count("test.pieces") <= 3, failed.err  # and "stopped"
        kept = len(place.pieces())
        assert kept >= 11 or fault == "rank", kept
        if fault == "crash":  # the first rank may be ended before it removes its files
            place.number -= 1
        else:
            assert not place.hidden(), (fault, place.hidden())
        folder, _, done = place.run(2)
        check(folder)
        assert not place.hidden(), (fault, place.hidden())
        # The first rank received the result that another rank could not, and kept the result.
        assert len(done) == (24 - kept if fault != "rank" else 0), (kept, done)
        place.forget()


def test_others(place):
    """Test ranks that run different flows, and a build without MPI."""
    place.write("other.yaml", FLOW.replace("JOURNAL", place.path("journal")).replace("number: 3", "number: 4"))
    done = subprocess.run([MPIRUN, "--oversubscribe", "-n", "1", OPCFLOW, "run", "shared.yaml", ":", "-n", "1", OPCFLOW,
                           "run", "other.yaml"], cwd=place.folder, env=place.env, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 4 and "rank 1 on" in done.stderr and "does not run the same as rank 0" in done.stderr, done
    os.makedirs(place.path("bin"))
    shutil.copy(OPCFLOW, place.path("bin/opcflow"))
    done = subprocess.run([MPIRUN, "--oversubscribe", "-n", "2", place.path("bin/opcflow"), "run", "shared.yaml"],
                          cwd=place.folder, env=place.env, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 3 and "this build is without MPI" in done.stderr, done
    alone = subprocess.run([OPCFLOW, "run", "shared.yaml", "--no-cache"], cwd=place.folder,
                           env=dict(place.env, LD_DEBUG="files"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                           text=True)
    assert alone.returncode == 0 and "libyaml" in alone.stderr and "mpi" not in alone.stderr


def test_job(place):
    """Test the job script for Slurm by bash with Slurm's variables and, if available, by Slurm."""
    job = os.path.join(os.environ["OPCFLOW_SOURCE"], "data/opcflow.sbatch")
    n = "2" if os.cpu_count() > 1 else "1"
    env = dict(place.env, SLURM_NTASKS=n, SLURM_CPUS_PER_TASK="1", SLURM_SUBMIT_DIR=place.folder,
               PATH=BUILD + ":" + os.environ["PATH"])
    words = ["shared.yaml", "--set", "b.hold=" + place.hold(), "--set", "b.crowd=" + n, "--output", "runs/job"]
    subprocess.run(["bash", "-n", job], check=True)
    done = subprocess.run(["bash", job, *words], cwd=place.folder, env=env, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, done.stderr
    check(place.path("runs/job"))
    assert len({pid for _, _, pid in place.done()}) == int(n)
    assert subprocess.run(["bash", job], env=env, stderr=subprocess.DEVNULL).returncode == 2
    if shutil.which("sinfo") and subprocess.run(["sinfo"], stdout=subprocess.DEVNULL,
                                                stderr=subprocess.DEVNULL).returncode == 0:
        done = subprocess.run(["sbatch", "--test-only", "--nodes=1", "--ntasks-per-node=1", "--cpus-per-task=1", job,
                               *words], stderr=subprocess.PIPE, text=True)
        assert done.returncode == 0, done.stderr


def test_damage(place):
    place.run(2, "b.fault=work", "b.at=11", code=4)
    kept = place.pieces()
    assert len(kept) >= 11
    for path in kept[:4]:
        with open(path, "r+b") as f:
            f.seek(-1, os.SEEK_END)
            last = f.read(1)[0]
            f.seek(-1, os.SEEK_END)
            f.write(bytes([last ^ 1]))
    folder, said, done = place.run(2)
    check(folder)
    assert len(done) == 24 - len(kept) + 4
    assert "was damaged and has been removed" in said.err, said.err


def ranks_of(process):
    """Return the process ids of the ranks; an empty list before the ranks have started."""
    try:
        with open("/proc/%d/task/%d/children" % (process.pid, process.pid)) as f:
            return [int(pid) for pid in f.read().split()]
    except OSError:
        return []


def test_kills(place):
    """Kill one rank or all at a random moment, repeatedly until a run is complete."""
    dice = random.Random(int(os.environ.get("RANKS_SEED", "1")))
    for i in range(KILLS):
        place.forget()
        process = place.start(4, "b.wait=10", "b.hold=" + place.hold(11))  # cannot end before the kill
        moment = dice.randrange(1, 24)
        wait_for(lambda: len(place.done()) >= moment, process)
        victims = ranks_of(process)
        for pid in victims if i % 2 else dice.sample(victims, 1):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        process.out, process.err = process.communicate(timeout=LONG)
        assert process.returncode == 137 and "signal 9" in process.err, (process.returncode, process.err)
        place.number -= 1  # the next run of the name removes hidden folders
        kept = len(place.pieces())
        folder, _, done = place.run(dice.choice((0, 2, 4)))
        check(folder)
        assert len(done) == 24 - kept, (kept, done)
        assert not place.hidden(), place.hidden()


def attempt(name, test):
    with tempfile.TemporaryDirectory() as folder:
        try:
            test(Place(folder))
        except Exception:
            return "# %s\nnot ok - %s" % (traceback.format_exc().replace("\n", "\n# "), name)
    return "ok - " + name


def main(names):
    tests = [(n, f) for n, f in names.items() if n.startswith("test_") and n[5:].startswith(tuple(sys.argv[1:]) or "")]
    print("1..%d" % len(tests))
    with concurrent.futures.ThreadPoolExecutor(4) as pool:  # the ranks wait most of the time
        results = list(pool.map(lambda t: attempt(*t), tests))
    print("\n".join(results))
    return any("not ok" in r for r in results)


if __name__ == "__main__":
    if not MPIRUN:
        print("1..0 # SKIP mpirun is missing")
        sys.exit(0)
    sys.exit(main(globals()))
