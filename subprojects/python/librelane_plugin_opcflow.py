# SPDX-License-Identifier: BSD-3-Clause
"""Steps of LibreLane, which loads this module by its name: Opcflow.Mask corrects the mask of the
GDSII stream, Opcflow.Requirements checks the requirements of the flow.

    Flow: Classic
    substituting_steps: { +KLayout.StreamOut: Opcflow.Mask, +Opcflow.Mask: Opcflow.Requirements }
"""
import os
from typing import List, Optional

from librelane.common import Path
from librelane.config import Variable
from librelane.state import DesignFormat
from librelane.steps import Step, StepException
from librelane.steps.checker import MetricChecker
from opcflow.runs import Run, program

DesignFormat("opcflow_mask", "mask.gds", "Mask (GDSII Stream)", alts=["OPCFLOW_MASK"]).register()
DesignFormat("opcflow_report", "mask.html", "Report on the Mask", alts=["OPCFLOW_REPORT"]).register()
MISSED = "opcflow__requirements__missed"


@Step.factory.register()
class Mask(Step):
    """
    Corrects the mask until each transistor performs as drawn.

    The metric ``mask.ion_max`` of opcflow is ``opcflow__mask__ion_max``. Delays of the printed
    transistors are SDF views, if the flow computes delays.
    """

    id = "Opcflow.Mask"
    name = "Mask Correction"
    inputs = [DesignFormat.GDS]
    outputs = [DesignFormat.OPCFLOW_MASK, DesignFormat.OPCFLOW_REPORT, DesignFormat.SDF]
    config_vars = [
        Variable("OPCFLOW_PROCESS", str,
                 "A process of opcflow, or the path of a flow whose layout file is open.",
                 default="sky130"),
        Variable("OPCFLOW_SETTINGS", Optional[List[str]],
                 "Settings of the flow, such as ``mask.ion_limit=0.3 %``."),
    ]

    def run(self, state_in, **kwargs):
        folder = os.path.abspath(self.step_dir)
        flow, made = os.path.join(folder, "flow.yaml"), os.path.join(folder, "run")
        self.run_subprocess([program(), "new", "flow", "--process", self.config["OPCFLOW_PROCESS"],
                             os.path.abspath(state_in[DesignFormat.GDS]), flow],
                            log_to=os.path.join(folder, "new.log"), **kwargs)
        words = [program(), "run", flow, "--output", made]
        for setting in self.config["OPCFLOW_SETTINGS"] or []:
            words += ["--set", setting]
        code = self.run_subprocess(words, check=False, **kwargs)["returncode"]
        if code not in (0, 1):  # 1: requirements missed, which are a metric
            raise StepException("opcflow ended with exit code %d" % code)
        run = Run(made)
        metrics = {"opcflow__" + name.replace(".", "__"): value
                   for name, value in run.metrics.items() if isinstance(value, (int, float))}
        metrics[MISSED] = sum(not r["kept"] for r in run.json("metrics.json").get("require", ()))
        views = {}
        for view, name in ((DesignFormat.OPCFLOW_MASK, "mask.gds"),
                           (DesignFormat.OPCFLOW_REPORT, "report.html")):
            if os.path.isfile(run.path(name)):
                views[view] = Path(run.path(name))
        delays = {"opcflow_" + name.split(".")[-2]: Path(run.path(name))
                  for name in sorted(os.listdir(made)) if name.endswith(".sdf")}
        if delays:
            views[DesignFormat.SDF] = {**(state_in.get(DesignFormat.SDF) or {}), **delays}
        return views, metrics


@Step.factory.register()
class Requirements(MetricChecker):
    id = "Opcflow.Requirements"
    name = "Mask Requirement Checker"
    metric_name = MISSED
    metric_description = "missed requirements of the mask"
