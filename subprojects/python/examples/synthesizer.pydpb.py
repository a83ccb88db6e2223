# SPDX-License-Identifier: BSD-3-Clause
"""synthesizer.dpb in Python, for all transistors at once by NumPy: thesis section 3.2.2 (2) and
figure 3.3. The result has the same bits as that of the C plugin, whose README describes the
algorithm (plugins/synthesizer/dpb, subprojects/correct/control.c)."""
import numpy as np
from opcflow import OPEN, Synthesizer, choice, real

COARSE, FINE, SETTLED = range(3)
WITHIN, GRID, BRIDGING, BIAS, MOVING = range(5)
VERDICTS = ("within limit", "grid", "bridging", "bias limit", "not done")

# Constants of subprojects/correct/control.c.
WIDEST_STEP, MIN_PART, REST, REOPENINGS = 20, 0.55, 10, 8


def veto_of_l(step):
    """Return the veto of a step of L: EDA_VETO_LONGER or EDA_VETO_SHORTER."""
    return np.where(step > 0, 1, 2)


def veto_of_w(step):
    """Return the veto of a step of W: EDA_VETO_WIDER or EDA_VETO_NARROWER."""
    return np.where(step > 0, 4, 8)


class PyDpb(Synthesizer):
    """Device performance-based OPC in Python: one-step descent on Ion"""

    version = "1.0.0"
    deterministic = True
    ion_limit = real("largest allowed |Ion deviation|; a transistor within the limit is not "
                     "changed", unit="%", above=0, follows="ion_limit of the step")
    max_bias = real("largest correction of L or W; W moves by at most half of W", unit="nm",
                    above=0, at_most=10000, follows="0.311 lambda/NA")
    w_step = choice("steps of W: one grid step, or proportional to the error",
                    ("unit", "proportional"), preset="proportional")

    def begin(self, f):
        n, grid = f.gates.count, f.gates.grid
        if self.ion_limit is None:
            self.ion_limit = 0.5 if f.ion_limit is None else f.ion_limit
        self.most = int(self.max_bias / grid)
        self.width = f.gates.width / grid
        self.most_w = np.minimum(self.most, (self.width / 2).astype(int))
        self.widest = int(max(1, WIDEST_STEP / grid))
        self.begun = self.fine = False
        self.error, self.rest, self.by_l = np.zeros((3, n))
        self.rested, self.exchanged = np.zeros((2, n), bool)
        self.phase, self.verdicts, self.barred, self.reopened, self.last_l, self.last_w, \
            self.ceiling = np.zeros((7, n), int)

    def first(self, error, moves):
        """Move each transistor beyond the limit by one step that reduces the error."""
        moving = np.abs(error) > self.ion_limit
        step = np.clip(np.where(error > 0, 1, -1), -self.most, self.most)
        self.verdicts[moving] = MOVING
        self.last_l[moving] = step[moving]
        moves.l[moving] += step[moving].astype(np.int32)
        return moving & (step != 0)

    def exchange(self, active, sign, blocked, moves):
        """Move L by one step where W has reached its bound, so that W can leave the bound."""
        if self.w_step != "proportional":
            return np.zeros_like(active)
        now = active & (self.verdicts == BIAS) & ~self.exchanged & (
            np.abs(moves.w) >= self.most_w) & ~blocked & (np.abs(moves.l + sign) <= self.most)
        moves.l[now] += sign[now].astype(np.int32)
        self.exchanged[now] = True
        self.ceiling[now] = 0
        self.reopened[now] = REOPENINGS
        self.phase[now] = FINE
        self.verdicts[now] = MOVING
        return now

    def reconsider(self, active, error, blocked):
        """Restart transistors whose error was changed by their neighbours."""
        size = np.abs(error)
        now = active & (self.phase != COARSE) & (self.reopened < REOPENINGS) & (self.last_w == 0)
        new = now & ~self.rested
        self.rest[new] = error[new]
        self.rested |= now
        now &= np.abs(error - self.rest) > self.ion_limit / REST
        coarse = now & (self.by_l > 0) & (size > MIN_PART * self.by_l) & ~blocked
        fine = now & ~coarse & (self.phase == SETTLED) & (size > MIN_PART * (100 / self.width))
        self.phase[coarse] = COARSE
        self.phase[fine] = FINE
        changed = coarse | fine
        self.last_l[changed] = self.ceiling[changed] = 0
        self.rested[changed] = False
        self.reopened[changed] += 1

    def judge(self, active, error, passed, veto, moves):
        """Evaluate the last step of L. Returns the transistors whose step is reverted."""
        last = self.last_l.copy()
        now = active & (last != 0)
        self.by_l[now] = np.abs(error - self.error)[now] / np.abs(last[now])
        self.last_l[now] = 0
        forbidden = now & (veto & veto_of_l(last) != 0)
        self.barred[forbidden] |= veto_of_l(last)[forbidden]
        over = now & ~forbidden & (np.abs(last) <= 1) & passed
        self.phase[forbidden | over] = FINE
        back = forbidden | (over & (np.abs(error) > np.abs(self.error)))
        moves.l[back] -= last[back].astype(np.int32)
        return back

    def move_lengths(self, error, passed, veto, moves):
        """Apply the next step of L. Returns the transistors that moved."""
        sign = np.where(error > 0, 1, -1)
        within = (np.abs(error) <= self.ion_limit) & ~((veto & 1 != 0) & (self.last_l > 0))
        self.verdicts[within] = WITHIN
        self.last_l[within] = self.last_w[within] = 0
        moved = self.exchange(~within, sign, (veto | self.barred) & veto_of_l(sign) != 0, moves)
        active = ~within & ~moved
        self.reconsider(active, error, (veto | self.barred) & veto_of_l(sign) != 0)
        active &= self.phase != SETTLED
        self.verdicts[active] = MOVING
        active &= self.phase == COARSE
        back = self.judge(active, error, passed, veto, moves)
        active &= ~back & (self.phase == COARSE)
        blocked = active & (((veto | self.barred) & veto_of_l(sign) != 0)
                            | (np.abs(moves.l + sign) > self.most))
        self.phase[blocked] = FINE
        active &= ~blocked
        self.last_l[active] = sign[active]
        moves.l[active] += sign[active].astype(np.int32)
        return moved | back | active

    def settle(self, now, verdict):
        self.phase[now] = SETTLED
        self.verdicts[now] = verdict
        self.last_l[now] = self.last_w[now] = 0
        self.rested[now] = False

    def width_step(self, error, passed, w):
        """Return the step of W that reduces the error, and its new bound."""
        sign = np.where(error > 0, -1, 1)
        if self.w_step == "unit":
            return sign, self.ceiling
        halved = np.where((self.last_w != 0) & passed, np.abs(self.last_w) // 2, self.ceiling)
        size = np.floor(np.abs(error) / 100 * (self.width + w))
        size = np.where(halved != 0, np.minimum(size, halved), size)
        size = np.where(sign > 0, np.minimum(size, self.widest), size)
        return sign * np.maximum(size, 1).astype(int), halved

    def move_widths(self, now, error, passed, veto, moves):
        """Apply the next step of W. Returns the transistors that moved."""
        now = now & (self.phase == FINE) & (self.verdicts == MOVING)
        last = now & (np.abs(self.last_w) == 1) & passed
        back = last & (np.abs(error) > np.abs(self.error))
        moves.w[back] -= self.last_w[back].astype(np.int32)
        self.settle(last, GRID)
        now &= ~last
        step, ceiling = self.width_step(error, passed, moves.w)
        self.ceiling[now] = ceiling[now]
        step = np.maximum(np.minimum(step, self.most_w - moves.w), -self.most_w - moves.w)
        stopped = now & ((step == 0) | (veto & veto_of_w(step) != 0))
        self.settle(stopped & (step != 0), BRIDGING)
        self.settle(stopped & (step == 0), BIAS)
        now &= ~stopped
        self.last_w[now] = step[now]
        moves.w[now] += step[now].astype(np.int32)
        return back | now

    def update(self, f, moves):
        design = f.design.ion
        error = np.where(f.flags & OPEN, 100.0, 100 * (f.printed.ion - design) / design)
        passed = (error > 0) != (self.error > 0)
        veto = f.vetoes.astype(int)
        if not self.begun:
            moved = self.first(error, moves)
            widths, changed = np.zeros_like(moved), False
        else:
            moved = self.move_lengths(error, passed, veto, moves)
            self.fine |= not moved.any()
            widths = self.move_widths(~moved & self.fine, error, passed, veto, moves)
            changed = (error != self.error).any()
        self.fine |= not moved.any()
        self.error, self.begun = error, True
        return not (moved.any() or widths.any() or changed)

    def verdict(self, gate):
        return VERDICTS[self.verdicts[gate]]
