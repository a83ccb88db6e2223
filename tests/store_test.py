#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test the store of results by the command: which steps run and which are reused
after each kind of change. A reused run must equal a run without reuse (`--no-cache`), also
after damage, kills, a full disk, and with other processes."""
import glob
import json
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
import tap

BUILD = os.environ["OPCFLOW_BUILD"]
OPCFLOW = os.path.join(BUILD, "opcflow")
FLOW = """opcflow: 1
name: chain
steps:
  a: { use: test.numbers, size: 2 nm, input: in.txt, behave: find }
  b: { use: test.kept, number: 5, add: ${a}, file: b.txt }
  c: { use: test.kept, number: 7, add: ${b} }
  d: { use: test.kept, number: 9, add: ${c}, file: d.txt }
  e: { use: test.numbers, size: 1 nm, output: deep/e.txt }
"""
ALL = {"a", "b", "c", "d", "e"}
number = 0


def write(name, text):
    with open(name, "w") as f:
        f.write(text)


def call(*words, store="store", code=0, **more):
    env = dict(os.environ, OPCFLOW_STORE=os.path.abspath(store) if store else "", **more)
    done = subprocess.run([OPCFLOW, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env)
    assert code is None or done.returncode == code, (words, done.returncode, done.stderr)
    return done


def run(*words, flow="chain.yaml", **more):
    """Return a new run folder and the finished command."""
    global number
    number += 1
    folder = "runs/%d" % number
    done = call("run", flow, "--quiet", "--output", folder, *words, **more)
    return folder, done


def manifest(folder):
    with open(os.path.join(folder, "manifest.json")) as f:
        return json.load(f)


def ran(folder):
    """Return the steps that ran, with the reasons."""
    return {r["step"]: r["reason"] for r in manifest(folder)["store"]["results"] if r["result"] == "ran"}


def times(text):
    """Return the logged times of steps, s."""
    return {step: float(s) for step, s in re.findall(r"^\[\d/5\] (\w+): ([\d.]+) s$", text, re.M)}


def same(a, b):
    """Return the bytes of all files except the manifest."""
    def files(folder):
        return {f["path"]: f["sha256"] for f in manifest(folder)["files"] if not f["path"].endswith("manifest.json")}
    assert files(a) == files(b), (files(a), files(b))


def fresh():
    for name in ("store", "runs"):
        shutil.rmtree(name, ignore_errors=True)
    write("in.txt", "some input\n")
    write("chain.yaml", FLOW)
    os.makedirs("runs")


# ---- steps that run ----

def test_again():
    truth, _ = run("--no-cache")
    first, said = run()
    second, again = run()
    assert set(ran(first)) == ALL and set(ran(first).values()) == {"not seen before"}
    assert ran(second) == {}
    same(truth, first)
    same(first, second)
    assert said.stderr == again.stderr and "finding: a: 2 nm is odd" in again.stderr
    shown = call("run", "chain.yaml", "--output", "runs/x", "--log", "info")
    assert "5 of 5 steps reused" in shown.stdout and "a: reused" in shown.stderr
    # By default, only steps of a second or more are logged, and no reused steps.
    silent = call("run", "chain.yaml", "--output", "runs/z").stderr
    assert "reused" not in silent and all(s >= 1 for s in times(silent).values()), silent
    slow = ("run", "chain.yaml", "--no-cache", "--set", "b.wait=1100", "--output")
    assert times(call(*slow, "runs/slow").stderr)["b"] >= 1.1
    assert "[2/5]" not in call(*slow, "runs/slower", "--quiet").stderr
    printed = json.loads(call("run", "chain.yaml", "--json", "--output", "runs/y").stdout)
    assert (printed["steps"], printed["reused"]) == (5, 5)
    results = manifest(second)["store"]["results"]
    before = manifest(first)["store"]["results"]
    assert [r["key"] for r in results] == [r["key"] for r in before]
    assert [r["seconds"] for r in results] == [r["seconds"] for r in before]
    assert manifest(second)["processor"] == manifest(first)["processor"]


def test_processor():
    """A step that sleeps uses no processor time; the steps use most of the time of the process."""
    slow, _ = run("--no-cache", "--set", "b.wait=1100")
    assert manifest(slow)["steps"]["b"] > 1.1 and manifest(slow)["processor"]["b"] < 0.5
    flow = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "flows", "dpb.yaml")
    started = subprocess.Popen([OPCFLOW, "run", flow, "--no-cache", "--quiet", "--output", "runs/dpb"],
                               stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(started.pid, 0)
    started.returncode = os.waitstatus_to_exitcode(status)
    total = used.ru_utime + used.ru_stime
    assert started.returncode == 0 and total / 2 < sum(manifest("runs/dpb")["processor"].values()) <= total


def test_parameter():
    run()
    folder, _ = run("--set", "c.number=8")
    # The output of b is restored. This requires the output of a, which cannot be stored, so that a
    # runs again.
    assert ran(folder) == {"a": "step 'b' requires the output", "c": "c.number changed from 7 to 8",
                           "d": "input d.add changed"}, ran(folder)
    same(folder, run("--set", "c.number=8", "--no-cache")[0])
    shown = call("run", "chain.yaml", "--set", "c.number=9", "--log", "info",
                 "--output", "runs/printed").stderr
    assert "b: reused\n" in shown and "a: ran again: step 'b' requires the output\n" in shown, shown
    assert "a: reused" not in shown, shown
    text = call("explain", folder).stdout
    assert "c.number changed from 7 to 8" in text and "2 of 5 steps reused" in text, text
    assert json.loads(call("explain", folder, "--json").stdout)["reused"] == 2
    folder, _ = run("--set", "d.file=other.txt")
    assert set(ran(folder)) == {"a", "d"} and os.path.exists(folder + "/other.txt")


def test_other_processor():
    """A processor without AVX2 and FMA does not reuse results, whose last bits would differ."""
    qemu = shutil.which("qemu-x86_64")
    if not qemu or os.uname().machine != "x86_64":
        return "no qemu-x86_64"
    env = dict(os.environ, OPCFLOW_STORE=os.path.abspath("store"))
    for name, processor in (("new", "Haswell"), ("same", "Haswell"), ("old", "Nehalem")):
        done = subprocess.run([qemu, "-cpu", processor, OPCFLOW, "run", "chain.yaml", "--quiet", "--output",
                               "runs/" + name], capture_output=True, text=True, env=env)
        if "Sanitizer" in done.stderr:
            return "a sanitized program cannot be emulated"
        assert done.returncode == 0, done.stderr
    assert ran("runs/same") == {} and set(ran("runs/old")) == ALL, ran("runs/old")


def test_told_apart():
    """Test an explicit default value, another output of the same step, and a value of a map."""
    write("chain.yaml", """opcflow: 1
steps:
  a: { use: test.kept }
  b: { use: test.kept, add: "${a}" }
  m: { use: test.numbers, size: 2 nm, names: { poly: one, active: two } }
""")
    run()
    assert ran(run()[0]) == {}
    assert ran(run("--set", "a.number=1.0")[0])["a"] == "a.number was set or unset, with the same value 1"
    folder, _ = run("--set", "b.add=${a.twice}")
    assert "b" in ran(folder)
    same(folder, run("--set", "b.add=${a.twice}", "--no-cache")[0])
    assert "m" in ran(run("--set", "m.names.active=three")[0])


def test_no_effect():
    run()
    folder, _ = run("--set", "b.wait=1", "--set", "e.behave=find", "--set", "c.timeout=1 min", "--threads", "1")
    assert ran(folder) == {}, ran(folder)


def test_file():
    run()
    write("in.txt", "SOME input\n")  # same length and time
    folder, _ = run()
    assert ran(folder)["a"] == "file in.txt (a.input) changed" and set(ran(folder)) == {"a", "b", "c", "d"}
    os.utime("in.txt")
    assert ran(run()[0]) == {}
    # A cached checksum is not used for another file.
    os.utime("in.txt", (1e9, 1e9))
    time.sleep(2.1)
    run()
    about = os.stat("in.txt")
    write("in.txt", "some INPUT\n")
    os.utime("in.txt", ns=(about.st_atime_ns, about.st_mtime_ns))
    assert "a" in ran(run()[0])


def test_beside():
    """Test files that no parameter names: kernels in the folder of their weights."""
    paths = dict(OPCFLOW_PLUGIN_PATH=os.path.join(BUILD, "plugins"))
    flows = os.path.join(os.environ["OPCFLOW_SOURCE"], "flows")

    def kernel(value):  # 5 x 5 frequencies; only orders up to 1 are not 0
        rows = [value if abs(i % 5 - 2) + abs(i // 5 - 2) < 2 else 0.0 for i in range(25)]
        with open("set/fh0.bin", "wb") as f:
            f.write(struct.pack(">6i", 5, 5, 2, 2, 2, 2) + b"".join(struct.pack(">2f", v, 0) for v in rows))

    os.makedirs("set", exist_ok=True)
    write("set/scales.txt", "1\n1\n")
    kernel(1.0)
    write("chain.yaml", """opcflow: 1
extends: %s/models.yaml
steps:
  picture:
    first: { litho: { use: litho.kernels, focus: set/scales.txt, period: 400 nm },
             resist: { use: resist.threshold, threshold: 0.3, active_threshold: 0.3 } }
    second: ~
    third: ~
    fourth: ~
""" % flows)
    first, _ = run(**paths)
    assert ran(run(**paths)[0]) == {}
    kernel(0.9)
    folder, _ = run(**paths)
    assert "file fh0.bin (picture.fh0.bin beside first.litho.focus) changed" in ran(folder)["picture"], ran(folder)
    same(folder, run("--no-cache", **paths)[0])
    os.unlink("set/fh0.bin")
    run(code=5, **paths)


def test_file_meanwhile():
    """Test that no result is stored if an input file changes before the step runs."""
    write("chain.yaml", "opcflow: 1\nname: x\nsteps:\n  a: { use: test.kept }\n"
          "  b: { use: test.numbers, size: 1 nm, input: in.txt, add: ${a} }\n")
    env = dict(os.environ, OPCFLOW_STORE=os.path.abspath("store"))
    child = subprocess.Popen([OPCFLOW, "run", "chain.yaml", "--quiet", "--output", "runs/slow", "--set", "a.hold=held"],
                             env=env)
    while not os.path.exists("held"):
        assert child.poll() is None
        time.sleep(0.01)
    write("in.txt", "another one\n")
    os.unlink("held")
    assert child.wait() == 0
    write("in.txt", "some input\n")
    assert set(ran(run()[0])) == {"b"}
    assert ran(run()[0]) == {}


def test_plugin():
    own = os.path.abspath("own")
    shutil.rmtree(own, ignore_errors=True)
    os.mkdir(own)
    shutil.copy(os.path.join(BUILD, "tests/test.kept.so"), own)
    words = ("--plugin-path", own)
    run(*words)
    assert ran(run(*words)[0]) == {}
    shutil.copy(os.path.join(BUILD, "tests/test.kept.so"), own + "/new")
    with open(own + "/new", "ab") as f:
        f.write(b"!")
    os.rename(own + "/new", own + "/test.kept.so")
    folder, _ = run(*words)
    assert set(ran(folder)) == {"a", "b", "c", "d"}, ran(folder)
    assert "plugin test.kept was rebuilt" in ran(folder)["b"]


def test_fickle():
    """Test that results of a plugin without OPC_DETERMINISTIC, and of dependent steps, are not stored."""
    write("chain.yaml", FLOW.replace("c: { use: test.kept", "c: { use: test.fickle"))
    run()
    folder, _ = run()
    assert set(ran(folder)) == {"a", "c", "d"}, ran(folder)
    assert "does not promise" in ran(folder)["c"] and "'c'" in ran(folder)["d"]


def test_moved():
    first, _ = run()
    os.makedirs("elsewhere", exist_ok=True)
    shutil.move("chain.yaml", "elsewhere/renamed.yaml")
    shutil.move("in.txt", "elsewhere/in.txt")
    second, _ = run(flow="elsewhere/renamed.yaml")
    assert ran(second) == {}, ran(second)
    # A step with another name writes its table under this name.
    write("in.txt", "some input\n")
    write("chain.yaml", FLOW.replace(" d: ", " z: "))
    assert ran(run()[0]) == {}


def test_required():
    write("chain.yaml", FLOW + "require: { d.sum: 1 }\n")
    _, first = run(code=1)
    folder, second = run(code=1)
    assert ran(folder) == {} and first.stderr == second.stderr and "expected at most 1" in second.stderr


def test_failure():
    """Test that the result of a failed step is not stored."""
    for _ in range(2):
        done = call("run", "chain.yaml", "--quiet", "--set", "c.file=in/../../x", code=None)
        assert done.returncode
    folder, _ = run()
    assert "c" in ran(folder)


# ---- sweeps ----

SWEEP = FLOW.replace("number: 7", "number: 7, wait: 10") + "sweep: { c.number: [1, 2, 3, 4, 5, 6, 7, 8] }\n"


def test_sweep():
    write("chain.yaml", SWEEP)
    truth, _ = run("--no-cache", "--keep")
    first, _ = run("--keep")
    second, _ = run("--keep")
    reasons = [r["reason"] for r in manifest(first)["store"]["results"] if r["step"] == "c"]
    assert reasons[1] == "c.number changed from 1 to 2" and len(reasons) == 8
    assert ran(second) == {}

    def files(folder):
        return {f["path"]: f["sha256"] for f in manifest(folder)["files"] if f["path"] != "sweep.csv"}
    assert files(truth) == files(first) == files(second)
    # An additional value: only that point runs, with the outputs of the shared steps.
    third, _ = run("--sweep", "c.number=[1, 2, 3, 4, 5, 6, 7, 8, 9]")
    assert set(ran(third)) == {"a", "c", "d"}
    assert [r["point"] for r in manifest(third)["store"]["results"] if r["result"] == "ran" and r["step"] == "c"] == [9]


def test_kills():
    """Test that a sweep that is killed at any moment continues, with the same result."""
    write("chain.yaml", SWEEP)
    truth, _ = run("--no-cache", "--keep")
    dice = random.Random(int(os.environ.get("KILL_SEED", 1)))
    reused = 0
    for _ in range(int(os.environ.get("KILLS", 12))):
        env = dict(os.environ, OPCFLOW_STORE=os.path.abspath("store"))
        if dice.random() < 0.3:
            call("cache", "clear")
        child = subprocess.Popen([OPCFLOW, "run", "chain.yaml", "--quiet", "--output", "runs/killed"], env=env,
                                 stderr=subprocess.DEVNULL)
        time.sleep(dice.uniform(0.005, 0.12))
        child.kill()
        child.wait()
        shutil.rmtree("runs/killed", ignore_errors=True)
        folder, done = run("--keep")
        reused += manifest(folder)["store"]["reused"]
        assert "damaged" not in done.stderr
        for name in glob.glob(truth + "/0*/**/*.*", recursive=True) + [truth + "/metrics.json"]:
            if os.path.isfile(name) and not name.endswith("flow.yaml"):
                with open(name, "rb") as a, open(folder + name[len(truth):], "rb") as b:
                    assert a.read() == b.read(), name
    assert reused
    assert not os.listdir("store/new"), os.listdir("store/new")


def test_real():
    """Test that a restored mask and a reused search have the same metrics as in the first run."""
    paths = dict(OPCFLOW_PLUGIN_PATH=os.path.join(BUILD, "plugins"))
    flows = os.path.join(os.environ["OPCFLOW_SOURCE"], "flows")
    write("chain.yaml", """opcflow: 1
extends: %s/search.yaml
steps:
  best: { sweep: { mask.synthesizer.fragment: [30 nm], mask.max_iterations: [1, 2] } }
  judged: { fine: off }
  again: { use: cost.fracture, mask: ${judged} }
""" % flows)
    truth, _ = run("--no-cache", **paths)
    with_search = ("--set", "surface=~", "--set", "cost=~", "--set", "gds=~", "--set", "picture=~", "--set", "again=~")
    run(*with_search, **paths)
    folder, _ = run(**paths)
    assert set(ran(folder)) == {"best", "best.layout", "best.gates", "surface", "cost", "gds", "picture", "again"}, ran(folder)
    same(truth, folder)
    printed = manifest(folder + "/best")["store"]  # includes the steps that all points share
    assert printed["reused"] == sum(r["result"] == "reused" for r in printed["results"]) > 0, printed
    folder, _ = run("--set", "best.sweep.mask.synthesizer.fragment=[30 nm, 60 nm]", **paths)
    assert ran(folder)["best.mask"].startswith("mask.synthesizer.fragment changed from "), ran(folder)["best.mask"]
    assert manifest(folder)["store"]["reused"] >= 1


# ---- damage ----

def entries(ending=""):
    return sorted(glob.glob("store/entries/*/*" + ending))


def test_damaged():
    first, _ = run()
    for spoil in (lambda d: d[:len(d) // 2], lambda d: b"", lambda d: d[:-1] + bytes([d[-1] ^ 1]),
                  lambda d: d[:90] + bytes([d[90] ^ 1]) + d[91:]):
        for name in entries(".result") + entries(".outputs") + entries(".facts"):
            with open(name, "rb") as f:
                data = f.read()
            with open(name, "wb") as f:
                f.write(spoil(data))
        folder, done = run()
        same(first, folder)
        assert set(ran(folder)) == ALL, ran(folder)
        assert "was damaged and has been removed" in done.stderr, done.stderr
        assert ran(run()[0]) == {}


def test_outputs_gone():
    """Test that missing outputs are computed again."""
    run()
    for name in entries(".outputs"):
        os.unlink(name)
    folder, _ = run("--set", "d.number=10")
    assert set(ran(folder)) == {"a", "b", "c", "d"}
    assert ran(folder)["c"] == "step 'd' requires the output", ran(folder)
    same(folder, run("--set", "d.number=10", "--no-cache")[0])


def test_edited():
    """Test that changes of a run folder do not change the store."""
    first, _ = run()
    second, _ = run()
    with open(second + "/b.txt", "a") as f:
        f.write("mine\n")
    third, _ = run()
    assert ran(third) == {}
    same(first, third)


def test_together():
    """Test several concurrent processes, one of which clears the store."""
    write("chain.yaml", SWEEP)
    truth, _ = run("--no-cache", "--keep")
    env = dict(os.environ, OPCFLOW_STORE=os.path.abspath("store"))
    many = [subprocess.Popen([OPCFLOW, "run", "chain.yaml", "--quiet", "--keep", "--output", "runs/t%d" % i],
                             env=env, stderr=subprocess.PIPE, text=True) for i in range(4)]
    while any(m.poll() is None for m in many):
        call("cache", "clear")
        call("cache")
    for i, m in enumerate(many):
        _, err = m.communicate()
        assert m.returncode == 0 and "damaged" not in err and "store:" not in err, err
        for name in ("metrics.json", "0003/d.txt", "0008/c.kept.csv"):
            if os.path.exists(os.path.join(truth, name)):
                with open(os.path.join(truth, name), "rb") as a, open("runs/t%d/%s" % (i, name), "rb") as b:
                    assert a.read() == b.read(), name


def test_place():
    """Test a store that cannot be created or written: a warning, and the run continues."""
    write("file", "")
    folder, done = run(store="file/store")
    assert "no results are kept or reused" in done.stderr and "store" not in manifest(folder)
    first, _ = run()
    shutil.copytree("store", "full")
    # Files of more than 512 bytes fail as on a full disk; stored results are used.
    env = dict(os.environ, OPCFLOW_STORE=os.path.abspath("full"))
    shutil.rmtree("full/new")
    write("full/new", "")  # nothing can be written
    done = subprocess.run([OPCFLOW, "run", "chain.yaml", "--quiet", "--output", "runs/full", "--set", "d.number=3"],
                          env=env, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0 and done.stderr.count("warning: store:") == 1, done.stderr
    assert {"b", "c", "e"}.isdisjoint(ran("runs/full"))
    os.unlink("full/new")
    shutil.rmtree("full")
    same(first, run()[0])
    done = call("run", "chain.yaml", "--quiet", "--output", "runs/off", store=None)
    assert "store" not in manifest("runs/off") and not done.stdout


def test_limit():
    run()
    size = json.loads(call("cache", "--json").stdout)
    assert size["entries"] > 5 and size["limit"] == 2000000000
    assert size["bytes"] == sum(os.path.getsize(e) for e in entries())
    keep = sorted(entries(".result"), key=os.path.getmtime)
    for age, name in enumerate(entries()):
        os.utime(name, (age + 1, age + 1))
    os.utime(keep[0])  # used last
    call("cache", "limit", "%d B" % (size["bytes"] // 2))
    left = json.loads(call("cache", "--json").stdout)
    assert 0 < left["bytes"] <= left["limit"] == size["bytes"] // 2
    assert os.path.exists(keep[0])
    assert json.loads(call("cache", "--json", OPCFLOW_STORE_LIMIT="3 MB").stdout)["limit"] == 3000000
    call("cache", "limit", "5 GB")
    assert "5.0 GB" in call("cache").stdout
    for wrong in (("limit", "much"), ("limit",), ("limit", "-1 GB"), ("wipe",), ("clear", "all")):
        call("cache", *wrong, code=2)
    call("cache", "clear")
    assert entries() == [] and json.loads(call("cache", "--json").stdout)["bytes"] == 0
    # Results that exceed the limit are not stored.
    call("cache", "limit", "0")
    run()
    assert set(ran(run()[0])) == ALL


def test_explain():
    folder, _ = run("--no-cache")
    assert "--no-cache" in call("explain", folder, code=2).stderr
    assert "no such run folder" in call("explain", "nowhere", code=5).stderr
    near = os.path.basename(folder) + "x"
    assert f"did you mean '{folder}'?" in call(
        "explain", os.path.join(os.path.dirname(folder), near), code=5).stderr
    write("runs/manifest.json", "[1")
    call("explain", "runs", code=2)
    write("runs/manifest.json", '{"store": {"results": [1, {"step": 2}, {}], "steps": "x"}}')
    call("explain", "runs")


def main():
    home = tempfile.mkdtemp(prefix="opcflow-store-")
    os.chdir(home)
    os.environ["OPCFLOW_PLUGIN_PATH"] = os.path.join(BUILD, "tests")
    tests = [(n[5:], t) for n, t in globals().items() if n.startswith("test_") and n[5:].startswith(tuple(sys.argv[1:]) or "")]
    failed = tap.run(tests, fresh)
    os.chdir("/")
    shutil.rmtree(home)
    return failed


sys.exit(main())
