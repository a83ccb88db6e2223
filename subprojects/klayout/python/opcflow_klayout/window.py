# SPDX-License-Identifier: BSD-3-Clause
"""The window 'opcflow' of KLayout: choice of process and shapes, progress, table."""
import atexit
import os
import re
import tempfile

import pya

from . import cells
from .job import Failed, Job, processes
from .results import COLUMNS, Results

PERIOD = 50      # ms between two looks at the process
AROUND = 1.0     # um that are shown on each side of a transistor
STEPS = 1000     # of the progress bar
KEPT = {}        # the window and the action of the menu; Python would free them otherwise


class Window(pya.QDialog):
    """A window for the current view."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.job, self.results, self.busy = None, None, False
        self.view = pya.LayoutView.current()
        self.setWindowTitle("opcflow")
        self.resize(760, 420)
        self.process, self.action, self.shapes = (pya.QComboBox(self) for _ in range(3))
        self.process.setEditable(True)
        for name in ("Correct", "Simulate drawn"):
            self.action.addItem(name)
        for name in ("Selection, else current cell", "Current cell"):
            self.shapes.addItem(name)
        self.button, self.report = pya.QPushButton("Start", self), pya.QPushButton("Report", self)
        self.button.clicked(self.start_or_cancel)
        self.report.clicked(self.open_report)
        self.report.setEnabled(False)
        self.bar, self.label = pya.QProgressBar(self), pya.QLabel(self)
        self.bar.setMaximum(STEPS)
        self.label.setWordWrap(True)
        self.table = pya.QTreeWidget(self)
        self.table.setHeaderLabels(list(COLUMNS))
        self.table.setRootIsDecorated(False)
        self.table.itemClicked(self.zoom)
        self.timer = pya.QTimer(self)
        self.timer.timeout(self.poll)
        self.arrange()
        self.fill_processes()
        atexit.register(self.end)

    def arrange(self):
        row = pya.QHBoxLayout()
        for widget in (self.process, self.action, self.shapes, self.button, self.report):
            row.addWidget(widget)
        column = pya.QVBoxLayout(self)
        column.addLayout(row)
        for widget in (self.bar, self.label, self.table):
            column.addWidget(widget)
        self.setLayout(column)

    def fill_processes(self):
        try:
            for name in processes():
                self.process.addItem(name)
        except (OSError, RuntimeError) as failure:
            self.label.setText(str(failure))

    def start_or_cancel(self, *_):
        if self.job:
            self.job.cancel()
        else:
            self.start()

    def start(self):
        """Start a run; the timer follows the run. KLayout handles events while it writes the
        layout, so that a second call is possible before the first one ends."""
        if self.busy or self.job:
            return
        self.busy = True
        try:
            self.begin()
        finally:
            self.busy = False

    def begin(self):
        self.view = pya.LayoutView.current()
        cellview = self.view.active_cellview() if self.view else None
        if not cellview or not cellview.is_valid() or not cellview.cell:
            self.label.setText("No layout is open.")
            return
        objects = [] if self.shapes.currentIndex else [
            o for o in self.view.each_object_selected() if o.cv_index == cellview.index()]
        name = re.sub(r"[^\w.-]", "_", cellview.cell.name) + ".gds"
        try:
            self.place = tempfile.TemporaryDirectory(prefix="opcflow-klayout-")
            file = os.path.join(self.place.name, name)
            cells.write(cellview, file, objects)
            self.job = Job(file, self.process.currentText, simulate=self.action.currentIndex == 1)
        except (OSError, RuntimeError) as failure:
            self.label.setText(str(failure))
            return
        self.button.setText("Cancel")
        self.label.setText("")
        self.timer.start(PERIOD)

    def poll(self, *_):
        """Show the progress, and the results at the end."""
        try:
            ended = self.job.poll()
        except Failed as failure:
            self.stop(str(failure))
            return
        if self.job.fraction is None:
            self.bar.setMaximum(0)  # busy
        else:
            self.bar.setMaximum(STEPS)
            self.bar.setValue(int(STEPS * self.job.fraction))
        self.label.setText(self.job.status)
        if ended:
            self.timer.stop()
            # KLayout handles events while it loads files, so that the job must end last.
            try:
                self.stop(self.show_results(Results(self.job.folder), self.job.messages), STEPS)
            except (OSError, KeyError, RuntimeError) as fault:  # the flow has other files
                self.stop("%s: %s" % (self.job.folder, fault))

    def stop(self, text, value=0):
        """Follow the run no longer."""
        self.timer.stop()
        self.job = None
        self.button.setText("Start")
        self.bar.setMaximum(STEPS)
        self.bar.setValue(value)
        self.label.setText(text)

    def show_results(self, results, messages):
        """Show the files of a run, and return the text for the window."""
        self.report.setEnabled(os.path.isfile(results.path("report.html")))
        self.table.clear()
        for row in results.rows:
            self.table.addTopLevelItem(pya.QTreeWidgetItem([row[name] for name in COLUMNS]))
        index = results.show(self.view)
        self.view.show_rdb(self.view.num_rdbs() - 1, index)
        # KLayout 0.28 crashes if the database that its marker browser shows is removed.
        if self.results:
            self.results.hide(self.view)
        self.results, self.kept = results, self.place  # the files exist as long as the results
        return "\n".join([
            "%d transistors, |Ion deviation|: mean %.3g %%, largest %.3g %%" %
            (results.metric("transistors"), results.metric("ion_mean"),
             results.metric("ion_max")), *messages])

    def zoom(self, item, _column):
        """Show the transistor of a row."""
        at = self.results.place(self.results.rows[self.table.indexOfTopLevelItem(item)])
        self.view.zoom_box(pya.DBox(at, at).enlarged(AROUND, AROUND))

    def open_report(self, *_):
        pya.QDesktopServices.openUrl(pya.QUrl.fromLocalFile(self.results.path("report.html")))

    def end(self):
        """End a run that works when KLayout ends."""
        if self.job:
            self.job.close()
            self.job = None


def show_window():
    """Show the window. KLayout has one, which works on the current view."""
    if "window" not in KEPT:
        KEPT["window"] = Window(pya.MainWindow.instance())
    KEPT["window"].show()
    return KEPT["window"]


def add_to_menu():
    """Add the window to the menu Tools."""
    action = KEPT["action"] = pya.Action()
    action.title = "opcflow: correct a mask"
    action.on_triggered(lambda *_: show_window())
    pya.MainWindow.instance().menu().insert_item("tools_menu.end", "opcflow", action)
