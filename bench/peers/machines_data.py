"""The real machines as arrays on an even clock, cut into what is fitted and what is held out, and the columns of a regression."""
import csv
from dataclasses import dataclass

import numpy as np

BASE = "base"
# A sample further than this many steps after the one before begins a new piece.
GAP_STEPS = 5.0
# Fewest samples of a piece: four windows of the least half-width.
LEAST_SAMPLES = 40
# Stribeck's velocity is not known: a share of the 95th percentile of speed, in the middle of what textbooks give.
STRIBECK_SHARE = 0.1


@dataclass
class Piece:
    """Time (s), held drive, position, on an even clock of step h (s)."""
    t: np.ndarray
    u: np.ndarray
    x: np.ndarray
    h: float

    def cut(self, start, end):
        return Piece(self.t[start:end], self.u[start:end], self.x[start:end], self.h)


@dataclass
class Machine:
    """A machine: pieces to fit, pieces held out (the last third of each recording), and what one knows beforehand."""
    name: str
    unit: str
    waves: list
    fit: list
    held: list
    recordings: int


def even(t, u, x, h):
    """On an even clock: the position by interpolation, the drive as the mean of the holds on both sides."""
    clock = t[0] + h * np.arange(int((t[-1] - t[0]) / h) + 1)
    held = u[np.clip(np.searchsorted(t, clock, side="right") - 1, 0, len(u) - 1)]
    mean = 0.5 * (held + np.concatenate(([held[0]], held[:-1])))
    return Piece(clock, mean, np.interp(clock, t, x), h)


def load(folder):
    """Every machine of the list."""
    machines = []
    with (folder / "list.csv").open() as file:
        listed = list(csv.DictReader(file))
    for row in listed:
        table = np.loadtxt(folder / f"{row['machine']}.csv", delimiter=",", skiprows=1)
        waves = [float(n) for n in row["waves"].split(";") if n]
        recordings = np.unique(table[:, 0])
        machine = Machine(row["machine"], row["unit"], waves, [], [], len(recordings))
        for recording in recordings:
            rows = table[table[:, 0] == recording]
            h = float(np.median(np.diff(rows[:, 2])))
            edge = rows[2 * len(rows) // 3, 2]
            for number in np.unique(rows[:, 1]):
                _, _, t, u, x = rows[rows[:, 1] == number].T
                if len(t) < LEAST_SAMPLES:
                    continue
                whole = even(t, u, x, h)
                at = int(np.searchsorted(whole.t, edge))
                for piece, to in ((whole.cut(0, at), machine.fit), (whole.cut(at, None), machine.held)):
                    if len(piece.t) >= LEAST_SAMPLES:
                        to.append(piece)
        machines.append(machine)
    return machines


def columns(machine, v95):
    """(effect, function of x, v, u, t; wave number or None): the catalogue's laws that are linear in their unknowns when
    poles and slots are known. The base comes first and is never a name."""
    s = np.sign
    vs = STRIBECK_SHARE * v95
    table = [
        (BASE, lambda x, v, u, t: v, None),
        (BASE, lambda x, v, u, t: s(v), None),
        ("constant_load", lambda x, v, u, t: np.ones_like(v), None),
        ("asymmetric_viscous", lambda x, v, u, t: np.abs(v), None),
        ("quadratic_drag", lambda x, v, u, t: v * np.abs(v), None),
        ("stribeck", lambda x, v, u, t: np.exp(-np.abs(v) / vs) * s(v), None),
        ("load_friction", lambda x, v, u, t: np.abs(u) * s(v), None),
        ("friction_drift", lambda x, v, u, t: t * s(v), None),
        ("gain_drift", lambda x, v, u, t: t * u, None),
        ("spring", lambda x, v, u, t: x, None),
        ("spring", lambda x, v, u, t: np.ones_like(v), None),
    ]
    if machine.unit == "rad":
        table += [("gravity_load", lambda x, v, u, t: np.sin(x), None),
                  ("gravity_load", lambda x, v, u, t: np.cos(x), None)]
    for n in machine.waves:
        table += [("cogging", lambda x, v, u, t, n=n: np.sin(n * x), n),
                  ("cogging", lambda x, v, u, t, n=n: np.cos(n * x), n),
                  ("position_friction", lambda x, v, u, t, n=n: np.sin(n * x) * s(v), n),
                  ("position_friction", lambda x, v, u, t, n=n: np.cos(n * x) * s(v), n)]
    return table
