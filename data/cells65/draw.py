#!/usr/bin/env python3
# Copyright (c) the opcflow authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draw the 65 nm demo cells: one CIF 2.0 layout and one SPICE netlist each.

    python3 draw.py [folder]        (default: the folder of this file)

This program is the drawing: change a rule or a width here and run it again.
All coordinates are whole nanometres.  The netlist is recorded along
with the drawing of the gates, with the nets that the wires are meant to connect;
a layout-versus-schematic check confirms that they do.
"""

import os
import sys

# Rules, nm ------------------------------------------------------------------

L = 65              # gate length
PITCH = 250         # gate pitch along a shared diffusion
POLY_EXT = 84       # poly past active, across the channel
DIFF_END = 98       # diffusion past the gate where it ends without a contact
CONTACT = 75        # contact, square
CONTACT_GATE = 55   # contact to gate; PITCH = L + CONTACT + 2 * CONTACT_GATE
CONTACT_SPACE = 90
DIFF_ENC = 15       # diffusion around a contact
POLY_ENC = 20       # poly around a contact
METAL_ENC = 10      # metal around a contact
METAL_SPACE = 90
PAD = CONTACT + 2 * POLY_ENC
STRAP = CONTACT + 2 * METAL_ENC

GAP = 305           # n active to p active; a poly pad is in its middle
RAIL = 180          # width of a supply rail, centred on the edge of the cell
RAIL_SPACE = 200    # supply centre line to active
WELL_OVERLAP = 100  # well and implants reach this far into the neighbouring cell

ACTIVE, POLY, CUT, WELL, METAL = "CA", "CP", "CC", "CW", "CM"
N_IMPLANT, P_IMPLANT = "CSN", "CSP"
VIA1, METAL2, VIA2, METAL3 = "CV1", "CM2", "CV2", "CM3"
LAYERS = (WELL, N_IMPLANT, P_IMPLANT, ACTIVE, POLY, CUT, METAL, VIA1, METAL2, VIA2, METAL3)


# Cells ----------------------------------------------------------------------

class Transform:
    """Mirror in x or y or turn by a half or a quarter turn, then translate."""

    def __init__(self, op="", dx=0, dy=0):
        self.op, self.dx, self.dy = op, dx, dy

    def __call__(self, x, y):
        x, y = {"": (x, y), "MX": (-x, y), "MY": (x, -y),
                "R -1 0": (-x, -y), "R 0 1": (-y, x)}[self.op]
        return x + self.dx, y + self.dy

    def cif(self):
        text = {"MX": " M X", "MY": " M Y"}.get(self.op, " " + self.op if self.op else "")
        return text + (f" T {self.dx} {self.dy}" if self.dx or self.dy else "")


class Cell:
    def __init__(self, name):
        self.name = name
        self.shapes = {layer: [] for layer in LAYERS}   # lists of points
        self.labels = []                                # (text, x, y, layer)
        self.calls = []                                 # (cell, transform)
        self.gates = []                                 # (device, d, g, s, b, model, w, x, y)

    def polygon(self, layer, *points):
        self.shapes[layer].append(list(points))

    def box(self, layer, x0, y0, x1, y1):
        assert x0 < x1 and y0 < y1, (self.name, layer, x0, y0, x1, y1)
        self.polygon(layer, (x0, y0), (x1, y0), (x1, y1), (x0, y1))

    def cut(self, layer, x, y):
        """A contact or via by its lower left corner."""
        self.box(layer, x, y, x + CONTACT, y + CONTACT)

    def label(self, text, x, y, layer):
        self.labels.append((text, x, y, layer))

    def call(self, cell, op="", dx=0, dy=0):
        self.calls.append((cell, Transform(op, dx, dy)))

    def finger(self, x, y0, y1):
        """A poly line across the active from y0 to y1, with its left edge at x."""
        self.box(POLY, x, y0 - POLY_EXT, x + L, y1 + POLY_EXT)

    def gate(self, device, d, g, s, b, model, x, y0, y1):
        """Record the gate of the finger at x over the active from y0 to y1."""
        self.gates.append((device, d, g, s, b, model, y1 - y0, x + L / 2, (y0 + y1) / 2))

    def flat_gates(self):
        """(indices of the calls, gate) of the cell's gates and of those it calls."""
        for gate in self.gates:
            yield (), gate
        for index, (cell, place) in enumerate(self.calls):
            for path, gate in cell.flat_gates():
                yield (index,) + path, gate[:7] + place(*gate[7:])


def number(value):
    return f"{value:g}"


def cif_shape(points):
    """A box where its centre is on the grid, else a polygon."""
    (x0, y0), (x1, y1) = points[0], points[2]
    if len(points) == 4 and (x0 + x1) % 2 == 0 and (y0 + y1) % 2 == 0:
        return f"B {x1 - x0} {y1 - y0} {(x0 + x1) // 2} {(y0 + y1) // 2};"
    return "P " + " ".join(f"{x} {y}" for x, y in points) + ";"


def write_cif(path, top, title):
    order = []

    def visit(cell):
        for child, _ in cell.calls:
            visit(child)
        if cell not in order:
            order.append(cell)

    visit(top)
    lines = [f"({title});", "(made by draw.py; unit inside symbols: 1 nm);"]
    for symbol, cell in enumerate(order, 1):
        # CIF counts in 10 nm; 1 / 10 makes the unit of the symbol 1 nm.
        lines += [f"DS {symbol} 1 10;", f"9 {cell.name};"]
        for layer in LAYERS:
            if cell.shapes[layer]:
                lines.append(f"L {layer};")
                lines += [cif_shape(points) for points in cell.shapes[layer]]
        lines += [f"C {order.index(child) + 1}{place.cif()};" for child, place in cell.calls]
        for layer in LAYERS:    # a label is on the current layer, as KLayout reads it
            labels = [label for label in cell.labels if label[3] == layer]
            if labels:
                lines.append(f"L {layer};")
                lines += [f"94 {text} {x} {y};" for text, x, y, _ in labels]
        lines.append("DF;")
    lines += [f"C {len(order)};", "E"]
    with open(path, "w", newline="\n") as file:
        file.write("\n".join(lines) + "\n")


def write_netlist(path, name, pins, gates, title):
    lines = [f"* {title}", "* made by draw.py; w and l in metres, $ the centre of the drawn gate",
             f".subckt {name} " + " ".join(pins)]
    for device, d, g, s, b, model, w, x, y in gates:
        lines.append(f"M{device} {d} {g} {s} {b} {model} w={w}e-9 l={L}e-9"
                     f" $ x={number(x)} y={number(y)} nm centre")
    lines += [f".ends {name}"]
    with open(path, "w", newline="\n") as file:
        file.write("\n".join(lines) + "\n")


# Parts of a cell ------------------------------------------------------------

def columns(gates):
    """Left edges of the contact columns beside and between gates at PITCH."""
    return [gates[0] - CONTACT_GATE - CONTACT] + [x + L + CONTACT_GATE for x in gates]


def contact_column(cell, x, y0, y1):
    """Contacts over the diffusion height y0..y1; returns the metal's y range."""
    space = y1 - y0 - 2 * DIFF_ENC
    count = (space + CONTACT_SPACE) // (CONTACT + CONTACT_SPACE)
    step = (space - CONTACT) // (count - 1) if count > 1 else 0
    step = min(step, CONTACT + CONTACT_SPACE)
    first = y0 + (y1 - y0 - CONTACT - step * (count - 1)) // 2
    for i in range(count):
        cell.cut(CUT, x, first + i * step)
    return first - METAL_ENC, first + (count - 1) * step + CONTACT + METAL_ENC


def row(cell, model, names, gates, gate_nets, nets, y0, y1, supply, rail):
    """The diffusion of a row of vertical gates, its contacts and metal.

    nets has one entry per column of diffusion, left to right; a name in
    brackets is a series node, which has no contact.  Columns of the supply are
    strapped to the rail at y = rail.  Returns {column: (x, y0, y1)} of the
    metal of the others.
    """
    ends = CONTACT_GATE + CONTACT + DIFF_ENC
    cell.box(ACTIVE, gates[0] - ends, y0, gates[-1] + L + ends, y1)
    for i, x in enumerate(gates):
        left, right = nets[i].strip("()"), nets[i + 1].strip("()")
        d, s = (left, right) if right == supply or nets[i + 1][0] == "(" else (right, left)
        cell.gate(names[i], d, gate_nets[i], s, supply, model, x, y0, y1)
    metal = {}
    for i, x in enumerate(columns(gates)):
        if nets[i][0] == "(":
            cell.label(nets[i].strip("()"), x + CONTACT // 2, (y0 + y1) // 2, ACTIVE)
            continue
        low, high = contact_column(cell, x, y0, y1)
        x -= METAL_ENC
        if nets[i] == supply:
            cell.box(METAL, x, min(low, rail), x + STRAP, max(high, rail))
        else:
            metal[i] = (x, low, high)
    return metal


def gate_pad(cell, net, x, n_top, side, contacts=1):
    """The connectivity part between an n gate and a p gate at x: poly, contact, metal."""
    y = n_top + (GAP - PAD) // 2
    reach = 85 + (contacts - 1) * (CONTACT + CONTACT_SPACE)
    x0, x1 = (x - reach, x + L) if side < 0 else (x, x + L + reach)
    cell.box(POLY, x0, y, x1, y + PAD)
    first = x0 + POLY_ENC if side < 0 else x1 - POLY_ENC - CONTACT
    for i in range(contacts):
        cell.cut(CUT, first - side * i * (CONTACT + CONTACT_SPACE), y + POLY_ENC)
    last = first - side * (contacts - 1) * (CONTACT + CONTACT_SPACE)
    m0, m1 = min(first, last) - METAL_ENC, max(first, last) + CONTACT + METAL_ENC
    cell.box(METAL, m0, y + POLY_ENC - METAL_ENC, m1, y + POLY_ENC + CONTACT + METAL_ENC)
    cell.label(net, (m0 + m1) // 2, y + PAD // 2, METAL)


def frame(cell, width, n_top, height):
    """Rails, well and implants of a cell from x = 0 to width."""
    middle = n_top + GAP // 2
    x0, x1 = -WELL_OVERLAP, width + WELL_OVERLAP
    cell.box(WELL, x0, middle, x1, height)
    cell.box(N_IMPLANT, x0, 0, x1, middle)
    cell.box(P_IMPLANT, x0, middle, x1, height)
    for net, y in (("VSS", 0), ("VDD", height)):
        cell.box(METAL, 0, y - RAIL // 2, width, y + RAIL // 2)
        cell.label(net, width // 2, y, METAL)


# The cells ------------------------------------------------------------------

N_TOP = RAIL_SPACE + 400            # standard cells: n up to 400, p up to 600
P_BOTTOM = N_TOP + GAP
HEIGHT = P_BOTTOM + 600 + RAIL_SPACE
FIRST = PITCH - L // 2              # left edge of the first gate


def transistor(name, width):
    """One bare transistor, as the thesis characterises it (figure 3.5)."""
    cell = Cell(name)
    model = name
    cell.box(ACTIVE, -DIFF_END, 0, L + DIFF_END, width)
    cell.finger(0, 0, width)
    cell.gate("1", "D", "G", "S", "B", model, 0, 0, width)
    margin = 200
    around = (-DIFF_END - margin, -margin, L + DIFF_END + margin, width + margin)
    if model == "pmos":
        cell.box(WELL, *around)
        cell.label("B", -DIFF_END - margin // 2, -margin // 2, WELL)
    cell.box(P_IMPLANT if model == "pmos" else N_IMPLANT, *around)
    cell.label("S", -DIFF_END // 2, width // 2, ACTIVE)
    cell.label("G", L // 2, -POLY_EXT // 2, POLY)
    cell.label("D", L + DIFF_END // 2, width // 2, ACTIVE)
    return cell, ["D", "G", "S", "B"]


def inverter(name="inverter", wn=300, wp=450):
    cell = Cell(name)
    frame(cell, 2 * PITCH, N_TOP, HEIGHT)
    gates = [FIRST]
    n = row(cell, "nmos", ["N1"], gates, ["A"], ["VSS", "Y"], N_TOP - wn, N_TOP, "VSS", 0)
    p = row(cell, "pmos", ["P1"], gates, ["A"], ["VDD", "Y"],
            P_BOTTOM, P_BOTTOM + wp, "VDD", HEIGHT)
    cell.finger(FIRST, N_TOP - wn, P_BOTTOM + wp)
    gate_pad(cell, "A", FIRST, N_TOP, -1)
    x, low, _ = n[1]
    cell.box(METAL, x, low, x + STRAP, p[1][2])
    cell.label("Y", x + STRAP // 2, N_TOP + GAP // 2, METAL)
    return cell, ["A", "Y", "VDD", "VSS"]


def two_input(name, wn, wp, series):
    """NAND2 (series "n") or NOR2 (series "p"): the parallel pair has its output
    in the middle, the series pair at its right end."""
    cell = Cell(name)
    frame(cell, 3 * PITCH, N_TOP, HEIGHT)
    gates, inputs = [FIRST, FIRST + PITCH], ["A", "B"]

    def nets(kind, supply):
        return [supply, "(X)", "Y"] if kind == series else [supply, "Y", supply]

    n = row(cell, "nmos", ["N1", "N2"], gates, inputs, nets("n", "VSS"),
            N_TOP - wn, N_TOP, "VSS", 0)
    p = row(cell, "pmos", ["P1", "P2"], gates, inputs, nets("p", "VDD"),
            P_BOTTOM, P_BOTTOM + wp, "VDD", HEIGHT)
    for x in gates:
        cell.finger(x, N_TOP - wn, P_BOTTOM + wp)
    gate_pad(cell, "A", gates[0], N_TOP, -1)
    gate_pad(cell, "B", gates[1], N_TOP, +1)
    # From the middle past both pads, then right to the series end.
    pad = N_TOP + (GAP - STRAP) // 2            # bottom of the pads' metal
    if series == "n":
        (xm, *middle), (xe, *end), y = p[1], n[2], pad - METAL_SPACE - STRAP
    else:
        (xm, *middle), (xe, *end), y = n[1], p[2], pad + STRAP + METAL_SPACE
    cell.box(METAL, xm, min(y, *middle), xm + STRAP, max(y + STRAP, *middle))
    cell.box(METAL, xm, y, xe + STRAP, y + STRAP)
    cell.box(METAL, xe, min(y, *end), xe + STRAP, max(y + STRAP, *end))
    cell.label("Y", xm + STRAP // 2, N_TOP + GAP // 2, METAL)
    return cell, ["A", "B", "Y", "VDD", "VSS"]


def nand2(name="nand2"):
    return two_input(name, 400, 450, "n")


def nor2(name="nor2"):
    return two_input(name, 300, 600, "p")


def nand2h():
    """The NAND2 by a quarter turn: horizontal gates, through a rotated call."""
    upright, pins = nand2("nand2_upright")
    cell = Cell("nand2h")
    cell.call(upright, "R 0 1", HEIGHT, 0)
    # Labels only at the top, so that a flattening reader sees each once.
    place = cell.calls[0][1]
    cell.labels = [(text, *place(x, y), layer) for text, x, y, layer in upright.labels]
    upright.labels = []
    return cell, pins


def inverter_chain(load=4e-12, fan_out=3.5, fingers=(1, 1, 1, 4, 12, 41),
                   gate_cap=1.73e-15, ratio=1.5):
    """Six stages, each fan_out times the one before, the load fan_out times the last.

    gate_cap is the input capacitance per micrometre of n + p width, switching,
    with the Miller effect; ratio is the p width over the n width.
    """
    stages = len(fingers)
    first = load / fan_out ** stages / gate_cap / (1 + ratio) * 1e3     # n width, nm

    def width(stage, scale):
        return round(first * scale * fan_out ** stage / fingers[stage] / 10) * 10

    wn = [width(k, 1) for k in range(stages)]
    wp = [width(k, ratio) for k in range(stages)]
    n_top = RAIL_SPACE + max(wn)
    p_bottom = n_top + GAP
    height = p_bottom + max(wp) + RAIL_SPACE
    bus = n_top + (GAP - PAD) // 2
    nets = ["IN"] + [f"N{k}" for k in range(1, stages)] + ["OUT"]

    cell = Cell("inverter_chain")
    x = FIRST
    end_of_bus = None
    for k, count in enumerate(fingers):
        gates = [x + PITCH * i for i in range(count)]
        contacts = min(4, 1 + count // 10)
        names = [[f"{kind}{k + 1}_{i + 1}" for i in range(count)] for kind in "NP"]
        gate_nets = [nets[k]] * count
        n = row(cell, "nmos", names[0], gates, gate_nets,
                ["VSS" if i % 2 == 0 else nets[k + 1] for i in range(count + 1)],
                n_top - wn[k], n_top, "VSS", 0)
        p = row(cell, "pmos", names[1], gates, gate_nets,
                ["VDD" if i % 2 == 0 else nets[k + 1] for i in range(count + 1)],
                p_bottom, p_bottom + wp[k], "VDD", height)
        for gate in gates:
            cell.finger(gate, n_top - wn[k], p_bottom + wp[k])
        gate_pad(cell, nets[k], x, n_top, -1, contacts)
        if count > 1:       # the fingers' common poly, between the two actives
            cell.box(POLY, gates[0], bus, gates[-1] + L, bus + PAD)
        if end_of_bus is not None:      # from the drains of the stage before
            cell.box(METAL, end_of_bus, bus + METAL_ENC, x, bus + METAL_ENC + STRAP)
        for i, (xm, low, _) in n.items():
            cell.box(METAL, xm, low, xm + STRAP, p[i][2])
        drains = [xm for xm, *_ in n.values()]
        if len(drains) > 1:
            cell.box(METAL, drains[0], bus, drains[-1] + STRAP, bus + PAD)
        end_of_bus = drains[-1]
        x = gates[-1] + 3 * PITCH
    cell.box(METAL, end_of_bus, bus, x - 2 * PITCH, bus + PAD)
    cell.label("OUT", x - 2 * PITCH - 50, bus + PAD // 2, METAL)
    frame(cell, x - 2 * PITCH, n_top, height)
    return cell, ["IN", "OUT", "VDD", "VSS"]


# SRAM -----------------------------------------------------------------------
#
# The 6T cell of 65 nm, lying on its side: two rows of gates at PITCH, word
# lines vertical, bit lines horizontal.  From bottom to top the diffusions hold
# access 1 and driver 1, load 1, load 2, driver 2 and access 2.  It is half a
# cell called twice, once by half a turn.  A stretched contact joins the end of
# each inverter's gate to the other's drain (the cross-coupling).

PASS_W, DRIVER_W, LOAD_W = 140, 210, 105
SRAM_N = 105                        # bottom of the n diffusion
SRAM_P = 515                        # bottom of the p diffusion
SRAM_MIDDLE = 690                   # of the cell, in y
COLUMN = [-130, 120, 370]           # contact columns; the outer ones are on the edges
GATE = [0, PITCH]
CELL_Y = 2 * SRAM_MIDDLE + CONTACT  # height of the cell, word line contacts shared
EDGE_X = (-93, 408)                 # of the cell, rounded outwards


def half_bitcell():
    cell = Cell("half_bitcell")
    n_high, p_high = SRAM_N + DRIVER_W, SRAM_P + LOAD_W
    row_n = SRAM_N + (PASS_W - CONTACT) // 2    # contact rows
    row_p = SRAM_P + DIFF_ENC
    x0, x1 = EDGE_X

    well = (n_high + SRAM_P) // 2
    cell.box(WELL, x0, well, x1, SRAM_MIDDLE)
    cell.box(P_IMPLANT, x0, well, x1, SRAM_MIDDLE)
    cell.box(N_IMPLANT, x0, -38, x1, well)

    # n diffusion: access transistor, then the wider driver, stepped midway
    left, step, right = COLUMN[0] - DIFF_ENC, 157, COLUMN[2] + CONTACT + DIFF_ENC
    cell.polygon(ACTIVE, (left, SRAM_N), (right, SRAM_N), (right, n_high),
                 (step, n_high), (step, SRAM_N + PASS_W), (left, SRAM_N + PASS_W))
    # p diffusion: drain at the left, under the stretched contact
    cell.box(ACTIVE, COLUMN[1] - 5, SRAM_P, right, p_high)

    # word line: access gate with its pad on the edge of the cell
    cell.gate("A", "Q", "WL", "BL", "VSS", "nmos", GATE[0], SRAM_N, SRAM_N + PASS_W)
    cell.box(POLY, GATE[0] - 25, -95, GATE[0] + 90, 20)
    cell.box(POLY, GATE[0], 20, GATE[0] + L, SRAM_N + PASS_W + POLY_EXT)
    cell.cut(CUT, GATE[0] - 5, -75)
    # driver and load share a gate, which runs on to the other half's drain
    cell.gate("D", "Q", "QB", "VSS", "VSS", "nmos", GATE[1], SRAM_N, n_high)
    cell.gate("L", "Q", "QB", "VDD", "VDD", "pmos", GATE[1], SRAM_P, p_high)
    other_end = 2 * SRAM_MIDDLE - SRAM_P - DIFF_ENC + POLY_ENC
    cell.box(POLY, GATE[1], SRAM_N - POLY_EXT, GATE[1] + L, other_end)

    for x in COLUMN:
        cell.cut(CUT, x, row_n)
    cell.cut(CUT, COLUMN[2], row_p)
    cell.box(CUT, GATE[0] + 10, row_p, COLUMN[1] + CONTACT, row_p + CONTACT)

    # metal 1: storage node, and islands for the rest
    e = METAL_ENC
    top_n, top_p = row_n + CONTACT + e, row_p + CONTACT + e
    vss_high = row_p - e - 90
    cell.box(METAL, COLUMN[1] - e, row_n - e, COLUMN[1] + CONTACT + e, top_p)
    cell.box(METAL, GATE[0], row_p - e, COLUMN[1], top_p)
    cell.box(METAL, COLUMN[0] - e, row_n - e, COLUMN[0] + CONTACT + e, top_n)
    cell.box(METAL, COLUMN[2] - e, row_n - e, COLUMN[2] + CONTACT + e, vss_high)
    cell.box(METAL, COLUMN[2] - e, row_p - e, COLUMN[2] + CONTACT + e, top_p)
    cell.box(METAL, GATE[0] - 15, -85, GATE[0] + 80, 10)

    # metal 2: bit line, ground, supply (up to the middle); word line to metal 3
    x0, x1 = left, right
    cell.cut(VIA1, COLUMN[0], row_n)
    cell.box(METAL2, x0, row_n - e, x1, top_n)
    cell.cut(VIA1, COLUMN[2], vss_high - e - CONTACT)
    cell.box(METAL2, x0, vss_high - 100, x1, vss_high)
    cell.cut(VIA1, COLUMN[2], row_p)
    cell.box(METAL2, x0, row_p - e, x1, SRAM_MIDDLE)
    cell.cut(VIA1, GATE[0] - 5, -75)
    cell.box(METAL2, GATE[0] - 15, -87, COLUMN[1] + CONTACT + e, 13)
    cell.cut(VIA2, COLUMN[1], -75)
    cell.box(METAL3, COLUMN[1] - e, -85, COLUMN[1] + CONTACT + e, SRAM_MIDDLE)
    return cell


def sram4(words=4, bits=8):
    """words x bits cells: words along x, the bits of a word along y."""
    half = half_bitcell()
    bit = Cell("bitcell")
    bit.call(half)
    bit.call(half, "R -1 0", sum(EDGE_X), 2 * SRAM_MIDDLE)

    # Cells are mirrored about the contacts that they share: every second one of a
    # column in y, inside a pair; every second column in x.
    pair = Cell("bitcell_pair")
    pair.call(bit)
    pair.call(bit, "MY", 0, 2 * CELL_Y - CONTACT)

    top = Cell("sram4")
    gates, row_labels = [], []
    for word in range(words):
        op = "MX" if word % 2 else ""
        dx = (word - 1) * 2 * PITCH + 2 * COLUMN[2] + CONTACT if word % 2 else word * 2 * PITCH
        for two in range(bits // 2):
            top.call(pair, op, dx, two * 2 * CELL_Y)
            outer = top.calls[-1][1]
            for up, (_, inner) in enumerate(pair.calls):
                index = 2 * two + up

                def at(x, y, outer=outer, inner=inner):
                    return outer(*inner(x, y))

                x = COLUMN[1] + CONTACT // 2
                y = SRAM_P + LOAD_W // 2
                top.label(f"Q_{word}_{index}", *at(x, y), METAL)
                top.label(f"QB_{word}_{index}", *at(x, 2 * SRAM_MIDDLE - y), METAL)
                if word == 0:
                    row_labels.append((f"BL{index}", f"BLB{index}", at))
        top.label(f"WL{word}", *top.calls[-1][1](157, SRAM_MIDDLE), METAL3)
    for bl, blb, at in row_labels:
        y = SRAM_N + PASS_W // 2
        top.label(bl, *at(157, y), METAL2)
        top.label(blb, *at(157, 2 * SRAM_MIDDLE - y), METAL2)

    # supplies: metal 2 brought out to metal 3, ground left, supply right
    left, right = EDGE_X[0], EDGE_X[0] + 2 * PITCH * words + 1
    y_low, y_high = -38, CELL_Y * bits - 37
    well = (SRAM_N + DRIVER_W + SRAM_P) // 2
    cell_vss = SRAM_P + DIFF_ENC - METAL_ENC - 90
    vss, vdd = (left - 450, left - 200), (right + 200, right + 450)
    top.box(METAL3, vss[0], y_low, vss[1], y_high)
    top.box(METAL3, vdd[0], y_low, vdd[1], y_high)
    for _, _, at in row_labels:
        # well and implants reach past the array's edges
        ys = [at(0, y)[1] for y in (-38, well, 2 * SRAM_MIDDLE - well, 2 * SRAM_MIDDLE + 38)]
        x0, x1 = left - 2 * WELL_OVERLAP, right + 2 * WELL_OVERLAP
        ys.sort()
        top.box(WELL, x0, ys[1], x1, ys[2])
        top.box(P_IMPLANT, x0, ys[1], x1, ys[2])
        top.box(N_IMPLANT, x0, ys[0], x1, ys[1])
        top.box(N_IMPLANT, x0, ys[2], x1, ys[3])
        for y in (cell_vss - 100, 2 * SRAM_MIDDLE - cell_vss):
            low = min(at(0, y)[1], at(0, y + 100)[1])
            top.box(METAL2, vss[0], low, left + 10, low + 100)
            top.cut(VIA2, vss[0] + 87, low + 12)
        low = at(0, SRAM_MIDDLE)[1] - 90
        top.box(METAL2, right - 10, low, vdd[1], low + 180)
        top.cut(VIA2, vdd[0] + 87, low + 52)
    top.label("VSS", sum(vss) // 2, y_low + 100, METAL3)
    top.label("VDD", sum(vdd) // 2, y_low + 100, METAL3)

    for (call, up, side), gate in top.flat_gates():
        word, index = call // (bits // 2), 2 * (call % (bits // 2)) + up
        local = {"BL": f"BL{index}", "WL": f"WL{word}", "Q": f"Q_{word}_{index}",
                 "QB": f"QB_{word}_{index}"}
        if side:        # the half that is turned has the roles of Q and QB exchanged
            local = {"BL": f"BLB{index}", "WL": f"WL{word}", "Q": local["QB"], "QB": local["Q"]}
        device, *nets = gate[:5]
        gates.append((f"{device}{side + 1}_{word}_{index}",
                      *[local.get(net, net) for net in nets], *gate[5:]))
    pins = [f"WL{w}" for w in range(words)]
    for b in range(bits):
        pins += [f"BL{b}", f"BLB{b}"]
    return top, pins + ["VDD", "VSS"], gates


CELLS = (
    (lambda: transistor("nmos", 1000), "single n transistor, W 1000 nm"),
    (lambda: transistor("pmos", 1000), "single p transistor, W 1000 nm"),
    (inverter, "n 300 nm, p 450 nm"),
    (nand2, "two-input NAND, n 400 nm, p 450 nm"),
    (nor2, "two-input NOR, n 300 nm, p 600 nm"),
    (nand2h, "two-input NAND with horizontal gates"),
    (inverter_chain, "six-stage inverter chain, fan-out 3.5, for a load of 4 pF"),
    (sram4, "SRAM of four bytes, 32 six-transistor cells"),
)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    for draw, title in CELLS:
        cell, pins, *rest = draw()
        gates = rest[0] if rest else [gate for _, gate in cell.flat_gates()]
        title = f"{cell.name}: {title}"
        write_cif(os.path.join(folder, cell.name + ".cif"), cell, title)
        write_netlist(os.path.join(folder, cell.name + ".sp"), cell.name, pins, gates, title)
        print(f"{cell.name}: {len(gates)} gates")


if __name__ == "__main__":
    main()
