# SPDX-License-Identifier: BSD-3-Clause
"""A task of SiliconCompiler that corrects the mask of a GDSII stream.

    flow.node("mask", MaskTask())
    flow.edge("write.gds", "mask")
    project.set("tool", "opcflow", "task", "mask", "var", "process", "sky130")
"""
import os
import shutil
import subprocess

from siliconcompiler import Task

from .runs import Run, program

FOLDER = "reports/run"
# Metrics of SiliconCompiler, and those of opcflow whose sum they are.
METRICS = {"transistors": ("mask.transistors",),
           "drcs": ("mask.violations_unexplained", "mask.mask_violations_added")}


class MaskTask(Task):
    """Outputs are DESIGN.mask.gds, the page DESIGN.mask.html, DESIGN.mask.json with all metrics,
    and the files `outputs` of the run, such as SDF. A missed requirement fails the task."""

    def __init__(self):
        super().__init__()
        self.add_parameter("process", "str", "process of opcflow, or path of a flow whose layout "
                           "file is open")
        self.add_parameter("settings", "[str]", "settings, such as mask.ion_limit=0.3 %")
        self.add_parameter("outputs", "[str]", "further files of the run, such as c17.printed.sdf")

    def tool(self):
        return "opcflow"

    def task(self):
        return "mask"

    def parse_version(self, stdout):
        return stdout.split()[1]

    def setup(self):
        super().setup()
        self.set_exe("opcflow", vswitch="--version")
        self.set_path(os.path.dirname(program()))
        self.add_version(">=0.2.0")
        self.set_threads()
        self.add_regex("warnings", r"^(warning|finding): ")
        self.add_required_key("var", "process")
        if os.path.isfile(self.get("var", "process") or ""):
            self.set("var", "process", os.path.abspath(self.get("var", "process")))
        self.add_input_file(ext="gds")
        for ext in ("mask.gds", "mask.html", "mask.json"):
            self.add_output_file(ext=ext)
        for name in self.get("var", "outputs"):
            self.add_output_file(name)

    def pre_process(self):
        made = subprocess.run([program(), "new", "flow", "--process", self.get("var", "process"),
                               "inputs/%s.gds" % self.design_topmodule, "flow.yaml"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if made.returncode:
            raise RuntimeError(made.stdout.strip())

    def runtime_options(self):
        words = [*super().runtime_options(), "run", "flow.yaml", "--output", FOLDER,
                 "--threads", self.get_threads()]
        for setting in self.get("var", "settings"):
            words += ["--set", setting]
        return words

    def post_process(self):
        if not os.path.isfile(os.path.join(FOLDER, "manifest.json")):
            return
        run = Run(FOLDER)
        names = {"mask.gds": "mask.gds", "report.html": "mask.html", "metrics.json": "mask.json"}
        pairs = [(name, "%s.%s" % (self.design_topmodule, ext)) for name, ext in names.items()]
        for name, to in (*pairs, *((n, n) for n in self.get("var", "outputs"))):
            if os.path.isfile(run.path(name)):
                shutil.copy(run.path(name), os.path.join("outputs", to))
        for name, parts in METRICS.items():
            self.record_metric(name, int(sum(run.metrics.get(p) or 0 for p in parts)),
                               "outputs/%s.mask.json" % self.design_topmodule)
