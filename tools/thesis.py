# SPDX-License-Identifier: BSD-3-Clause
"""Questions of docs/background/thesis-results.md, and the pictures of docs/background/gallery.md."""
import csv
import json
import math
import os
import shutil

import plots

DOCUMENT = "docs/background/thesis-results.md"
GALLERY = "docs/background/gallery.md"
PICTURES = "docs/images/thesis"
SMALL = ("c17", "c432", "c499", "c1355", "c1908")
LARGE = ("c2670", "c3540", "c5315", "c6288", "c7552")
CIRCUITS = SMALL + LARGE
# timing.paths refuses c2670, which contains a cell with a constant output.
DELAYS = SMALL + ("c3540",)
SEARCHES = SMALL
METHODS = ("epe", "dpb", "ic")
LABEL = {"epe": "EPE-OPC", "pb": "PB-OPC", "dpb": "DPB-OPC", "ic": "IC-OPC"}


# ---- reading ----

def rows_of(folder, name):
    """Return the rows of a table of a run; headings without units."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):  # the first step with a table of a name has no prefix
        path = os.path.join(folder, name.split(".", 1)[1])
    with open(path, newline="") as f:
        lines = list(csv.reader(f))
    heads = [h.split(" (")[0] for h in lines[0]]
    return [dict(zip(heads, line)) for line in lines[1:]]


def metric(folder, step, name):
    with open(os.path.join(folder, "metrics.json")) as f:
        one = json.load(f).get(step, {}).get(name)
    return one["value"] if one else None


def seconds(folder, step):
    """Return the processor seconds of a step."""
    with open(os.path.join(folder, "manifest.json")) as f:
        return json.load(f)["processor"].get(step)


def column(rows, name, keep=lambda row: True):
    return [float(row[name]) for row in rows if row.get(name) not in (None, "") and keep(row)]


def mean(values):
    return sum(values) / len(values) if values else None


def sigma(values):
    """Return the standard deviation, thesis eq. 3.5."""
    return math.sqrt(max(0, mean([v * v for v in values]) - mean(values) ** 2)) if values else None


def absolute(values):
    return [abs(v) for v in values]


# ---- tables ----

def gamma_table(runs, number):
    rows = []
    for layout in ("sram4", "c432"):
        for step, name in (("plain", "plain"), ("gamma", "gamma"), ("widths", "several widths")):
            table = {(r["set"], r["type"]): r for r in rows_of(runs[layout], step + ".check.csv")}
            row = [layout, name]
            for kind, what in (("rectangles", "ion_max"), ("rectangles", "ioff_max"), ("printed", "ion_change_mean"),
                               ("printed", "ion_change_max"), ("printed", "ioff_change_mean")):
                row += [number(float(table[kind, t][what]), "2") for t in "np"]
            rows.append(row)
    return ["printed gates of", "slices"] + [
        "%s, %s" % (h, t) for h in ("Ion of rectangles, max", "Ioff, max", "Ion deviation, mean error", "max error",
                                    "Ioff deviation, mean error") for t in "np"], rows


def modes_table(runs, number):
    rows = []
    for mode, folder in runs.items():
        rows.append([mode] + [number(metric(folder, "mask", m), f) for m, f in (
            ("ion_mean", "2"), ("ion_max", "2"), ("ioff_mean", "2"), ("area_mean", "2"), ("iterations", "n"),
            ("simulations", "n"))])
    return ["mode", "Ion mean, %", "Ion max, %", "Ioff mean, %", "area mean, %", "iterations", "simulations"], rows


def search_table(runs, number):
    rows = []
    for name, folder in runs.items():
        best = {r["of the best setting"]: r["value"] for r in rows_of(folder, "best.csv")}
        rows.append([name, number(metric(folder, "best", "settings"), "n"), best["mask.synthesizer.fragment"],
                     best.get("mask.synthesizer.step", "1 nm"), best["mask.max_iterations"]] + [
            number(metric(folder, step, m), f) for step, m, f in (
                ("judged", "ion_mean", "2"), ("judged", "ion_max", "2"), ("judged", "ioff_mean", "2"),
                ("judged", "area_mean", "2"), ("cost", "shots", "n"))] + [number(seconds(folder, "best"), "2")])
    return ["search", "settings", "fragment", "step", "iterations", "Ion mean, %", "Ion max, %", "Ioff mean, %",
            "area mean, %", "shots", "search, processor, s"], rows


def epe_search_table(runs, number):
    """Tables 3.4 and 5.3: the search for the best EPE-OPC against one correction by DPB- and IC-OPC."""
    rows = []
    for circuit in SEARCHES:
        folder, other = runs[circuit], runs[circuit + "-dpb"]
        best = {r["of the best setting"]: r["value"] for r in rows_of(folder, "best.csv")}
        times = seconds(folder, "best"), seconds(other, "mask"), seconds(runs[circuit + "-ic"], "mask")
        rows.append([circuit, best["mask.synthesizer.fragment"], best["mask.max_iterations"]] + [
            number(metric(*one), "2") for one in (
                (folder, "judged", "ion_mean"), (other, "mask", "ion_mean"), (folder, "judged", "ion_max"),
                (other, "mask", "ion_max"))] + [
            number(metric(one, "cost", "mebes_bytes"), "n") for one in (folder, other)] + [
            number(v, "2") for v in (*times, times[1] / times[0], times[2] / times[0])])
    return ["circuit", "fragment", "iterations", "Ion mean, %: best EPE-OPC", "DPB-OPC", "Ion max, %: best EPE-OPC",
            "DPB-OPC", "bytes: best EPE-OPC", "DPB-OPC", "processor: search, s", "DPB-OPC, s", "IC-OPC, s",
            "DPB / search, s/s", "IC / search, s/s"], rows


def circuit_rows(folder):
    """Return the transistors of a run, with |L|, W and deviations."""
    return [r for r in rows_of(folder, "gates.csv") if r["ion_after"]]


def circuits_table(runs, number):
    rows = []
    for circuit in CIRCUITS:
        for m in METHODS:
            folder = runs["%s-%s" % (circuit, m)]
            ion = column(circuit_rows(folder), "ion_after")
            area = column(circuit_rows(folder), "area_after")
            cost = {r["layer"]: r for r in rows_of(folder, "cost_bytes.csv")}
            rows.append([circuit, LABEL[m]] + [number(v, "2") for v in (
                mean(absolute(ion)), max(absolute(ion)))] + ["%.3f" % min(absolute(ion))] + [
                number(v, "2") for v in (sigma(ion), mean(absolute(area)), sigma(area))] + [
                number(float(cost[layer]["mebes"]), "n") for layer in ("active", "poly")] + [
                number(metric(folder, "mask", "iterations"), "n"), number(seconds(folder, "mask"), "2")])
    return ["circuit", "method", "Ion mean, %", "max", "min", "stdv", "area mean, %", "stdv", "active, bytes",
            "poly, bytes", "iterations", "processor, s"], rows


def benchmark_table(runs, number):
    rows = []
    for circuit in CIRCUITS:
        folder = runs[circuit + "-dpb"]
        cost = {r["layer"]: r for r in rows_of(folder, "cost_bytes.csv")}
        rows.append([circuit, number(metric(folder, "mask", "transistors"), "n")] + [
            number(float(cost[layer]["mebes_drawn"]), "n") for layer in ("active", "poly")])
    return ["circuit", "transistors", "active, bytes", "poly, bytes"], rows


def normalized_table(runs, number):
    """Tables 5.2 and 5.3: bytes and processor time divided by those of EPE-OPC."""
    rows = []
    for circuit in CIRCUITS:
        def of(m, layer):
            cost = {r["layer"]: r for r in rows_of(runs["%s-%s" % (circuit, m)], "cost_bytes.csv")}
            return float(cost[layer]["mebes"])
        rows.append([circuit] + [number(of(m, layer) / of("epe", layer), "2")
                                 for layer in ("active", "poly") for m in ("dpb", "ic")] + [
            number(seconds(runs["%s-%s" % (circuit, m)], "mask") / seconds(runs[circuit + "-epe"], "mask"), "2")
            for m in ("dpb", "ic")])
    return ["circuit", "active: DPB / EPE", "IC / EPE", "poly: DPB / EPE", "IC / EPE", "processor: DPB / EPE, s/s",
            "IC / EPE, s/s"], rows


def disturbance_table(runs, number):
    rows = []
    for circuit in CIRCUITS:
        change = column(rows_of(runs[circuit], "disturbance.csv"), "disturbance")
        worse = [c for c in change if c > 0]
        rows.append([circuit, number(len(change), "n"), number(mean(change), "2"),
                     number(100 * len([c for c in change if c > 0.05]) / len(change), "2"),
                     number(max(worse) if worse else 0, "2")])
    return ["circuit", "transistors", "mean change of abs(Ion deviation), points", "transistors worse by 0.05, %",
            "largest increase, points"], rows


def experiment_rows(folder):
    """Return the runs of an experiment by case and method."""
    return {(r["case"], r["method"]): r for r in rows_of(folder, "experiment.csv") if r["folder"]}


def cell_rows(runs):
    """Return the rows of all cells by case and method, with the processor seconds of the correction."""
    found = {}
    for folder in runs.values():
        for (case, m), row in experiment_rows(folder).items():
            found[case, m] = {**row, "processor": seconds(os.path.join(folder, "compare", case, m), "mask")}
    return found


def pairs_of(runs, name):
    """Return the values of two methods for all cells that have both."""
    found = cell_rows(runs)
    both = [[found.get((c, m), {}).get(name) for m in ("epe", "dpb")] for c in sorted({case for case, _ in found})]
    return [(float(a), float(b)) for a, b in both if a and b]


CELL_FIGURES = (("Ion mean, points", "verify.ion_mean"), ("Ion stdv, points", "verify.ion_stdv"),
                ("Ion max, points", "verify.ion_max"), ("worst delay, points", "circuit.tp_worst"),
                ("worst rise time, points", "circuit.tr_worst"), ("worst fall time, points", "circuit.tf_worst"))


def cells_table(runs, number):
    """Figures 3.10 to 3.12: DPB-OPC against EPE-OPC over all cells."""
    rows = []
    for name, key in CELL_FIGURES:
        pairs = pairs_of(runs, key)
        less = [b < a for a, b in pairs]
        rows.append([name, number(len(pairs), "n"), number(mean([a for a, _ in pairs]), "2"),
                     number(mean([b for _, b in pairs]), "2"), number(mean([b - a for a, b in pairs]), "2"),
                     number(100 * mean(less), "2")])
    pairs = pairs_of(runs, "cost.mebes_bytes")
    rows.append(["bytes", number(len(pairs), "n")] + [number(mean([p[k] for p in pairs]), "n") for k in (0, 1)] + [
        number(100 * mean([b / a - 1 for a, b in pairs]), "2") + " %", number(100 * mean([b < a for a, b in pairs]), "2")])
    for name, key, form in (("iterations", "mask.iterations", "2"), ("processor time, s", "processor", "2")):
        pairs = pairs_of(runs, key)
        rows.append([name, number(len(pairs), "n")] + [number(mean([p[k] for p in pairs]), form) for k in (0, 1)] + [
            number(mean([b - a for a, b in pairs]), form), number(100 * mean([b < a for a, b in pairs]), "2")])
    return ["figure", "cells", "EPE-OPC, mean", "DPB-OPC, mean", "difference, mean", "cells with less, %"], rows


def library_table(runs, number):
    """Tables 4.1 to 4.3: masks from cells over the correction of the whole circuit."""
    rows = []
    for circuit, folder in runs.items():
        base = None
        for m, name in (("dpb_flat", "whole circuit"), ("dpb_placed", "cells, no limit"), ("dpb_2", "cells, 2 %"),
                        ("dpb_0", "cells, 0.01 %")):
            one = os.path.join(folder, "compare", circuit, m)
            figures = [metric(one, "verify", k) for k in ("ion_mean", "ion_max", "ion_stdv")]
            time = seconds(one, "mask")
            base = base or (figures, time)
            rows.append([circuit, name] + [number(v, "2") for v in figures] + [
                number(100 * (v / b - 1), "n") for v, b in zip(figures, base[0])] + [
                number(time, "2"), number(base[1] / time, "2")])
    return ["circuit", "mask from, MAXDIFF", "Ion mean, %", "max, %", "sigma, %", "mean over whole - 1, %",
            "max over whole - 1, %", "sigma over whole - 1, %", "correction, s", "whole over this, s/s"], rows


def performance(folder):
    """Return the worst deviations of a circuit as printed, by quantity."""
    path = os.path.join(folder, "performance.csv")
    if os.path.exists(path):
        return {r["quantity"]: float(r["worst after"]) for r in rows_of(folder, "performance.csv") if r["worst after"]}
    return {}


def chapter2_table(runs, number):
    rows = []
    found = experiment_rows(runs[""])
    for case in ("nmos", "pmos", "inverter", "nand2", "nor2", "chain", "sram"):
        for m in ("epe", "pb"):
            run = found.get((case, m))
            if not run:
                continue
            folder = os.path.join(runs[""], "compare", case, m)
            gates = rows_of(folder, "gates.csv")
            worst = performance(folder)
            cost = {r["layer"]: float(r["mebes"]) for r in rows_of(folder, "cost_bytes.csv")}
            rows.append([case, LABEL[m]] + [number(max(column(gates, name), key=abs), "2")
                                            for name in ("ion_after", "ioff_after")] + [
                number(worst.get(q), "2") for q in ("rise time", "fall time", "delay, rising", "delay, falling")] + [
                number(next(iter(column([run], "circuit." + side)), None), "2") for side in ("snm_left_worst", "snm_right_worst")] + [
                number(cost[layer], "n") for layer in ("poly", "active")] + [number(seconds(folder, "mask"), "2")])
    return ["layout", "method", "Ion, %", "Ioff, %", "tr, %", "tf, %", "tpLH, %", "tpHL, %", "SNM left, %",
            "SNM right, %", "poly, bytes", "active, bytes", "processor, s"], rows


CIRCUIT_METHODS = (("epe-once", "EPE"), ("pb-both", "PB"), ("dpb", "DPB"), ("ic", "IC"), ("plain", "newton"),
                   ("area", "area"))


def performance_table(runs, number):
    """Largest deviations of circuits, %, by quantity and method."""
    rows = []
    for case in ("inverter", "nand2", "nor2", "chain", "sram"):
        folders = {m: os.path.join(runs[""], "compare", case, m) for m, _ in CIRCUIT_METHODS}
        if case == "sram":
            for side in ("left", "right"):
                key = "snm_%s_worst" % side
                rows.append([case, "margin, " + side, number(metric(folders["dpb"], "circuit", key + "_before"), "2")] + [
                    number(metric(f, "circuit", key), "2") for f in folders.values()])
            continue
        before = {r["quantity"]: float(r["worst before"]) for r in rows_of(folders["dpb"], "performance.csv")}
        for quantity, name in (("rise time", "tr"), ("fall time", "tf"), ("delay, rising", "tpLH"),
                               ("delay, falling", "tpHL")):
            rows.append([case, name, number(before[quantity], "2")] + [
                number(performance(f).get(quantity), "2") for f in folders.values()])
    return ["circuit", "figure", "uncorrected"] + [name for _, name in CIRCUIT_METHODS], rows


def butterfly_table(runs, number):
    rows = []
    for name, folder in runs.items():
        rows.append([name] + [number(metric(folder, "circuit", "snm_" + k), "2") for k in (
            "left_worst_before", "left_worst", "right_worst_before", "right_worst")])
    return ["method", "left margin, uncorrected, %", "corrected, %", "right margin, uncorrected, %", "corrected, %"], rows


def delays_table(runs, number):
    """Tables 3.5 and 5.1, and equations 5.5 and 5.6 with the means of all transistors of a type."""
    rows = []
    for circuit, folder in runs.items():
        found = {r["sizes"]: r for r in rows_of(folder, "paths.csv")}
        for m in METHODS:
            run, base = found[m], found["epe"]
            cells = [r for r in rows_of(os.path.join(folder, "compare", circuit, m), "gates.csv") if r["ion_after"]]
            first = [mean(column(cells, "area_after")) - mean(column(cells, "ion_after", lambda r: r["type"] == t))
                     for t in "np"]
            rows.append([circuit, LABEL[m]] + [number(float(run[k]), "2") for k in ("mean", "stdv")] + [
                number(float(run[k]) / float(base[k]), "2") for k in ("mean", "stdv")] + [
                number(float(run[k]), "2") for k in ("longest", "shortest")] + [number(v, "2") for v in first])
    return ["circuit", "method", "mean, %", "stdv, %", "mean / EPE", "stdv / EPE", "longest path, %",
            "shortest path, %", "eq. 5.5 (falling), %", "eq. 5.6 (rising), %"], rows


BIASES = [("l", b) for b in range(-4, 15, 2)] + [("w", b) for b in range(-100, 101, 20)]


def bias_name(axis, by):
    """Return the name of a mask: its length or width, nm."""
    return "%s%d" % (axis, (65 if axis == "l" else 1000) + by)


def bias_masks():
    """Return masks of the NMOS of data/cells65 with other lengths or widths, as CIF by file name. The
    line ends of the poly follow the width."""
    masks = {}
    for axis, by in BIASES:
        left, right = (-(by // 2), 65 + by - by // 2) if axis == "l" else (0, 65)
        low, high = (-(by // 2), 1000 + by - by // 2) if axis == "w" else (0, 1000)
        masks["bias-%s.cif" % bias_name(axis, by)] = (
            "DS 1 1 10;\n9 nmos;\nL CSN;\nP -298 -200 363 -200 363 1200 -298 1200;\n"
            "L CA;\nP -98 %d 163 %d 163 %d -98 %d;\nL CP;\nP %d %d %d %d %d %d %d %d;\nDF;\nC 1;\nE\n" % (
                low, low, high, high, left, low - 84, right, low - 84, right, high + 84, left, high + 84))
    return masks


def bias_points(runs, axis):
    points = []
    for (one, by), folder in zip(BIASES, runs.values()):
        if one == axis:
            gate = rows_of(folder, "gates.csv")[0]
            points.append((by, float(gate["ion_after"]), float(gate["area_after"])))
    zero = next(p for p in points if p[0] == 0)
    return [(by, *(100 * ((100 + v) / (100 + z) - 1) for v, z in zip(values, zero[1:]))) for by, *values in points]


def bias_table(runs, number):
    rows = [[axis.upper(), "%+d" % by, number(ion, "2"), number(area, "2")]
            for axis in "lw" for by, ion, area in bias_points(runs, axis)[::2]]
    return ["mask", "change, nm", "Ion, %", "gate area, %"], rows


def onestep_table(runs, number):
    rows = []
    for name, folder in runs.items():
        rows.append([name] + [number(metric(folder, "mask", m), f) for m, f in (
            ("ion_mean_drawn", "2"), ("ion_mean", "2"), ("ion_max", "2"), ("ioff_mean", "2"), ("simulations", "n"),
            ("fine_simulations", "n"))] + [number(seconds(folder, "mask"), "2")])
    return ["correction", "Ion mean as drawn, %", "Ion mean, %", "Ion max, %", "Ioff mean, %", "simulations",
            "accurate simulations", "processor, s"], rows


# ---- pictures ----

def bias_picture(axis):
    def draw(runs):
        points = bias_points(runs, axis)
        low = min(min(p[1:]) for p in points)
        high = max(max(p[1:]) for p in points)
        plot = plots.Plot("change of %s of the mask, nm" % axis.upper(), "change, %",
                          (points[0][0], points[-1][0]), (low * 1.1, high * 1.2))
        for k, name in ((1, "Ion"), (2, "gate area")):
            plot.line(name, [(p[0], p[k]) for p in points])
            plot.points(name, [(p[0], p[k]) for p in points])
        return plot.svg()
    return draw


def transients_picture(runs):
    """Figure 3.9: worst deviations of times over the mean |Ion deviation|, both methods."""
    found = [r for r in experiment_rows(runs["combinational"]).values() if r.get("circuit.tp_worst")]
    ion = [float(r["verify.ion_mean"]) for r in found]
    worst = [float(r["circuit." + k]) for r in found for k in ("tp_worst", "tr_worst", "tf_worst")]
    plot = plots.Plot("mean |Ion deviation| of a cell, %", "worst deviation, %", (0, max(ion) * 1.05),
                      (0, max(worst) * 1.1))
    for key, name in (("tp_worst", "delay"), ("tr_worst", "rise time"), ("tf_worst", "fall time")):
        plot.points(name, [(float(r["verify.ion_mean"]), float(r["circuit." + key])) for r in found])
    return plot.svg()


def cells_picture(runs):
    """Figure 3.10: differences of each cell."""
    series = [(name.split(",")[0], [b - a for a, b in pairs_of(runs, key)]) for name, key in CELL_FIGURES[:3]]
    values = [v for _, one in series for v in one]
    plot = plots.Plot("cell", "DPB-OPC - EPE-OPC, points", (0, len(series[0][1]) + 1),
                      (min(values) - 0.2, max(values) + 0.3 * (max(values) - min(values))))
    for name, one in series:
        plot.points(name, [(k + 1, v) for k, v in enumerate(one)])
    return plot.svg()


def cell_ratios_picture(runs):
    """Figures 3.11 and 3.12: bytes and processor time of DPB-OPC over those of EPE-OPC."""
    series = [(name, [b / a for a, b in pairs_of(runs, key)]) for name, key in (
        ("bytes", "cost.mebes_bytes"), ("processor time", "processor"))]
    values = [v for _, one in series for v in one]
    plot = plots.Plot("cell", "DPB-OPC / EPE-OPC", (0, len(series[0][1]) + 1), (0, max(values) * 1.2))
    for name, one in series:
        plot.points(name, [(k + 1, v) for k, v in enumerate(one)])
    return plot.svg()


def gamma_picture(runs):
    plot = plots.Plot("L, nm", "Ion / W, mA/um", (55, 80), (0.75, 1.7))
    for width, label in (("90.0", "W = 90 nm"), ("700.0", "W = 700 nm")):
        for step, name in (("plain", "plain slices"), ("gamma", "weighted slices")):
            rows = [r for r in rows_of(runs["sram4"], step + ".rectangles.csv") if r["type"] == "n" and r["width"] == width]
            known = [(float(r["length"]), 1e6 * float(r["ion"]) / float(width)) for r in rows]
            plot.line(name, [(x, y * (1 + float(r["ion_error"]) / 100)) for (x, y), r in zip(known, rows)],
                      "5 4" if step == "plain" else "")
        plot.points("ngspice, " + label, known[::2])
    return plot.svg()


def area_histogram(runs):
    return plots.histogram([(LABEL[m], column(circuit_rows(runs["c432-" + m]), "area_after")) for m in METHODS],
                           "gate area deviation, % (c432)", 56, -13, 15)


def area_trend(runs):
    """Figures 3.16 and 5.7: mean |area deviation| of the transistors of each drawn width."""
    plot = plots.Plot("drawn W, nm (c1908)", "mean |gate area deviation|, %", (0, 1000), (0, 8))
    for m in METHODS:
        groups = {}
        for r in circuit_rows(runs["c1908-" + m]):
            groups.setdefault(50 * round(float(r["w"]) / 50), []).append(abs(float(r["area_after"])))
        plot.line(LABEL[m], [(w, mean(v)) for w, v in sorted(groups.items()) if len(v) >= 5])
        plot.points(LABEL[m], [(w, mean(v)) for w, v in sorted(groups.items()) if len(v) >= 5])
    return plot.svg()


def iso_line(runs):
    """Figure 5.5: mean and standard deviation of both deviations, and the line of equal ones."""
    plot = plots.Plot("|Ion deviation|, %", "|gate area deviation|, %", (0, 6), (0, 6))
    plot.line("equal deviations", [(0, 0), (6, 6)], "5 4")
    for m in METHODS:
        pairs = []
        for circuit in CIRCUITS:
            rows = circuit_rows(runs["%s-%s" % (circuit, m)])
            ion, area = column(rows, "ion_after"), column(rows, "area_after")
            pairs += [(mean(absolute(ion)), mean(absolute(area))), (sigma(ion), sigma(area))]
        plot.points(LABEL[m], pairs, 5)
    return plot.svg()


def disturbance_histogram(runs):
    return plots.histogram([(c, column(rows_of(runs[c], "disturbance.csv"), "disturbance")) for c in ("c432", "c1908")],
                           "change of |Ion deviation| by placement, points", 40, -2, 8)


def disturbance_map(runs):
    """Figure 4.4: transistors of c432 by the change of their deviation."""
    places = [[float(r[k]) for k in ("x", "y", "disturbance")] for r in rows_of(runs["c432"], "disturbance.csv")]
    plot = plots.Plot("x, nm", "y, nm", (0, max(p[0] for p in places)), (0, 1.3 * max(p[1] for p in places)))
    for name, low, high in (("worse by over 2 %", 2, 1e9), ("worse by 0.05 to 2 %", 0.05, 2), ("others", -1e9, 0.05)):
        plot.points(name, [p[:2] for p in places if low <= p[2] < high])
    return plot.svg()


def copied(label, name):
    """Return a picture that is a file of a run."""
    return lambda runs: os.path.join(runs[label], name)


def write_pictures(question, runs, root):
    """Write the pictures of a question."""
    folder = os.path.join(root, PICTURES)
    os.makedirs(folder, exist_ok=True)
    for name, make in question.get("pictures", []):
        made = make(runs)
        if made.startswith("<svg"):
            with open(os.path.join(folder, name), "w") as f:
                f.write(made)
        else:
            shutil.copyfile(made, os.path.join(folder, name))


# ---- questions ----

def questions(flow, circuit_cases, path_options):
    """Return the questions. `flow` makes the words of a command; the others are settings of a circuit."""
    between = "$RUNS/gamma-between/devices.yaml"

    def circuit(name, path, *sets):
        return flow(path, "layout.file=$DATA/iscas85/%s/%s.gds" % (name, name), "layout.scale=1.3", *sets)

    def gamma_run(*sets):
        return flow("flows/gamma.yaml", *["%s.devices=%s" % (step, between) for step in ("plain", "gamma", "widths")],
                    *sets)

    window = ("picture.window=[0 nm, 0 nm, 2600 nm, 2000 nm]", "picture.width=640")
    circuits = [("%s-%s" % (c, m), circuit(c, "flows/%s.yaml" % m, *(window if c == "c432" else ())))
                for c in CIRCUITS for m in METHODS]
    dpb_cells = ("layout.layers.outline=235/0", "mask.neighbours=outline",
                 "mask.synthesizer={ use: synthesizer.dpb, ion_limit: 0.5 % }",
                 "mask.regulator={ use: regulator.drc, min_extension: 30 nm, want_extension: 60 nm, max_head: 10 nm }")
    made = [
        dict(name="gamma", title="Plain, weighted slices and several widths", make=gamma_table,
             runs=[("between", flow("flows/devices.yaml", "devices.card=$DATA/models/ptm/ptm_65nm_bulk.pm",
                                    variant="ptm65-between")),
                   ("sram4", gamma_run()),
                   ("c432", gamma_run("layout.file=$DATA/iscas85/c432/c432.gds", "layout.scale=1.3"))],
             pictures=[("gamma.svg", gamma_picture)]),
        dict(name="modes", title="Modes of PB-OPC", quick=True, make=modes_table,
             runs=[("Mode_Ion", flow("flows/pb.yaml")), ("Mode_Ioff", flow("flows/pb.yaml", variant="ioff")),
                   ("Mode_IoffIon", flow("flows/pb.yaml", variant="ioffion"))]),
        dict(name="search", title="The best EPE-OPC", make=search_table,
             runs=[("chapter 2", flow("flows/search.yaml", variant="chapter2")),
                   ("chapter 3", flow("flows/search.yaml", variant="chapter3")),
                   ("mask rules kept", flow("flows/search.yaml")),
                   ("Ion and Ioff", flow("flows/search.yaml", variant="leakage"))],
             pictures=[("search-chapter2.png", copied("chapter 2", "surface.png")),
                       ("search-chapter3.png", copied("chapter 3", "surface.png"))]),
        dict(name="circuits", title="EPE-, DPB- and IC-OPC on circuits", make=circuits_table, runs=circuits, show=6,
             pictures=[("area-histogram.svg", area_histogram), ("area-trend.svg", area_trend),
                       ("iso-line.svg", iso_line), ("c432-dpb.png", copied("c432-dpb", "mask.png")),
                       ("c432-epe.png", copied("c432-epe", "mask.png"))]),
        dict(name="benchmarks", title="Circuits as drawn", uses="circuits", make=benchmark_table, runs=circuits, show=0),
        dict(name="normalized", title="Bytes and times over EPE-OPC", uses="circuits", make=normalized_table,
             runs=circuits, show=0),
        dict(name="epe-search", title="The best EPE-OPC of circuits", make=epe_search_table, show=3, runs=[
            run for c in SEARCHES for run in (
                (c, flow("flows/search.yaml", "best.set.layout.file=$DATA/iscas85/%s/%s.gds" % (c, c),
                         "best.set.layout.scale=1.3")),
                *((c + "-" + m, circuit(c, "flows/%s.yaml" % m)) for m in ("dpb", "ic")))]),
        dict(name="disturbance", title="Disturbance of placed cells", make=disturbance_table, show=1,
             runs=[(c, flow("flows/library.yaml", "layout.file=$DATA/iscas85/%s/%s.gds" % (c, c), "layout.scale=1.3",
                            *dpb_cells, variant="placed")) for c in CIRCUITS],
             pictures=[("disturbance.svg", disturbance_histogram), ("disturbance-c432.svg", disturbance_map)]),
    ]
    nangate = "$DATA/nangate45/NangateOpenCellLibrary"
    cells = ('compare.cases=[{ layout.file: %s.gds, layout.scale: 1.3, netlist.file: %s.cdl, netlist.scale: 1.3,'
             ' layout.top: ["*_X*", "!*DFF*", "!DL*", "!CLKGATE*", "!TLAT*", "!LOGIC*", "!FILL*", "!ANTENNA*", "!TAP*"] }]' % (
                 nangate, nangate))
    states = ('compare.cases=[{ layout.file: %s.gds, layout.scale: 1.3, layout.top: ["*DFF*", "DL*", "CLKGATE*", "TLAT*"] }]'
              % nangate)
    delays = [(c, flow("flows/timing-compare.yaml", "compare.methods=[epe, dpb, ic]", circuit_cases(c),
                       *path_options(c))) for c in DELAYS]
    made += [
        dict(name="delays", title="Path delays over those of EPE-OPC", make=delays_table, runs=delays, show=1,
             pictures=[("delays-%s.png" % c, copied(c, "histogram.png")) for c in ("c17", "c1908")]),
        dict(name="chapter2", title="PB-OPC against the best EPE-OPC", make=chapter2_table,
             runs=[("", flow("flows/chapter2.yaml"))],
             pictures=[("nmos-epe.png", copied("", "compare/nmos/epe/mask.png")),
                       ("nmos-pb.png", copied("", "compare/nmos/pb/mask.png"))]),
        dict(name="butterfly", title="Noise margins of the SRAM", quick=True, make=butterfly_table,
             runs=[("EPE-OPC", flow("flows/circuit.yaml", "mask.synthesizer={ use: synthesizer.epe }", "require=~",
                                    variant="sram_length")),
                   ("PB-OPC", flow("flows/circuit.yaml", "mask.synthesizer={ use: synthesizer.pb }", "require=~",
                                   variant="sram_length"))],
             pictures=[("butterfly-epe.png", copied("EPE-OPC", "circuit.png")),
                       ("butterfly-pb.png", copied("PB-OPC", "circuit.png"))]),
        dict(name="performance", title="Circuits by all methods", make=performance_table,
             runs=[("", flow("flows/chapter2.yaml", variant="circuits"))]),
        dict(name="library-cells", title="All cells by EPE- and DPB-OPC", make=cells_table,
             runs=[("combinational", flow("flows/chapter3.yaml", cells)),
                   ("with state", flow("flows/chapter3.yaml", states, variant="masks"))],
             pictures=[("transients.svg", transients_picture), ("cells.svg", cells_picture),
                       ("cell-ratios.svg", cell_ratios_picture)]),
        dict(name="library-dpb", title="Masks from cells by DPB-OPC", make=library_table, show=1, runs=[
            (c, flow("flows/library-compare.yaml", "compare.methods=[dpb_flat, dpb_cells, dpb_placed, dpb_2, dpb_0]",
                     "compare.cases=[{ name: %s, layout.file: $DATA/iscas85/%s/%s.gds, layout.scale: 1.3,"
                     " layout.layers.outline: 235/0, mask.neighbours: outline }]" % (c, c, c)))
            for c in CIRCUITS]),
        dict(name="bias", title="Ion and area over the size of the mask", quick=True, make=bias_table, show=1,
             files=bias_masks,
             runs=[(bias_name(*b), flow(
                 "flows/given.yaml", "layout.use=read.cif", "layout.file=data/cells65/nmos.cif",
                 "layout.layers={ poly: CP, active: CA, nimplant: CSN }", "other.use=read.cif",
                 "other.file=$RUNS/bias-%s.cif" % bias_name(*b), "other.layers={ poly: CP, active: CA }")) for b in BIASES],
             pictures=[("bias-l.svg", bias_picture("l")), ("bias-w.svg", bias_picture("w"))]),
        dict(name="onestep", title="One step of sensitivities", make=onestep_table,
             runs=[("one step, sram4", flow("flows/newton.yaml", "mask.synthesizer.iterations=1", "mask.guard=off",
                                            variant="plain")),
                   ("loop, sram4", flow("flows/newton.yaml", variant="plain")),
                   ("one step, c432", circuit("c432", "flows/newton.yaml", "mask.synthesizer.iterations=1",
                                              "mask.guard=off", "mask.synthesizer.target=plain")),
                   ("loop, c432", circuit("c432", "flows/newton.yaml", "mask.synthesizer.target=plain"))]),
    ]
    for one in made:
        one["document"] = DOCUMENT
    return made
