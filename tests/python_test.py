#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test plugins in Python by the command: synthesizer.pydpb makes the same mask as
synthesizer.dpb. Changed files are part of the key of kept results. A killed process is
reported, and no process outlives its host. More kills: KILLS=100 tests/python_test.py"""
import hashlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile

sys.dont_write_bytecode = True
import tap

BUILD, SOURCE = os.environ["OPCFLOW_BUILD"], os.environ["OPCFLOW_SOURCE"]
OPCFLOW = os.path.join(BUILD, "opcflow")
EXAMPLES = os.path.join(SOURCE, "subprojects", "python", "examples")
FLOW = """opcflow: 1
name: small
steps:
  layout:
    use: read.cif
    file: SOURCE/data/cells65/nand2.cif
    layers: { poly: CP, active: CA, contact: CC, nwell: CW }
  gates: { use: segment.transistors, layout: "${layout}", grid: 1 nm }
  slow: { use: test.slow, gates: "${gates}" }
"""
SLOW = '''import os
import time
from opcflow import Step, gates_input, metric, real


class Slow(Step):
    """Writes its process number to a file, then waits"""
    deterministic = True
    gates = gates_input("transistors")
    seconds = real("time to wait", unit="s", preset="0 s")
    count = metric("number of transistors")

    def check(self):
        """Start the process before the time limit of the step begins"""

    def run(self):
        with open(os.environ["PID_FILE"], "w") as f:
            f.write(str(os.getpid()))
        end = time.monotonic() + self.seconds
        while time.monotonic() < end:
            pass
        self.metric("count", self.gates.count)
'''


def write(path, text):
    with open(path, "w") as f:
        f.write(text)


def environment(**more):
    path = os.pathsep.join(["plugins", EXAMPLES, os.environ["OPCFLOW_PLUGIN_PATH"]])
    return dict(os.environ, OPCFLOW_PLUGIN_PATH=path, PID_FILE="pid", **more)


def call(*words, code=0, **more):
    done = subprocess.run([OPCFLOW, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, env=environment(**more))
    assert done.returncode == code, (words, done.returncode, done.stdout)
    return done.stdout


def pid_of_worker(process):
    """Wait until the worker of a running command has written its process number."""
    while process.poll() is None:
        try:
            with open("pid") as f:
                text = f.read()
            if text:
                return int(text)
        except OSError:
            pass
        time.sleep(0.005)
    raise AssertionError("the command ended: %s" % process.communicate()[0])


def start(*words):
    if os.path.exists("pid"):
        os.remove("pid")
    return subprocess.Popen([OPCFLOW, "run", "flow.yaml", "--quiet", "--force", "--output", "out/x",
                             *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            env=environment())


def is_running(pid):
    """Return whether a process exists and is no zombie."""
    try:
        with open("/proc/%d/stat" % pid) as f:
            return f.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_same_mask():
    """The masks of the C plugin and of the Python plugin have the same bits."""
    sums = []
    for name in ("dpb", "pydpb"):
        call("run", os.path.join(SOURCE, "flows", "dpb.yaml"), "--quiet", "--output", "out/" + name,
             "--set", "mask.synthesizer.use=synthesizer." + name,
             "--set", "layout.file=" + os.path.join(SOURCE, "data", "cells65", "sram4.gds"))
        with open("out/%s/mask.gds" % name, "rb") as f:
            sums.append(hashlib.sha256(f.read()).hexdigest())
    assert sums[0] == sums[1], sums


def reused(folder, **more):
    """Run the flow and return whether the step in Python was reused."""
    call("run", "flow.yaml", "--quiet", "--force", "--output", folder, **more)
    with open(os.path.join(folder, "manifest.json")) as f:
        steps = json.load(f)["store"]["results"]
    return {s["step"]: s["result"] == "reused" for s in steps}["slow"]


def test_key():
    """A result is reused until the file of the plugin or of a module beside it changes."""
    store = {"OPCFLOW_STORE": os.path.abspath("store")}
    write("plugins/helper.py", "VALUE = 1\n")
    write("plugins/test.slow.py", SLOW.replace("import time", "import time\nimport helper", 1))
    assert not reused("out/key", **store)
    assert reused("out/key", **store)
    write("plugins/helper.py", "VALUE = 2\n")
    assert not reused("out/key", **store)
    assert reused("out/key", **store)
    write("plugins/test.slow.py", SLOW)
    assert not reused("out/key", **store)


def test_inspect():
    """inspect, plugins and check know the plugin; a wrong value is reported with its place."""
    assert "time to wait" in call("inspect", "test.slow")
    assert "test.slow" in call("plugins")
    found = call("check", "flow.yaml", "--set", "slow.seconds=1 nm", code=2)
    assert "slow.seconds" in found, found


def test_kills():
    """Kill workers at random moments: the command reports the step and the plugin, keeps the
    earlier run folder, and leaves nothing hidden."""
    call("run", "flow.yaml", "--quiet", "--output", "out/x")
    before = open("out/x/manifest.json").read()
    generator = random.Random(1)
    for i in range(int(os.environ.get("KILLS", "4"))):
        process = start("--set", "slow.seconds=20 s")
        pid = pid_of_worker(process)
        time.sleep(generator.random() * 0.3)
        os.kill(pid, signal.SIGKILL)
        text = process.communicate()[0]
        assert process.returncode == 4, (i, process.returncode, text)
        assert "step 'slow' (test.slow)" in text and "signal 9 (Killed) in run" in text, text
        assert open("out/x/manifest.json").read() == before, i
        shutil.rmtree("out/x.failed", ignore_errors=True)
        assert set(os.listdir("out")) <= SHOWN, os.listdir("out")


def test_host_killed():
    """The worker ends with its host, although the worker is in a loop."""
    process = start("--set", "slow.seconds=60 s")
    pid = pid_of_worker(process)
    assert is_running(pid)
    process.kill()
    process.wait()
    end = time.monotonic() + 120
    while is_running(pid):
        assert time.monotonic() < end, "the worker outlives its host"
        time.sleep(0.02)


def test_time_limit():
    """A step that exceeds `timeout` fails; the place in the Python file is logged."""
    text = call("run", "flow.yaml", "--force", "--output", "out/x", "--set", "slow.seconds=60 s",
                "--set", "slow.timeout=3 s", code=4)
    assert "exceeded the time limit of 3 s" in text, text
    assert "test.slow.py" in text and "in run" in text, text


def test_lint():
    """lint checks a plugin in Python as one in C."""
    text = call("lint", os.path.join(EXAMPLES, "synthesizer.pydpb.py"))
    assert "work on several threads" in text and "not checked: nothing" in text, text


SHOWN = {"x", "dpb", "pydpb", "key", "network", "ilt", "given"}


def test_kit():
    """The examples' unit tests by the test kit, without opcflow."""
    for name in ("pydpb", "network"):
        subprocess.run(["python3", "-B", os.path.join(EXAMPLES, name + "_test.py")], check=True,
                       env=dict(os.environ, PYTHONPATH=os.path.dirname(EXAMPLES)),
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def test_network():
    """The correction loop with the resist by a neural network: the mask meets the flow's limit,
    and differs from the mask of a constant threshold."""
    table = os.path.join(EXAMPLES, "thresholds.csv")
    cell = os.path.join(SOURCE, "data", "cells65", "sram4.gds")
    call("run", os.path.join(SOURCE, "flows", "dpb.yaml"), "--quiet", "--output", "out/network",
         "--set", "layout.file=" + cell,
         "--set", "mask.resist={ use: resist.network, table: '%s' }" % table)
    with open("out/network/metrics.json") as f:
        metrics = json.load(f)["mask"]
    assert metrics["failed"]["value"] == 0 and metrics["ion_mean"]["value"] < 0.5, metrics
    with open("out/network/mask.gds", "rb") as f, open("out/dpb/mask.gds", "rb") as g:
        assert f.read() != g.read()


def interpreter(modules):
    """Return an interpreter that has NumPy and other modules, None if there is none."""
    for python in ("python3", "/usr/bin/python3"):
        if not subprocess.run([python, "-c", "import numpy, " + modules],
                              capture_output=True).returncode:
            return python
    return None


def test_ilt():
    """Inverse lithography: the unit test, and a mask whose transistors are closer to the
    drawn ones than those of the drawn mask."""
    python = interpreter("torch")
    if not python:
        return "python3 has no PyTorch"
    subprocess.run([python, "-B", os.path.join(EXAMPLES, "ilt_test.py")], check=True,
                   env=dict(os.environ, PYTHONPATH=os.path.dirname(EXAMPLES)),
                   stderr=subprocess.DEVNULL)
    call("new", "flow", "small.yaml")
    use = dict(OPCFLOW_PYTHON=python)
    cif = ["layout.use=read.cif", "layout.file=%s" % os.path.abspath("nand2.cif"),
           "layout.layers={ poly: CP, active: CA, contact: CC, nwell: CW }"]
    cif = [word for setting in cif for word in ("--set", setting)]
    call("run", os.path.join(EXAMPLES, "ilt.yaml"), "--quiet", "--output", "out/ilt", *cif, **use)
    call("run", os.path.join(SOURCE, "flows", "given.yaml"), "--quiet", "--output", "out/given",
         *cif, "--set", "other.use=read.cif", "--set", "other.layers={ poly: CP, active: CA }",
         "--set", "other.file=%s" % os.path.abspath("out/ilt/mask.cif"), code=1)
    with open("out/given/metrics.json") as f:
        metrics = {name: m["value"] for name, m in json.load(f)["mask"].items()}
    assert metrics["failed"] == 0, metrics
    assert metrics["ion_mean"] < 0.8 * metrics["ion_mean_drawn"], metrics
    return None


KINDS = ("synthesizer", "regulator", "extractor", "resist", "litho", "step")


def test_new():
    """A new plugin of each kind passes its test and lint. A synthesizer and its test have at
    most 40 lines, and the test fails for a method that does nothing."""
    python = dict(PYTHONPATH=os.path.join(BUILD, "subprojects", "python"))
    for kind in KINDS:
        id, folder = kind + ".mine", "new/" + kind
        written = call("new", "plugin", "--language", "python", id, folder).split()
        assert os.path.join(folder, id + ".py") in written, written
        assert not [f for f in written if f.endswith((".c", "meson.build"))], written
        subprocess.run(["python3", "-B", "mine_test.py"], cwd=folder, check=True,
                       env=environment(**python))
        assert "not checked: nothing" in call("lint", os.path.join(folder, id + ".py"))
    folder, check = "new/synthesizer/", ["python3", "-B", "mine_test.py"]
    with open(folder + "synthesizer.mine.py") as f, open(folder + "mine_test.py") as g:
        text = f.read()
        assert len(text.splitlines()) + len(g.read().splitlines()) <= 40
    write(folder + "synthesizer.mine.py", text.replace("return not", "step[:] = 0\n        return not"))
    assert subprocess.run(check, cwd=folder, env=environment(**python), capture_output=True).returncode
    found = call("new", "plugin", "--language", "perl", "synthesizer.mine", code=3)
    assert "no template in the language 'perl'" in found, found


def test_description():
    """A plugin is described once, and again after a change of its file or of a module."""
    write("python", '#!/bin/sh\necho >> starts\nexec python3 "$@"\n')
    os.chmod("python", 0o755)
    more = dict(OPCFLOW_STORE=os.path.abspath("described"), OPCFLOW_PYTHON=os.path.abspath("python"))
    call("run", "flow.yaml", "--quiet", "--force", "--output", "out/key", **more)  # makes the store
    write("plugins/helper.py", "SECONDS = '1 s'\n")
    text = SLOW.replace("import time", "import time\nimport helper", 1)

    def described(expected, starts):
        write("starts", "")
        found = call("inspect", "test.described", **more)
        assert expected in found, found
        assert os.path.getsize("starts") == starts, (expected, os.path.getsize("starts"))

    write("plugins/test.described.py", text.replace('"0 s"', "helper.SECONDS"))
    described("1 s", 1)
    described("1 s", 0)
    write("plugins/helper.py", "SECONDS = '2 s'\n")
    described("2 s", 1)
    write("plugins/test.described.py", text.replace('"0 s"', "'3 s'"))
    described("3 s", 1)
    described("3 s", 0)
    for name in os.listdir("described/python"):
        if len(name) == 64:
            write("described/python/" + name, '{"kind"')
    described("3 s", 1)
    more["OPCFLOW_PYTHON"] = "/nowhere"
    assert "cannot start" in call("inspect", "test.described", code=3, **more)


def cif_polygons(path):
    """Return the polygons of a CIF file in nm, as sorted lists of points by layer."""
    found, layer = {}, None
    with open(path) as f:
        for line in f:
            if line.startswith("L "):
                layer = line[2:].rstrip(";\n")
            elif line.startswith("P "):
                n = [int(word) for word in line[2:].rstrip(";\n").split()]
                found.setdefault(layer, []).append(sorted(zip(n[::2], n[1::2])))
    return {name: sorted(polygons) for name, polygons in found.items()}


def area(polygons):
    """Return the area of polygons without holes, in nm^2."""
    total = 0
    for p in polygons:
        (x, y), (u, v) = p.T, p[list(range(1, len(p))) + [0]].T
        total += abs((x * v - u * y).sum()) / 2
    return total


def check_contours(run):
    """The printed poly of the corrected mask has about the drawn area and covers the middle of
    each gate; contours of the drawn mask differ."""
    outlines, holes = run.contours("poly")
    before, _ = run.contours("poly", before=True)
    drawn = area(run.drawing("poly.drawn"))
    assert not holes and len(outlines) == len(before)
    assert 0.8 * drawn < area(outlines) < 1.1 * drawn, (area(outlines), drawn)
    assert abs(area(before) - area(outlines)) > 0.001 * drawn
    for row in run.table("gates"):
        x, y = row["x (nm)"], row["y (nm)"]
        assert any(inside(x, y, p) for p in outlines), row


def inside(x, y, polygon):
    """Return whether a point is inside a polygon: an odd number of edges to the right."""
    odd = False
    for (x0, y0), (x1, y1) in zip(polygon, [*polygon[1:], polygon[0]]):
        odd ^= (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0)
    return odd


def test_runs():
    """Run flows and read folders by the package: metrics, tables, polygons, comparisons."""
    sys.path.insert(0, os.path.join(BUILD, "subprojects", "python"))
    import opcflow
    os.environ["OPCFLOW_COMMAND"] = OPCFLOW
    call("new", "flow", "user.yaml")
    with open("user.yaml") as f:
        text = f.read()
    cif = '  cif: { use: write.cif, mask: "${mask}", file: mask.cif }\nrequire:'
    write("user.yaml", text.replace("require:", cif.replace(
        "require:", '  drawing: { use: write.klayout, mask: "${mask}" }\nrequire:')))
    first = opcflow.run("user.yaml")
    second = opcflow.run("user.yaml", output="out/x", mask__synthesizer__ion_limit="3 %",
                         **{"mask.ion_limit": "4 %"})
    assert not first.problems and first.folder != second.folder
    with open("out/x/metrics.json") as f:
        worst = json.load(f)["mask"]["ion_max"]["value"]
    assert second.metrics["mask.ion_max"] == worst > first.metrics["mask.ion_max"]
    with open(second.path("gates.csv")) as f:
        lines = f.read().splitlines()
    rows = second.table("gates")
    assert len(rows) == len(lines) - 1 == 4 and rows[0]["w (nm)"] == 400.0
    assert rows[3]["transistor"] == lines[4].split(",")[0] and "history" in second.tables
    cif = cif_polygons(second.path("mask.cif"))
    gds = {layer: sorted(sorted(map(tuple, p.round(6))) for p in polygons)
           for layer, polygons in second.shapes("mask.gds").items()}
    assert len(cif) >= 2, cif
    for layer, polygons in cif.items():
        assert polygons in gds.values(), (layer, polygons, gds)
    drawn = sorted(sorted(map(tuple, p.round(6))) for p in second.mask("poly"))
    assert drawn == cif["CP"], (drawn, cif)
    check_contours(second)
    try:
        second.mask("metal")
        raise AssertionError("a layer that does not exist was read")
    except KeyError as error:
        assert "poly.mask" in str(error)
    try:
        second.shapes("gates.csv")
        raise AssertionError("a table was read as GDSII")
    except ValueError as error:
        assert "gates.csv" in str(error)
    found = opcflow.compare(first, second)
    assert len(found.tables["runs"]) == 2 and "mask.ion_max" in found._repr_html_()
    assert "<table>" in second._repr_html_()
    assert re.search(r"<td>mask.ion_max</td><td>[\d.]+</td><td>%</td>", second._repr_html_())
    try:
        opcflow.run("user.yaml", mask__synthesizer__ion_limt="3 %")
        raise AssertionError("an unknown parameter was accepted")
    except opcflow.Failed as error:
        assert error.code == 2 and "ion_limt" in str(error), error
    folder = first.folder
    del first
    assert not os.path.exists(folder)
    shutil.rmtree("out/x")


def test_wheel():
    """The wheel has the version of the project and the modules that are installed; a unit test
    runs with the wheel alone."""
    python = interpreter("setuptools, wheel, pip")
    if not python:
        return "python3 has no pip, setuptools or wheel"
    package = os.path.join(SOURCE, "subprojects", "python")
    shutil.copytree(package, "wheel", ignore=shutil.ignore_patterns("examples"))
    made = subprocess.run([python, "-m", "pip", "wheel", "--no-deps", "--no-index",
                           "--no-build-isolation", "--wheel-dir", ".", "./wheel"],
                          capture_output=True, text=True)
    assert not made.returncode, made.stdout + made.stderr
    with open(os.path.join(package, "meson.build")) as f:
        version = re.search(r"version: '(.*?)'", f.read())[1]
    name = "opcflow-%s-py3-none-any.whl" % version
    with zipfile.ZipFile(name) as wheel:
        modules = sorted(n for n in wheel.namelist() if n.endswith(".py"))
    installed = os.listdir(os.path.join(BUILD, "subprojects", "python", "opcflow"))
    assert modules == sorted(["librelane_plugin_opcflow.py", *(
        "opcflow/" + n for n in installed if n.endswith(".py"))]), modules
    subprocess.run(["python3", "-B", os.path.join(EXAMPLES, "pydpb_test.py")], check=True,
                   env=dict(os.environ, PYTHONPATH=os.path.abspath(name)),
                   stderr=subprocess.DEVNULL)
    return None


STAT = '''import numpy as np
from opcflow import Step, gates_input, mask_input, metric


class Stat(Step):
    """Measures a mask"""
    mask = mask_input("mask")
    gates = gates_input("transistors", required=False)
    ion = metric("mean of |Ion deviation|", unit="%")
    printed = metric("number of transistors that print")

    def run(self):
        assert self.gates is None and self.mask.flags.shape == (self.mask.gates.count,)
        self.metric("ion", 100 * np.mean(np.abs(self.mask.after.ion / self.mask.design.ion - 1)))
        self.metric("printed", np.count_nonzero(self.mask.flags == 0))
'''


def test_mask_input():
    """A step in Python receives a mask; an input that is not required can be absent."""
    write("plugins/test.stat.py", STAT)
    write("stat.yaml", "opcflow: 1\nname: stat\nextends: %s/flows/demo.yaml\n"
          "steps: { stat: { use: test.stat, mask: '${mask}' } }\n" % SOURCE)
    call("run", "stat.yaml", "--output", "out/stat", "--set", "picture=~")
    with open("out/stat/metrics.json") as f:
        metrics = json.load(f)
    stat, mask = metrics["stat"], metrics["mask"]
    assert abs(stat["ion"]["value"] - mask["ion_mean"]["value"]) < 1e-9, (stat, mask["ion_mean"])
    assert stat["printed"]["value"] == mask["transistors"]["value"] == 4, stat


def test_modules():
    """A file without a dot in its name is a module of plugins, not a plugin."""
    write("plugins/module.py", "raise SystemExit('executed')\n")
    write("plugins/test.name.py", "import nothing_of_this_name\n")
    failed = call("plugins", "--failed")
    assert "test.name" in failed and "module" not in failed.replace("No module named", ""), failed
    assert "unknown plugin 'module'" in call("inspect", "module", code=3)
    os.remove("plugins/test.name.py")


def main():
    tests = [test_same_mask, test_inspect, test_key, test_kills, test_time_limit,
             test_host_killed, test_lint, test_kit, test_network, test_ilt, test_new, test_description,
             test_runs, test_wheel, test_modules, test_mask_input]
    with tempfile.TemporaryDirectory(prefix="opcflow-python-") as folder:
        os.chdir(folder)
        os.mkdir("plugins")
        write("plugins/test.slow.py", SLOW)
        write("flow.yaml", FLOW.replace("SOURCE", SOURCE))
        missing = subprocess.run(["python3", "-c", "import numpy"], stderr=subprocess.DEVNULL).returncode
        failed = tap.run([(test.__name__, (lambda: "python3 has no NumPy") if missing else test)
                          for test in tests])
        os.chdir("/")
    return failed


sys.exit(main())
