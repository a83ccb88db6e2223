#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test the KLayout package. KLayout's Python module and the program klayout execute the modules
without a window; the program executes the window. Tests are skipped if these are not installed.
KLayout computes the expected transistors, shapes and places from the drawn layout."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

BUILD, SOURCE = os.environ["OPCFLOW_BUILD"], os.environ["OPCFLOW_SOURCE"]
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = os.path.join(HERE, "python"), os.path.join(SOURCE, "tests")
sys.dont_write_bytecode = True
import tap

os.environ["OPCFLOW_COMMAND"] = os.path.join(BUILD, "opcflow")
POLY, ACTIVE, LAYERS = (9, 0), (1, 0), {"CP": (9, 0), "CA": (1, 0), "CC": (10, 0), "CW": (3, 0)}
HALF = """opcflow: 1
name: half
extends: %s/flows/processes/own65.yaml
steps:
  layout: { scale: 2 }
"""
# Executed by klayout: a run, a run that is cancelled, and a run that replaces the first one. Other
# events are handled in the meantime.
SCRIPT = """
import faulthandler, os, pya, traceback
faulthandler.dump_traceback_later(120, exit=True)  # a window that hangs shows where
main, events, texts, inside = pya.MainWindow.instance(), [], [], []
main.load_layout("chip.gds", 1)
def follow(*_):
    if inside:  # an event while another one is handled
        return
    inside.append(1)
    try:
        from opcflow_klayout.window import KEPT
        if "window" not in KEPT:
            main.menu().action("tools_menu.opcflow").trigger()
            KEPT["window"].process.setEditText("own65")
        window = KEPT["window"]
        if window.job or window.busy:
            events.append((len(texts), window.job and window.job.fraction))
            return
        texts.append(window.label.text.splitlines()[0] if events else '')
        if len(texts) < 4:
            window.start()
        if len(texts) == 2:
            window.start_or_cancel()
        if len(texts) == 4:
            print("events", len({f for n, f in events if n == 1}) > 1, "texts", texts,
                  "rows", window.table.topLevelItemCount, "views", window.view.cellviews(),
                  "databases", window.view.num_rdbs(), "drawn", [
                      window.view.cellview(i).filename().endswith("chip.gds") for i in range(2)],
                  flush=True)
            os._exit(0)
    except Exception:
        traceback.print_exc()
        os._exit(1)
    finally:
        inside.clear()
timer = pya.QTimer(main)
timer.timeout(follow)
timer.start(5)
"""


def chip(pya, dbu=0.001, path=None):
    """Return a view of a cell with two placements of the NAND2, one of them turned; the file is
    written if path is given."""
    layout = pya.Layout()
    layout.read(os.path.join(SOURCE, "data", "cells65", "nand2.cif"))
    for index in layout.layer_indexes():
        name = layout.get_info(index).name
        if name in LAYERS:
            layout.set_info(index, pya.LayerInfo(*LAYERS[name]))
        else:
            layout.delete_layer(index)
    layout.dbu, inner = dbu, layout.top_cell()
    top = layout.create_cell("chip")
    top.insert(pya.CellInstArray(inner.cell_index(), pya.Trans(1000, 500)))
    top.insert(pya.CellInstArray(inner.cell_index(), pya.Trans(pya.Trans.R90, 9000, 3000)))
    path = path or os.path.join(tempfile.mkdtemp(dir="."), "chip.gds")
    layout.write(path)
    view = pya.LayoutView()
    view.load_layout(path)
    view.max_hier()
    return view


def region(pya, view, index, layer, number):
    """Return the shapes of a layer of a cell view in units of 0.1 nm."""
    layout = view.cellview(index).layout()
    found = pya.Region(view.cellview(index).cell.begin_shapes_rec(layout.layer(layer, number)))
    return found.transformed(pya.ICplxTrans(layout.dbu / 1e-4)).merged()


def run(pya, view, process="own65", objects=(), **settings):
    """Run a job to the end, and show the results. Returns (job, results, index of the cell
    view)."""
    from opcflow_klayout.cells import write
    from opcflow_klayout.job import Job
    from opcflow_klayout.results import Results
    file = os.path.join(tempfile.mkdtemp(dir="."), "cell.gds")
    write(view.active_cellview(), file, objects)
    job = Job(file, process, **settings)
    job.seen = []
    while not job.poll():
        job.seen.append(job.fraction or 0)
        time.sleep(0.01)
    results = Results(job.folder)
    return job, results, results.show(view)


def check(pya, view, results, index, drawn):
    """Compare the results with the drawn shapes {layer: region}, in units of 0.1 nm."""
    gates = (drawn[POLY] & drawn[ACTIVE]).merged()
    assert len(results.rows) == gates.count(), (len(results.rows), gates.count())
    middles = sorted(g.bbox().center() for g in gates.each())
    places = sorted(pya.DCplxTrans(1e4) * results.place(row) for row in results.rows)
    assert all(m.distance(p.to_itype(1)) <= 5 for m, p in zip(middles, places)), (middles, places)
    for name, layer in (("poly", POLY), ("active", ACTIVE)):
        number = layer[0]
        same = region(pya, view, index, 100 + number, 0) ^ drawn[layer]
        assert same.sized(-10).is_empty(), (name, str(same))
        mask, printed = (region(pya, view, index, n, 0) for n in (number, 300 + number))
        assert not (mask ^ drawn[layer]).is_empty(), name
        assert not printed.is_empty() and (printed - drawn[layer].sized(600)).is_empty(), name
        assert (gates.sized(-150) - printed).is_empty() or name == "active"
    boxes = [v.box() for database in (view.rdb(view.num_rdbs() - 1),)
             for item in database.each_item() for v in item.each_value()
             if v.is_box() and "worst" in database.category_by_id(item.category_id()).path()]
    assert boxes
    for box in boxes:
        marked = pya.Region((pya.DCplxTrans(1e4) * box).to_itype(1))
        inside = marked & gates
        assert inside.area() > 0.99 * marked.area(), str(box)


def drawn(pya, view):
    return {layer: region(pya, view, 0, *layer) for layer in (POLY, ACTIVE)}


def test_cell(pya):
    """Correct the current cell."""
    view = chip(pya)
    shapes = drawn(pya, view)
    job, results, index = run(pya, view)
    check(pya, view, results, index, shapes)
    assert results.metric("ion_max") <= 0.5
    assert job.code == any(not r["kept"] for r in job.document["require"]), job.messages
    assert job.seen == sorted(job.seen) and 0 < job.seen[-1] <= 1, job.seen
    assert view.active_cellview().index() == 0


def test_selection(pya):
    """Correct a selected instance, and a selected shape with the shapes of its layers."""
    view = chip(pya)
    view.max_hier_levels = 1  # instances, not the shapes in them
    view.select_from(pya.DBox(7, 2, 9.5, 5), pya.LayoutView.Replace)
    objects = list(view.each_object_selected())
    assert [o.is_cell_inst() for o in objects] == [True], objects
    clip = pya.Region(pya.Box(70000, 20000, 95000, 50000))
    shapes = {layer: found & clip for layer, found in drawn(pya, view).items()}
    _, results, index = run(pya, view, objects=objects)
    check(pya, view, results, index, shapes)
    assert len(results.rows) == 4


def test_shapes(pya):
    """Objects selected inside an instance have the coordinates of the view."""
    from opcflow_klayout.cells import write
    view = chip(pya)
    top = view.cellview(0).cell
    instance = [i for i in top.each_inst() if i.trans.angle == 1][0]
    layout, inner = view.cellview(0).layout(), instance.cell
    objects = []
    for layer in LAYERS.values():
        for shape in inner.each_shape(layout.layer(*layer)):
            path = pya.ObjectInstPath()
            path.cv_index, path.top, path.layer = 0, top.cell_index(), layout.layer(*layer)
            path.append_path(pya.InstElement.new(instance))
            path.shape = shape
            objects.append(path)
    # The same instance, selected inside a turned instance of the chip.
    outer = layout.create_cell("outer")
    whole = outer.insert(pya.CellInstArray(top.cell_index(), pya.Trans(pya.Trans.M45, 70, 30)))
    nested = pya.ObjectInstPath()
    nested.cv_index, nested.top = 0, outer.cell_index()
    for element in (whole, instance):
        nested.append_path(pya.InstElement.new(element))
    for selected, trans in ((objects, instance.trans), ([nested], whole.trans * instance.trans)):
        write(view.active_cellview(), "shapes.gds", selected)
        made = pya.Layout()
        made.read("shapes.gds")
        for layer in (POLY, ACTIVE):
            found = pya.Region(made.top_cell().begin_shapes_rec(made.layer(*layer)))
            expected = pya.Region(inner.begin_shapes_rec(layout.layer(*layer)))
            assert (found ^ expected.transformed(trans)).is_empty()


def test_scale(pya):
    """Results of an enlarged layout have the coordinates of the view."""
    with open("half.yaml", "w") as f:
        f.write(HALF % SOURCE)
    view = chip(pya, dbu=0.0005)
    shapes = drawn(pya, view)
    _, results, index = run(pya, view, process=os.path.abspath("half.yaml"))
    assert results.scale == 2
    check(pya, view, results, index, shapes)


def test_simulate(pya):
    """A simulation leaves the mask as drawn, and measures the deviations as drawn."""
    view = chip(pya)
    shapes = drawn(pya, view)
    job, results, index = run(pya, view, simulate=True)
    for layer in (POLY, ACTIVE):
        assert (region(pya, view, index, *layer) ^ shapes[layer]).is_empty()
    assert all(row["ion_before (%)"] == row["ion_after (%)"] for row in results.rows)
    assert results.metric("ion_max") > 1 and job.code == 1


def fails(pya, view, process, **settings):
    from opcflow_klayout.job import Failed
    try:
        run(pya, view, process, **settings)
    except Failed as failure:
        return str(failure)
    raise AssertionError("no failure")


def test_failures(pya):
    """The messages of the program are reported; a cancelled run leaves no process."""
    from opcflow_klayout import job as module
    view = chip(pya)
    assert "no process 'nonesuch'" in fails(pya, view, "nonesuch")
    assert "sky130" in module.processes()
    text = fails(pya, view, "sky130")
    assert "66/20" in text, text
    job = module.Job(view.cellview(0).filename(), "own65", settings=["mask.synthesizer.gain.l=0.001"])
    while not (job.fraction or 0) > 1 / 7:
        assert not job.poll()
    job.cancel()
    try:
        while not job.poll():
            time.sleep(0.01)
        raise AssertionError("the run was not cancelled")
    except module.Failed as failure:
        assert "cancelled" in str(failure) and job.code in (130, -15), (failure, job.code)
    assert job.process.returncode is not None and not os.path.exists(job.folder)


def test_endings(pya):
    """A program that crashes, ends without results, or cannot start, is reported."""
    from opcflow_klayout import job as module
    view, real = chip(pya), os.environ["OPCFLOW_COMMAND"]
    fake = os.path.abspath("fake")
    for last, expected in (("kill -SEGV $$", "crashed or was ended by another program (SIGSEGV)"),
                           ("echo '{\"problems\": ['; kill -ABRT $$", "(SIGABRT)"),
                           ("echo short of paper >&2; exit 7", "short of paper"),
                           ("exit 7", "exit code 7"), (None, "fake' is not a program")):
        with open(fake, "w") as f:
            f.write("#!/bin/sh\n[ $1 = new ] && exec '%s' \"$@\"\n%s\n" % (real, last))
        os.chmod(fake, 0o755 if last else 0o644)
        os.environ["OPCFLOW_COMMAND"] = fake
        try:
            text = fails(pya, view, "own65")
        finally:
            os.environ["OPCFLOW_COMMAND"] = real
        assert expected in text, (last, text)


def execute(script, *options):
    """Execute a script by the real program, without a screen, and return the output."""
    with open("script.py", "w") as f:
        f.write(script)
    done = subprocess.run(["timeout", "-k", "5", "240", "klayout", *options, "script.py"],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True,
                          env={**os.environ, "HOME": os.path.abspath("home"),
                               "CHIP": os.path.abspath("chip.gds"),
                               # freed memory has other values, so that its use is detected
                               "MALLOC_PERTURB_": "208", "QT_QPA_PLATFORM": "offscreen", "PYTHONDONTWRITEBYTECODE": "1"})
    return done.stdout


def test_program(_):
    """The tests above, by the Python of the real program, which can be another version."""
    path = os.path.join(HERE, "klayout_test.py")
    text = execute("exec(compile(open(%r).read(), %r, 'exec'), {'__name__': 'inner', "
                   "'__file__': %r})\n" % ((path,) * 3), "-b", "-r")
    assert text.count("\nok ") == len(TESTS) and "not ok" not in text, text


def test_window(_):
    """The window of the real program; test_program has written the layout."""
    os.makedirs("home/.klayout/salt")
    os.symlink(HERE, "home/.klayout/salt/opcflow")
    text = execute(SCRIPT, "-e", "-rm")
    found = re.search("events True texts \\['', '(.*?)', '(.*?)', '(.*?)'\\] (.*)", text)
    assert found, text
    assert found[1].startswith("8 transistors") and found[3] == found[1], found[0]
    assert found[2] == "The run was cancelled.", found[0]
    assert found[4] == "rows 8 views 2 databases 1 drawn [True, False]", found[0]


TESTS = [test_cell, test_selection, test_shapes, test_scale, test_simulate, test_failures,
         test_endings]


def main():
    inner = __name__ == "inner"
    tests = TESTS + ([] if inner else [test_program, test_window])
    reasons = dict.fromkeys(tests)
    try:
        import pya
        pya.LayoutView
    except (ImportError, AttributeError):
        pya = None
        reasons.update(dict.fromkeys(TESTS, "python3 has no module of KLayout 0.28 or later"))
    if not shutil.which("klayout"):
        reasons.update(dict.fromkeys(tests[len(TESTS):], "klayout is not installed"))
    with tempfile.TemporaryDirectory(prefix="opcflow-klayout-") as folder:
        os.chdir(folder)
        failed = tap.run([(test.__name__, lambda test=test: reasons[test] or test(pya))
                          for test in tests])
        if inner:
            chip(pya, path=os.environ["CHIP"])
        os.chdir("/")
    return failed


sys.exit(main())
