# SPDX-License-Identifier: BSD-3-Clause
"""Base classes of plugins, one for each kind. Methods that begin with `call_` translate a request
of the host into a call of the plugin's method."""
import numpy as np

from . import data
from .parameters import Metric, Parameter


class Input(Parameter):
    """Declaration of an input of a step."""

    def __init__(self, kind, summary, required=True):
        super().__init__("input", summary, required=required, choices=kind)


def gates_input(summary, required=True):
    """Declare an input of a step: transistors."""
    return Input("gates", summary, required)


def mask_input(summary, required=True):
    """Declare an input of a step: a corrected mask."""
    return Input("mask", summary, required)


class Plugin:
    """Base of all plugins. A plugin sets these class attributes; the first line of its docstring
    is its summary."""

    kind = None
    version = "0.1.0"
    licence = "BSD-3-Clause"
    deterministic = False   # True: equal inputs produce equal bits; results are kept
    optional = ("check",)   # methods that a plugin can define

    @classmethod
    def describe(cls):
        """Return the description of the class for the host."""
        members = {}
        for base in reversed(cls.__mro__):
            members.update(vars(base))
        return {"kind": cls.kind, "version": cls.version, "licence": cls.licence,
                "summary": (cls.__doc__ or "").strip().split("\n")[0].rstrip("."),
                "deterministic": cls.deterministic,
                "methods": [name for name in cls.optional if hasattr(cls, name)],
                "parameters": [m.describe() for m in members.values()
                               if isinstance(m, Parameter)],
                "metrics": [m.describe() for m in members.values() if isinstance(m, Metric)]}

    def set_parameters(self, values):
        """Set the attributes of all parameters, by the names used in flows."""
        for name in dir(type(self)):
            member = getattr(type(self), name)
            if isinstance(member, Parameter) and member.describe()["name"] in values:
                setattr(self, name, values[member.describe()["name"]])

    def call_check(self, values, arrays):
        self.set_parameters(values["parameters"])
        self.check()


class Synthesizer(Plugin):
    """Kind synthesizer. A plugin defines update(feedback, moves), which changes the arrays of
    `moves` in place and returns True at the end of the loop. Optional methods: begin(feedback);
    verdict(gate), a few words or None; targets(), the target of Ion of each gate."""

    kind = "synthesizer"
    optional = ("check", "verdict", "targets")

    def begin(self, feedback):
        """Start a loop."""

    def feedback(self, values, arrays):
        return data.Record(
            iteration=values["iteration"], ion_limit=values["ion_limit"], gates=self.gates,
            scanner=data.Record(**values["scanner"]),
            design=data.performance(arrays, "design"), printed=data.performance(arrays, "printed"),
            **{name: arrays.get(name) for name in ("flags", "vetoes", "end", "next_end")})

    def call_begin(self, values, arrays):
        self.set_parameters(values["parameters"])
        self.gates = data.gates(values, arrays, "gates")
        self.begin(self.feedback(values, arrays))

    def call_update(self, values, arrays):
        moves = data.Record(**data.part_of(arrays, "moves"))
        if hasattr(moves, "part"):
            moves.part = moves.part.reshape(-1, data.PARTS, 3)
        done = self.update(self.feedback(values, arrays), moves)
        if not isinstance(done, (bool, np.bool_)):
            raise TypeError("update must return True or False, found %r" % (done,))
        return {"done": bool(done)}

    def call_verdicts(self, values, arrays):
        verdicts = [self.verdict(i) for i in range(self.gates.count)]
        return {"verdicts": [v if v is None else str(v) for v in verdicts]}

    def call_targets(self, values, arrays):
        targets = np.asarray(self.targets(), float)
        if targets.shape != (self.gates.count,):
            raise ValueError("targets has the shape %s, expected (%d,)" %
                             (targets.shape, self.gates.count))
        return {"arrays": {"targets": targets}}


class Extractor(Plugin):
    """Kind extractor. A plugin defines slicing(), which returns the places and the widths of the
    slices as fractions of the gate width, and extract(slices, out), which fills the arrays of
    `out`. slices.width, length and edge have the shape (gates, slices). Optional: prepare()."""

    kind = "extractor"

    def prepare(self):
        """Prepare the instance once."""

    def call_prepare(self, values, arrays):
        self.set_parameters(values["parameters"])
        self.prepare()
        place, width = self.slicing()
        return {"arrays": {"place": np.asarray(place, float), "width": np.asarray(width, float)}}

    def call_extract(self, values, arrays):
        shape = (-1, values["slices"])
        self.extract(data.Record(type=arrays["type"], flavour=values["flavour"],
                                 **{name: arrays[name].reshape(shape)
                                    for name in ("width", "length", "edge")}),
                     data.performance(arrays, "out"))


class Resist(Plugin):
    """Kind resist. A plugin defines level(layer, image), which returns the level set of the
    intensity `image.values` at the nodes, shape (ny, nx): positive where the resist remains.
    `image.frame` is x0, y0, width, height in nm. Optional: prepare(scanner)."""

    kind = "resist"

    def prepare(self, scanner):
        """Prepare the instance once."""

    def call_prepare(self, values, arrays):
        self.set_parameters(values["parameters"])
        self.prepare(data.Record(**values["scanner"]))

    def call_print(self, values, arrays):
        nodes = arrays["values"].reshape(values["ny"], values["nx"])
        nodes[...] = self.level(values["layer"], data.Record(values=nodes, frame=arrays["frame"]))


class Step(Plugin):
    """Kind step. A plugin declares inputs by gates_input and mask_input, and defines run()."""

    kind = "step"

    def call_run(self, values, arrays):
        self.set_parameters(values["parameters"])
        for name, kind in values["inputs"].items():
            self.set_parameters({name: getattr(data, kind)(values, arrays, name)})
        self.run()

    def ask(self, what, **fields):
        """Send a message to the host; the worker replaces this method."""
        raise RuntimeError("no run: '%s' is not available" % what)

    def table(self, name, columns, units=None, decimals=-1, show=False):
        """Publish the table `name` from a dictionary of equally long columns, with the unit of
        each column in `units`. `show`: also print the table."""
        all_columns = []
        for label, column in columns.items():
            array = np.asarray(column)
            kind = "int" if array.dtype.kind in "iub" else \
                "real" if array.dtype.kind == "f" else "text"
            values = [str(v) for v in column] if kind == "text" else \
                [v if v == v else None for v in array.tolist()]
            all_columns.append({"name": label, "unit": (units or {}).get(label), "type": kind,
                                "decimals": decimals, "values": values})
        rows = {len(c["values"]) for c in all_columns}
        if len(rows) > 1:
            raise ValueError("table '%s': columns of %s rows" % (name, sorted(rows)))
        self.ask("table", name=name, columns=all_columns, print=show, rows=min(rows, default=0))

    def metric(self, name, value):
        """Publish the value of a declared metric."""
        self.ask("metric", name=name, value=float(value))

    def output_path(self, name):
        """Return the path at which to write the file `name` of the run folder."""
        return self.ask("output_path", name=name)

    def progress(self, done, total):
        """Report progress in any unit."""
        self.ask("progress", done=float(done), total=float(total))
