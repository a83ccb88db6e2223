# SPDX-License-Identifier: BSD-3-Clause
"""Run flows and read run folders.

    run = opcflow.run("flow.yaml", mask__ion_limit="0.3 %")
    run.metrics["mask.ion_max"], run.table("gates")
"""
import csv
import json
import os
import re
import shutil
import subprocess
import tempfile
from html import escape

# From the file of write.klayout, with any layer that the file has.
CONVERT = """opcflow: 1
name: convert
steps:
  layout: { use: read.oasis, file: %s, layers: { any: %s } }
  gds: { use: write.gds, layout: "${layout}", file: layout.gds }
"""
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

    def measured(self, part):
        return {"%s.%s" % (step, name): m[part] for step, own in
                self.json("metrics.json").items() if isinstance(own, dict)
                for name, m in own.items() if isinstance(m, dict) and part in m}

    @property
    def metrics(self):
        """Values by STEP.METRIC."""
        return self.measured("value")

    @property
    def units(self):
        """Units of the metrics by STEP.METRIC, None for a number without unit."""
        return self.measured("unit")

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

    def shapes(self, name):
        """Return the polygons of a flat GDSII file of the run, such as a mask or contours: lists
        of arrays (points, 2) in nm by (layer, datatype)."""
        with open(self.path(name), "rb") as f:
            return read_gds(f.read(), self.path(name))

    def mask(self, layer):
        """Return the polygons of the mask of a layer, such as "poly"."""
        return self.drawing(layer + ".mask")

    def contours(self, layer, before=False):
        """Return the printed contours of a layer: of the mask, or with `before` of the drawn
        mask. Two lists: outlines, and holes in them."""
        name = layer + (".before" if before else ".after")
        return self.drawing(name), self.drawing(name + ".holes", ())

    def drawing(self, name, *default):
        """Return the polygons of a layer in the files of write.klayout, arrays (points, 2) in
        nm. The program converts the file to GDSII at the first call."""
        if not hasattr(self, "drawings"):
            self.drawings = self.read_drawings()
        found = self.drawings.get(name, *default)
        if found is None:
            raise KeyError("%s: no layer '%s', expected %s" %
                           (self.folder, name, ", ".join(sorted(self.drawings))))
        return list(found)

    def read_drawings(self):
        styles = [n for n in os.listdir(self.folder) if n.endswith(".lyp")]
        if len(styles) != 1:
            raise FileNotFoundError("%s: %d files NAME.lyp, expected one of write.klayout" %
                                    (self.folder, len(styles)))
        names = re.findall(r"<name>(.*?)</name>\s*<source>(\d+)/(\d+)@", open(
            self.path(styles[0])).read())
        with tempfile.TemporaryDirectory(prefix="opcflow-") as folder:
            flow = os.path.join(folder, "flow.yaml")
            with open(flow, "w") as f:
                f.write(CONVERT % (json.dumps(self.path(styles[0][:-len("lyp")] + "oas")),
                                   "%s/%s" % names[0][1:]))
            shapes = run(flow, os.path.join(folder, "run")).shapes("layout.gds")
        return {name: shapes.get((int(layer), int(kind)), []) for name, layer, kind in names}

    def _repr_html_(self):
        units = self.units
        rows = [(name, value, units[name] or "") for name, value in self.metrics.items()
                if isinstance(value, (int, float))]
        faults = "".join("<p>%s</p>" % escape(p) for p in self.problems)
        return "<h4>%s</h4>%s%s" % (escape(self.folder), faults,
                                    html(("metric", "value", "unit"), rows))


class Comparison:
    """Comparison of runs by `opcflow compare`. `tables`: lists of dictionaries by name."""

    def __init__(self, document):
        self.metrics = {name: m["value"] for name, m in document["metrics"].items()}
        self.tables = {t["name"]: [dict(zip([c["name"] for c in t["columns"]], row))
                                   for row in t["rows"]] for t in document["tables"]}

    def _repr_html_(self):
        return "".join("<h4>%s</h4>%s" % (escape(name), html(rows[0], [r.values() for r in rows]))
                       for name, rows in self.tables.items() if rows)


def compare(*runs):
    """Compare runs or run folders with the first one, and return the Comparison."""
    code, text, messages = call("compare", *(getattr(r, "folder", r) for r in runs), "--json")
    if code > 1:
        raise Failed(code, messages.strip())
    return Comparison(json.loads(text))


def html(names, rows):
    """Return a table in HTML."""
    def line(cell, values):
        texts = ["%g" % v if isinstance(v, float) else str(v) for v in values]
        return "<tr>%s</tr>" % "".join("<%s>%s</%s>" % (cell, escape(t), cell) for t in texts)
    return "<table>%s%s</table>" % (line("th", names), "".join(line("td", r) for r in rows))


def real(eight):
    """Return a number of GDSII: sign, exponent of 16, and 56 bits of a fraction."""
    sign, fraction = -1 if eight[0] & 128 else 1, int.from_bytes(eight[1:], "big")
    return sign * fraction * 16.0 ** ((eight[0] & 127) - 64 - 14)


def read_gds(data, name):
    """Return the polygons of a GDSII file without references."""
    import numpy as np
    at, unit, layer, element, found = 0, None, [0, 0], 0, {}
    while at < len(data):
        size, kind = int.from_bytes(data[at:at + 2], "big"), data[at + 2:at + 3]
        body = data[at + 4:at + size]
        if size < 4 or at + size > len(data):
            raise ValueError("%s: record at byte %d is truncated" % (name, at))
        if kind in (b"\x09", b"\x0a", b"\x0b", b"\x2d"):
            raise ValueError("%s: element 0x%s at byte %d, expected polygons only" %
                             (name, kind.hex(), at))
        if kind in (b"\x08", b"\x0c"):
            element = kind
        elif kind == b"\x03":
            unit = real(body[8:16]) * 1e9
        elif kind in (b"\x0d", b"\x0e"):
            layer[kind[0] - 13] = int.from_bytes(body, "big")
        elif kind == b"\x10" and element == b"\x08":
            points = np.frombuffer(body, ">i4").reshape(-1, 2)[:-1] * unit
            found.setdefault(tuple(layer), []).append(points)
        elif kind == b"\x04":
            return found
        at += size
    raise ValueError("%s: the file has no end record" % name)
