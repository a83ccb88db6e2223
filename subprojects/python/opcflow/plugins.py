# SPDX-License-Identifier: BSD-3-Clause
"""Base classes of plugins, one for each kind. Methods that begin with `call_` translate a request
of the host into a call of the plugin's method. `self.gates` are the transistors of a loop."""
import numpy as np

from . import data
from .parameters import Metric, Parameter


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

    def call_check(self):
        self.check()


class Synthesizer(Plugin):
    """Kind synthesizer. A plugin defines update(feedback, moves), which changes the arrays of
    `moves` in place and returns True at the end of the loop. Optional methods: begin(feedback);
    verdict(gate), a few words or None; targets(), the target of Ion of each gate."""

    kind = "synthesizer"
    optional = ("check", "verdict", "targets")

    def begin(self, feedback):
        """Start a loop."""

    def call_begin(self, feedback):
        self.begin(self.complete(feedback))

    def complete(self, feedback):
        feedback.gates, feedback.scanner = self.gates, self.scanner
        return feedback

    def call_update(self, feedback, moves):
        if moves.part is not None:
            moves.part = moves.part.reshape(-1, data.PARTS, 3)
        done = self.update(self.complete(feedback), moves)
        if not isinstance(done, (bool, np.bool_)):
            raise TypeError("update must return True or False, found %r" % (done,))
        return {"done": bool(done)}

    def call_verdicts(self):
        verdicts = [self.verdict(i) for i in range(self.gates.count)]
        return {"verdicts": [v if v is None else str(v) for v in verdicts]}

    def call_targets(self):
        targets = np.asarray(self.targets(), float)
        if targets.shape != (self.gates.count,):
            raise ValueError("targets has the shape %s, expected (%d,)" %
                             (targets.shape, self.gates.count))
        return {"targets": targets}


class Regulator(Plugin):
    """Kind regulator. A plugin defines rule(printed, ruling), which changes ruling.vetoes and
    ruling.end (gates, 2) in place. violations(printed) returns a list of tuples: name of the
    rule, gate or -1, x, y, value, limit. ruling.transistors is the number of transistors without a
    failure. ruling.added and ruling.cutouts are lists with an array of boxes (n, 4) for each
    layer. printed.print is a list of level sets with `values` (ny, nx) and `frame`."""

    kind = "regulator"

    def call_rule(self, printed, ruling):
        printed.gates, layers = self.gates, range(len(self.gates.layers))
        ruling.transistors = self.gates.count
        ruling.added, ruling.cutouts = [[] for _ in layers], [[] for _ in layers]
        self.rule(printed, ruling)
        reply = {"transistors": int(ruling.transistors)}
        for name in ("added", "cutouts"):
            reply[name] = np.vstack([np.zeros((0, 5), np.int32)] + [
                np.insert(np.reshape(np.asarray(boxes, np.int32), (-1, 4)), 4, k, axis=1)
                for k, boxes in enumerate(getattr(ruling, name))])
        return reply

    def call_violations(self, printed):
        printed.gates = self.gates
        found = [tuple(v) for v in self.violations(printed)]
        return {"rules": [str(v[0]) for v in found],
                "figures": np.array([v[1:] for v in found], float).reshape(-1, 5)}


class Extractor(Plugin):
    """Kind extractor. A plugin defines slicing(), which returns the places and the widths of the
    slices as fractions of the gate width, and extract(slices, out), which fills the arrays of
    `out`. slices.width, length and edge have the shape (gates, slices). Optional: prepare()."""

    kind = "extractor"

    def prepare(self):
        """Prepare the instance once."""

    def call_prepare(self):
        self.prepare()
        place, width = self.slicing()
        return {"place": np.asarray(place, float), "width": np.asarray(width, float)}

    def call_extract(self, slices, out):
        self.extract(slices, out)


class Resist(Plugin):
    """Kind resist. A plugin defines level(layer, image), which returns the level set of the
    intensity `image.values` at the nodes, shape (ny, nx): positive where the resist remains.
    `image.frame` is x0, y0, width, height in nm. Optional: prepare(scanner)."""

    kind = "resist"

    def prepare(self, scanner):
        """Prepare the instance once."""

    def call_prepare(self):
        self.prepare(self.scanner)

    def call_print(self, layer, image):
        image.values[...] = self.level(layer, image)


class Litho(Plugin):
    """Kind litho. A plugin defines band(), the highest frequency of masks in 1/nm, and
    image(layer, mask, defocus), which returns the intensity at nodes of mask.frame, shape
    (ny, nx); the clear field has 1. `mask` is a Spectrum. Optional: prepare(); scanner(), which
    returns wavelength in nm and NA; the attribute focuses = True, if `defocus` has an effect."""

    kind = "litho"
    optional = ("check", "scanner", "focuses")

    def prepare(self):
        """Prepare the instance once."""

    def call_prepare(self):
        self.prepare()
        return {"band": float(self.band())}

    def call_image(self, layer, mask, defocus):
        image = np.asarray(self.image(layer, mask, defocus), np.float32)
        return {"image": image, "nx": image.shape[1]}

    def call_scanner(self):
        return dict(zip(("wavelength", "na"), map(float, self.scanner())))


class Step(Plugin):
    """Kind step. A plugin declares inputs by gates_input and mask_input, and defines run()."""

    kind = "step"

    def call_run(self, inputs):
        self.set_parameters(vars(inputs))
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
