#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test the steps for LibreLane and SiliconCompiler by these packages, if they are installed in
python3, or in the interpreters LIBRELANE_PYTHON and SILICONCOMPILER_PYTHON. Masks, metrics and
delays must be those of the same flow on the command line."""
import json
import os
import shutil
import subprocess
import sys
import tempfile

BUILD, SOURCE = os.environ["OPCFLOW_BUILD"], os.environ["OPCFLOW_SOURCE"]
sys.path.insert(0, os.path.join(SOURCE, "tests"))
sys.dont_write_bytecode = True
import tap

OPCFLOW = os.path.join(BUILD, "opcflow")
HERE = os.path.dirname(os.path.abspath(__file__))
CONVERT = """opcflow: 1
name: convert
steps:
  layout:
    use: read.cif
    file: %s/data/cells65/nand2.cif
    layers: { poly: CP, active: CA, contact: CC, nwell: CW, metal1: CM }
  gds:
    use: write.gds
    layout: "${layout}"
    file: nand2.gds
    layers: { poly: 9/0, active: 1/0, contact: 10/0, nwell: 3/0, metal1: 11/0, CSN: 4/0, CSP: 5/0 }
"""
FLOW = """opcflow: 1
name: delays
extends: %s/flows/timing.yaml
steps:
  layout:
    use: read.gds
    layers: { poly: 9/0, active: 1/0, contact: 10/0, nwell: 3/0, metal1: 11/0 }
  gds: { use: write.gds, mask: "${mask}", file: mask.gds }
"""
# Requirements are missed with the drawn mask.
DRAWN = ["mask.max_iterations=0", "mask.guard=off"]

LIBRELANE = """
import json, sys
from librelane.plugins import discovered_plugins
from librelane.common import Path
from librelane.config import Config
from librelane.flows import Flow
from librelane.state import DesignFormat, State
from librelane.steps import DeferredStepError, Step
assert "librelane_plugin_opcflow" in discovered_plugins, discovered_plugins
steps = [s.id for s in Flow.factory.get("Classic").Substitute(
    {"+KLayout.StreamOut": "Opcflow.Mask", "+Opcflow.Mask": "Opcflow.Requirements"}).Steps]
at = steps.index("KLayout.StreamOut")
assert steps[at + 1:at + 3] == ["Opcflow.Mask", "Opcflow.Requirements"], steps
process, *settings = sys.argv[1:]
step = Step.factory.get("Opcflow.Mask")
config = Config({"DESIGN_NAME": "nand2", **{v.name: v.default for v in step.config_vars},
                 "OPCFLOW_PROCESS": process, **({"OPCFLOW_SETTINGS": settings} if settings else {})})
earlier = {"earlier": Path("nand2.gds")}
state = State({DesignFormat.GDS: Path("nand2.gds"), DesignFormat.SDF: earlier})
state = step(config, state, _no_filter_conf=True).start(step_dir="step")
try:
    Step.factory.get("Opcflow.Requirements")(config, state, _no_filter_conf=True).start(
        step_dir="check")
    refused = ""
except DeferredStepError as error:
    refused = str(error)
with open("result.json", "w") as f:
    json.dump({"mask": str(state["opcflow_mask"]), "report": str(state["opcflow_report"]),
               "sdf": {k: str(v) for k, v in state["sdf"].items()}, "refused": refused,
               "metrics": {k: float(v) for k, v in state.metrics.items()}}, f)
"""

SILICONCOMPILER = """
import json, os, sys
from siliconcompiler import ASIC, Design, Flowgraph
from siliconcompiler.targets import skywater130_demo
from siliconcompiler.tools.builtin.importfiles import ImportFilesTask
from opcflow.siliconcompiler import MaskTask
process, *settings = sys.argv[1:]
design = Design("nand2")
with design.active_fileset("layout"):
    design.set_topmodule("nand2")
project = ASIC(design)
project.add_fileset("layout")
skywater130_demo(project)
flow = Flowgraph("maskflow")
flow.node("import", ImportFilesTask())
flow.node("mask", MaskTask())
flow.edge("import", "mask")
project.set_flow(flow)
ImportFilesTask.find_task(project).add_import_file(os.path.abspath("nand2.gds"))
task = MaskTask.find_task(project)
task.set("var", "process", process)
task.set("var", "settings", settings)
if not settings:
    task.set("var", "outputs", ["circuit.printed.sdf"])
try:
    project.run()
    code = 0
except RuntimeError:
    code = 1
folder = os.path.join("build", "nand2", "job0", "mask", "0")
with open(os.path.join(folder, "outputs", "nand2.pkg.json")) as f:
    kept = json.load(f)["metric"]
with open("result.json", "w") as f:
    json.dump({"code": code, "outputs": os.path.join(folder, "outputs"), "metrics": {
        name: kept[name]["node"]["mask"]["0"]["value"]
        for name in ("transistors", "drcs", "warnings")}}, f)
"""


def command(*words):
    return subprocess.run([OPCFLOW, *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)


def read(path):
    with open(path, "rb") as f:
        return f.read()


def reference():
    """Run the flow on the command line. Returns a reason if that is not possible."""
    with open("convert.yaml", "w") as f:
        f.write(CONVERT % SOURCE)
    made = command("run", "convert.yaml", "--output", "convert")
    assert not made.returncode, made.stdout
    shutil.copy("convert/nand2.gds", "nand2.gds")
    with open("delays.yaml", "w") as f:
        f.write(FLOW % SOURCE)
    made = command("run", "delays.yaml", "--set", "layout.file=nand2.gds", "--output", "run")
    if made.returncode and "libngspice" in made.stdout:
        return "libngspice is not installed"
    assert not made.returncode, made.stdout
    return None


def call(name, script, process, *settings):
    """Execute a script by the interpreter of a package. Returns its result and its output, and
    None for the result if it has none."""
    for made in ("step", "check", "build", "result.json"):
        shutil.rmtree(made, ignore_errors=True) if os.path.isdir(made) else \
            os.path.exists(made) and os.remove(made)
    with open("script.py", "w") as f:
        f.write(script)
    path = os.pathsep.join([HERE, *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run([interpreter(name), "script.py", process, *settings], text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=240,
                          env={**os.environ, "OPCFLOW_COMMAND": OPCFLOW, "PYTHONPATH": path,
                               "PYTHONDONTWRITEBYTECODE": "1"})
    if not os.path.exists("result.json"):
        return None, done.stdout
    return json.loads(read("result.json")), done.stdout


def interpreter(name):
    return os.environ.get(name.upper() + "_PYTHON", "python3")


def absent(name):
    """Return why the tests of a package are not possible."""
    tried = subprocess.run([interpreter(name), "-c", "import numpy, %s" % name],
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return tried.stdout.strip().split("\n")[-1] if tried.returncode else None


def metrics():
    """Return the metrics of the reference by STEP.METRIC."""
    return {"%s.%s" % (step, name): metric["value"]
            for step, own in json.loads(read("run/metrics.json")).items() if isinstance(own, dict)
            for name, metric in own.items() if isinstance(metric["value"], (int, float))}


def test_librelane():
    """The step has mask, report, metrics and delays of the flow, and keeps earlier delays."""
    result, text = call("librelane", LIBRELANE, "delays.yaml")
    assert result, text
    assert read(result["mask"]) == read("run/mask.gds")
    assert b"<html" in read(result["report"])
    assert sorted(result["sdf"]) == ["earlier", "opcflow_drawn", "opcflow_printed"]
    for sizes in ("drawn", "printed"):
        assert read(result["sdf"]["opcflow_" + sizes]) == read("run/circuit.%s.sdf" % sizes)
    found = result["metrics"]
    expected = {"opcflow__" + name.replace(".", "__"): v for name, v in metrics().items()}
    assert found == {**expected, "opcflow__requirements__missed": 0}, found
    assert found["opcflow__mask__transistors"] == 4 and not result["refused"]


def test_librelane_missed():
    """Missed requirements are a metric, which the second step refuses."""
    result, text = call("librelane", LIBRELANE, "own65", *DRAWN)
    assert result, text
    assert result["metrics"]["opcflow__requirements__missed"] >= 1
    assert result["metrics"]["opcflow__mask__ion_max"] > 1
    assert "missed requirements of the mask" in result["refused"], result
    result, text = call("librelane", LIBRELANE, "nonesuch")
    assert result is None and "no process 'nonesuch'" in text, text


def test_siliconcompiler():
    """The task has mask, report, metrics and delays of the flow."""
    result, text = call("siliconcompiler", SILICONCOMPILER, "delays.yaml")
    assert result and result["code"] == 0, text
    made = {name: read(os.path.join(result["outputs"], name)) for name in (
        "nand2.mask.gds", "nand2.mask.html", "nand2.mask.json", "circuit.printed.sdf")}
    assert made["nand2.mask.gds"] == read("run/mask.gds")
    assert made["circuit.printed.sdf"] == read("run/circuit.printed.sdf")
    assert b"<html" in made["nand2.mask.html"]
    assert json.loads(made["nand2.mask.json"]) == json.loads(read("run/metrics.json"))
    known = metrics()
    assert result["metrics"]["transistors"] == 4
    assert result["metrics"]["drcs"] == known["mask.violations_unexplained"] + known[
        "mask.mask_violations_added"]


def test_siliconcompiler_missed():
    """A missed requirement fails the task, with its metrics and warnings."""
    result, text = call("siliconcompiler", SILICONCOMPILER, "own65", *DRAWN)
    assert result and result["code"] == 1 and "mask.ion_max" in text, text
    assert result["metrics"]["transistors"] == 4 and result["metrics"]["warnings"] >= 1, result


def main():
    tests = [(test_librelane, "librelane"), (test_librelane_missed, "librelane"),
             (test_siliconcompiler, "siliconcompiler"),
             (test_siliconcompiler_missed, "siliconcompiler")]
    reasons = {name: absent(name) for _, name in tests}
    with tempfile.TemporaryDirectory(prefix="opcflow-steps-") as folder:
        os.chdir(folder)
        reason = None if all(reasons.values()) else reference()
        failed = tap.run([(test.__name__, lambda test=test, name=name: reasons[name] or reason or test())
                          for test, name in tests])
        os.chdir("/")
    return failed


sys.exit(main())
