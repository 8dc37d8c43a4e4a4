"""Ten minutes of least squares: what an engineer tries on a recording before reaching for a tool.

The drive is regressed on [a, v, sgn v] in the weak form (test function (1−s²)³ on ±T, so that nothing is differentiated). Then
one law after the other is added, the one with the largest fall of the held-out residual (in log) first, while the fall is
believed. T is 5 to 100 ms (at least five samples), whichever shows the clearest fall. Laws with fewer unknowns are preferred
where they do nearly as well, and laws with as many are tied.

Told: poles or slots of the motors, and what to leave out. Laws that hold the drive "predict" it for nothing, several
recordings need not share a clock, and fast teeth pass within a window: a law of known wave number n is judged where
n·|v|·T < 1.5. A delay is tried by moving the drive.
"""
import numpy as np
from scipy.signal import fftconvolve, savgol_filter

import machines_data
from machines_data import BASE

HALVES_S = (0.005, 0.01, 0.02, 0.05, 0.1)
# Laws that hold the drive "predict" it for nothing.
LEAKS = ("load_friction", "gain_drift")
# Several recordings need not share a clock.
DRIFTS = ("friction_drift",)
LEAST_HALF = 5
# Least fall that is believed: what one would take, and of 0.05, 0.1, 0.2, 0.3, 0.4 and 0.5 the one with the best score on these
# very machines, in the method's favour.
USUAL_FALL, BEST_FALL = 0.1, 0.5
# Share of the best fall that is enough for a law with fewer unknowns.
SIMPLER = 0.8
# Share of the best fall from which a law of as many unknowns is tied.
TIED = 0.9
MOST_NAMES = 3
# Rows below this share of the 95th percentile of speed are at rest.
MOVING = 0.01
TEETH = 1.5
LEAST_ROWS = 50
MOST_DELAY = 12
# Below this share of the drive an engineer calls the base good enough.
GOOD = 0.1


class Rows:
    """Weak rows of some pieces at one half-width: drive (for each delay in samples), acceleration and columns, speed."""

    def __init__(self, pieces, table, half_s, v95):
        drives, rows, speeds, halves = [], [], [], []
        for piece in pieces:
            n = max(LEAST_HALF, round(half_s / piece.h))
            if len(piece.t) < 2 * n + 1 + MOST_DELAY:
                continue
            s = np.arange(-n, n + 1) / (n + 0.5)
            phi = (1 - s * s) ** 3
            phi /= phi.sum()
            scale = 1.0 / ((n + 0.5) * piece.h)
            weight = phi.sum() / ((1 - s * s) ** 3).sum()
            first = weight * -6 * s * (1 - s * s) ** 2 * scale
            second = weight * (-6 * (1 - s * s) ** 2 + 24 * s * s * (1 - s * s)) * scale ** 2
            second -= second.mean()
            # A discrete kernel is not quite that of the continuum: exact on t and t²/2.
            first /= -(first * s).sum() / scale
            second /= 0.5 * (second * s * s).sum() / scale ** 2

            def weak(signal, kernel):
                return fftconvolve(signal, kernel[::-1], mode="valid")

            window = 2 * max(2, n // 2) + 1
            x = piece.x - piece.x.mean()
            v = savgol_filter(x, max(window, 5), 3, deriv=1, delta=piece.h)
            signals = [f(piece.x, v, piece.u, piece.t) for _, f, _ in table]
            # u = b·a: ∫φ·a = ∫φ''·x, and for the velocity −∫φ'·x.
            centres = np.arange(n + MOST_DELAY, len(piece.t) - n, max(1, n // 3))
            at = centres - n
            rows.append(np.column_stack([weak(x, second)[at], -weak(x, first)[at]] + [weak(g, phi)[at] for g in signals[1:]]))
            smooth = weak(piece.u, phi)
            drives.append(np.column_stack([smooth[at - d] for d in range(MOST_DELAY + 1)]))
            speeds.append(np.abs(v[centres]))
            halves.append(np.full(len(at), n * piece.h))
        self.empty = not rows
        if self.empty:
            return
        moving = np.concatenate(speeds) > MOVING * v95
        self.rows, self.drives = np.concatenate(rows)[moving], np.concatenate(drives)[moving]
        self.speed, self.half = np.concatenate(speeds)[moving], np.concatenate(halves)[moving]

    def slow(self, wave):
        return np.ones(len(self.speed), bool) if wave is None else wave * self.speed * self.half < TEETH


def solve(fit, chosen, mask, delay):
    """Coefficients of the chosen columns."""
    a, u = fit.rows[mask][:, chosen], fit.drives[mask, delay]
    scale = np.sqrt(np.mean(a * a, axis=0))
    scale[scale == 0.0] = 1.0
    return np.linalg.lstsq(a / scale, u, rcond=None)[0] / scale


def residual(held, theta, chosen, mask, delay):
    return np.sqrt(np.mean((held.drives[mask, delay] - held.rows[mask][:, chosen] @ theta) ** 2))


class Model:
    """Columns and delay of a model on rows to fit and rows held out."""

    def __init__(self, fit, held, table):
        self.fit, self.held, self.table = fit, held, table
        # Column 0 is the acceleration, then those of the table.
        self.chosen = [0] + [1 + i for i, (name, *_) in enumerate(table) if name == BASE]
        self.delay, self.names, self.said, self.fallen = 0, [], [], 0.0

    def candidates(self):
        for effect in dict.fromkeys(name for name, *_ in self.table if name != BASE):
            more = [1 + i for i, (name, *_) in enumerate(self.table) if name == effect]
            more = [i for i in more if i not in self.chosen]
            if effect not in self.names and more:
                yield effect, more, self.delay, self.table[more[0] - 1][2]
        if "delay" not in self.names:
            for delay in range(1, MOST_DELAY + 1):
                yield "delay", [], delay, None

    def fall(self, more, delay, wave):
        """By how much (log) the held-out residual falls, and the inertia."""
        masks = self.fit.slow(wave), self.held.slow(wave)
        if min(mask.sum() for mask in masks) < LEAST_ROWS:
            return 0.0, 0.0
        before = solve(self.fit, self.chosen, masks[0], self.delay)
        after = solve(self.fit, self.chosen + more, masks[0], delay)
        base = residual(self.held, before, self.chosen, masks[1], self.delay)
        return np.log(base / residual(self.held, after, self.chosen + more, masks[1], delay)), after[0]

    def step(self, least_fall):
        """Adds the best law; whether one was believed."""
        tried = []
        for effect, more, delay, wave in self.candidates():
            fall, inertia = self.fall(more, delay, wave)
            if fall > least_fall and inertia > 0.0:
                tried.append((fall, len(more), effect, more, delay))
        if not tried:
            return False
        best = max(tried, key=lambda entry: entry[0])[0]
        near = [entry for entry in tried if entry[0] >= SIMPLER * best]
        fewest = min(entry[1] for entry in near)
        alike = sorted((e for e in near if e[1] == fewest), key=lambda entry: -entry[0])
        _, _, effect, more, delay = alike[0]
        tied = dict.fromkeys(e[2] for e in alike if e[0] >= TIED * alike[0][0])
        self.names.append(effect)
        self.said.append("~".join(tied))
        self.fallen += best
        self.chosen, self.delay = self.chosen + more, delay
        return True

    def share(self):
        """Held-out residual over the drive."""
        mask = self.held.slow(None)
        theta = solve(self.fit, self.chosen, self.fit.slow(None), self.delay)
        drive = np.sqrt(np.mean(self.held.drives[mask, self.delay] ** 2))
        return residual(self.held, theta, self.chosen, mask, self.delay) / drive


def discover(machine, least_fall):
    """Verdict, names, force residual before and after."""
    speeds = [np.abs(np.diff(p.x[::max(1, round(0.02 / p.h))]) / (p.h * max(1, round(0.02 / p.h)))) for p in machine.fit]
    v95 = np.quantile(np.concatenate(speeds), 0.95)
    left_out = LEAKS + (DRIFTS if machine.recordings > 1 else ())
    table = [column for column in machines_data.columns(machine, v95) if column[0] not in left_out]
    ended = []
    for half_s in HALVES_S:
        fit, held = (Rows(pieces, table, half_s, v95) for pieces in (machine.fit, machine.held))
        if fit.empty or held.empty or min(len(fit.speed), len(held.speed)) < LEAST_ROWS:
            continue
        model = Model(fit, held, table)
        before = model.share()
        while len(model.names) < MOST_NAMES and model.step(least_fall):
            pass
        ended.append((model.fallen, model.said, before, model.share()))
    if not ended:
        return "refused", [], None, None
    _, names, before, after = max(ended, key=lambda entry: entry[0])
    verdict = "partly_explained" if names else "nothing_missing" if before < GOOD else "unknown"
    return verdict, names, before, after
