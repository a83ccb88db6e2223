# SPDX-License-Identifier: BSD-3-Clause
"""Results of a run: table of the transistors, layers and markers in a view."""
import csv
import json
import os
import re

import pya

COLUMNS = ("transistor", "type", "l (nm)", "w (nm)", "ion_before (%)", "ion_after (%)",
           "ioff_after (%)", "area_after (%)", "verdict")
MARKERS = "view.lyrdb"  # in coordinates of the view


class Results:
    """The files of a run folder. `scale`: factor from the coordinates of the view to those of the
    run, which flows set to enlarge a layout."""

    def __init__(self, folder):
        self.folder = folder
        with open(self.path("gates.csv"), newline="") as f:
            self.rows = list(csv.DictReader(f))
        with open(self.path("metrics.json")) as f:
            self.metrics = json.load(f)
        with open(self.path("flow.yaml")) as f:
            scale = re.search(r"^  layout:.*\n(?:    .*\n)*?    scale: (\S+)", f.read(), re.M)
        self.scale = float(scale[1]) if scale else 1.0

    def path(self, name):
        return os.path.join(self.folder, name)

    def metric(self, name):
        """Return the value of a metric of the step 'mask'."""
        return self.metrics["mask"][name]["value"]

    def place(self, row):
        """Return the middle of a transistor in um of the view."""
        return pya.DPoint(*(float(row[name]) / 1000 / self.scale for name in ("x (nm)", "y (nm)")))

    def fill_database(self, database):
        """Read the markers into a report database, in coordinates of the view."""
        with open(self.path("run.lyrdb")) as f:
            text = f.read()
        shrink = pya.DCplxTrans(1 / self.scale)
        text = re.sub(  # the shapes of write.klayout's markers are boxes
            "(?<=<value>)box: .*?(?=</value>)",
            lambda m: pya.RdbItemValue(shrink * pya.RdbItemValue.from_s(m[0]).box()).to_s(), text)
        with open(self.path(MARKERS), "w") as f:
            f.write(text)
        database.load(self.path(MARKERS))

    def show(self, view):
        """Show layers and markers in the view, above the layout. Returns the index of the new
        cell view."""
        box, active = view.box(), view.active_cellview().index()
        index = view.load_layout(self.path("run.oas"), "", True)
        view.cellview(index).layout().dbu /= self.scale
        view.load_layer_props(self.path("run.lyp"), index, False)
        view.set_active_cellview_index(active)
        view.zoom_box(box)
        self.fill_database(view.rdb(view.create_rdb("opcflow")))
        return index

    def hide(self, view):
        """Remove layers and markers from the view, if the user has not removed them."""
        for i in reversed(range(view.cellviews())):
            if view.cellview(i).filename() == self.path("run.oas"):
                view.erase_cellview(i)
        for i in reversed(range(view.num_rdbs())):
            if view.rdb(i).filename() == self.path(MARKERS):
                view.remove_rdb(i)
