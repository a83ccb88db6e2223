# SPDX-License-Identifier: BSD-3-Clause
"""Run flows and read run folders.

    run = opcflow.run("flow.yaml", mask__ion_limit="0.3 %")
    run.metrics["mask.ion_max"], run.table("gates")
"""
import csv
import json
import os
import shutil
import subprocess
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
# The program in an installation, in a build folder, and in the PATH.
PLACES = ("../../../../bin/opcflow", "../../../../../bin/opcflow", "../../../opcflow")


class Failed(RuntimeError):
    """A run that ended without a complete run folder: exit code and messages of the program."""

    def __init__(self, code, text):
        super().__init__("opcflow ended with exit code %d: %s" % (code, text))
        self.code = code


def program():
    """Return the path of the program: OPCFLOW_COMMAND, the program that was installed with this
    package, or the one in the PATH."""
    places = [os.environ.get("OPCFLOW_COMMAND"), *(os.path.join(HERE, p) for p in PLACES),
              shutil.which("opcflow")]
    for path in places:
        if path and os.path.isfile(path):
            return os.path.normpath(path)
    raise FileNotFoundError("the program opcflow is not in the PATH (set OPCFLOW_COMMAND)")


def call(*words):
    """Execute the program. Returns exit code, standard output and standard error."""
    done = subprocess.run([program(), *map(str, words)], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True)
    return done.returncode, done.stdout, done.stderr


def run(flow, output=None, variant=None, threads=None, plugin_path=(), **settings):
    """Run a flow and return the Run. A setting `mask__ion_limit="0.3 %"` is the parameter
    mask.ion_limit. Without `output` the run folder is temporary, and removed with the Run; an
    existing run in `output` is replaced. Raises Failed if the run is not complete."""
    temporary = None if output else tempfile.TemporaryDirectory(prefix="opcflow-")
    folder = output or os.path.join(temporary.name, "run")
    words = ["run", flow, "--quiet", "--force", "--output", folder]
    for name, value in (("--variant", variant), ("--threads", threads)):
        words += [] if value is None else [name, value]
    for path in [plugin_path] if isinstance(plugin_path, str) else plugin_path:
        words += ["--plugin-path", path]
    for name, value in settings.items():
        text = json.dumps(value) if isinstance(value, (bool, list, dict)) else value
        words += ["--set", "%s=%s" % (name.replace("__", "."), text)]
    code, _, text = call(*words)
    if code > 1 or not os.path.isfile(os.path.join(folder, "manifest.json")):
        raise Failed(code, text.strip())
    made = Run(folder)
    made.temporary = temporary
    made.messages = text.splitlines()
    made.problems = [line for line in made.messages if line.startswith("error: ")]
    return made


def number(text):
    """Return the number of a field, or the text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


class Run:
    """A run folder. `problems`: requirements of the flow that the run does not meet."""

    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        self.manifest = self.json("manifest.json")
        self.messages, self.problems = [], []

    def path(self, name):
        """Return the path of a file of the run."""
        return os.path.join(self.folder, name)

    def json(self, name):
        """Return the content of a JSON file."""
        with open(self.path(name)) as f:
            return json.load(f)

    @property
    def metrics(self):
        """Values by STEP.METRIC."""
        return {"%s.%s" % (step, name): m["value"] for step, own in
                self.json("metrics.json").items() if isinstance(own, dict)
                for name, m in own.items() if isinstance(m, dict) and "value" in m}

    @property
    def tables(self):
        """Names of all tables."""
        return sorted(n[:-len(".csv")] for n in os.listdir(self.folder) if n.endswith(".csv"))

    def table(self, name):
        """Return a table: a DataFrame if pandas is installed, otherwise a list of dictionaries."""
        with open(self.path(name + ".csv"), newline="") as f:
            rows = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(f)]
        try:
            import pandas
        except ImportError:
            return rows
        return pandas.DataFrame(rows)
