"""PySINDy's weak form on a real machine: v' = Σ coefficient·column, as in `sparse.py`, on the machine's own clock.

Columns are scaled to an RMS of 1 and the base's own are never thresholded. Smoothing (±20 ms) and subdomains (±40 ms) are those
that were tuned on blind sessions, at least seven and six samples. The threshold is either the tuned one, or of those tried the
one with which the held-out residual of the weak form is least (of those within 2 % the one with fewest terms);
where the base's columns alone do better, nothing is named.
"""
import numpy as np
import pysindy as ps
from scipy.signal import savgol_filter

import machines_data
from machines_data import BASE

WINDOW_S, LEAST_WINDOW = 0.041, 7
HALF_S, LEAST_HALF = 0.04, 6
TUNED = 0.05
THRESHOLDS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
WITHIN = 1.02
# Longest trajectory that is handed over, in samples, and how often a subdomain covers each sample.
LONGEST = 2000
COVERED = 2.4


class Regression:
    """Weak features of one machine, fitted and held out."""

    def __init__(self, machine):
        self.h = float(np.median([p.h for p in machine.fit]))
        window = max(LEAST_WINDOW, round(WINDOW_S / self.h)) | 1
        self.half = max(LEAST_HALF, round(HALF_S / self.h))
        least = max(window, 3 * self.half)
        parts = [[p for p in pieces if len(p.t) >= least] for pieces in (machine.fit, machine.held)]
        self.refused = not all(parts)
        if self.refused:
            return
        speeds = np.concatenate([np.abs(savgol_filter(p.x, window, 3, deriv=1, delta=p.h)) for p in parts[0]])
        v95 = np.quantile(speeds, 0.95)
        table = machines_data.columns(machine, v95)
        # The drive is a column of the acceleration.
        self.table = [table[0], (BASE, lambda x, v, u, t: u, None)] + table[1:]
        self.names = [name for name, *_ in self.table]
        still = 0.02 * v95
        tracks = [[self.track(p, window, still) for p in pieces] for pieces in parts]
        self.unit = np.sqrt(np.mean(np.concatenate([a for *_, a in tracks[0]]) ** 2))
        self.scale = np.sqrt(np.mean(np.concatenate([c for _, c, _ in tracks[0]]) ** 2, axis=0))
        self.scale[self.scale == 0.0] = 1.0
        self.scale[[i for i, name in enumerate(self.names[1:]) if name == BASE]] *= 30.0
        length = min(LONGEST, min(len(v) for v, *_ in tracks[0]), min(len(v) for v, *_ in tracks[1]))
        self.length = max(length, least)
        self.fitted, self.held = (self.features(part) for part in tracks)

    def track(self, piece, window, still):
        x = savgol_filter(piece.x, window, 3)
        v = savgol_filter(piece.x, window, 3, deriv=1, delta=piece.h)
        a = savgol_filter(v, window, 3, deriv=1, delta=piece.h)
        moving = np.abs(v) > still
        columns = np.column_stack([f(x, v, piece.u, piece.t) * moving for _, f, _ in self.table[1:]])
        return v, columns, a

    def features(self, tracks):
        """The weak form's matrix and right side."""
        np.random.seed(1)
        states, controls = [], []
        for v, columns, _ in tracks:
            for i in range(0, len(v) - self.length + 1, self.length):
                states.append(v[i:i + self.length, None] / self.unit)
                controls.append(columns[i:i + self.length] / self.scale)
        count = max(5, round(COVERED * self.length / (2 * self.half)))
        weak = ps.WeakPDELibrary(function_library=ps.IdentityLibrary(), spatiotemporal_grid=np.arange(self.length) * self.h,
                                 K=count, H_xt=self.half * self.h)
        kept = {}
        optimizer = ps.STLSQ(threshold=0.0, alpha=1e-12)
        inner = optimizer.fit

        def keep(x, y):
            kept["both"] = (x, y)
            return inner(x, y)

        optimizer.fit = keep
        ps.SINDy(feature_library=weak, optimizer=optimizer).fit(states, t=self.h, u=controls)
        return kept["both"]

    def solve(self, threshold):
        """Coefficients, and the held-out residual over the acceleration."""
        optimizer = ps.STLSQ(threshold=threshold, alpha=1e-12, max_iter=40)
        optimizer.fit(*self.fitted)
        coefficients = np.ravel(optimizer.coef_)
        return coefficients, self.error(coefficients)

    def error(self, coefficients):
        """The held-out residual over the acceleration."""
        features, right = np.asarray(self.held[0]), np.ravel(self.held[1])
        return np.sqrt(np.mean((right - features @ coefficients) ** 2) / np.mean(right ** 2))

    def base(self):
        """Coefficients of the base's columns alone, and the held-out residual."""
        chosen = [i for i, name in enumerate(self.names) if name == BASE]
        coefficients = np.zeros(len(self.names))
        features, right = np.asarray(self.fitted[0]), np.ravel(self.fitted[1])
        coefficients[chosen] = np.linalg.lstsq(features[:, chosen], right, rcond=None)[0]
        return coefficients, self.error(coefficients)

    def named(self, coefficients):
        """Effects whose terms survived, the one with the largest joint share first."""
        features = np.asarray(self.fitted[0])
        shares = {}
        for effect in dict.fromkeys(self.names):
            chosen = [i for i, name in enumerate(self.names) if name == effect and coefficients[i] != 0.0]
            if effect != BASE and chosen:
                shares[effect] = np.sqrt(np.mean((features[:, chosen] @ coefficients[chosen]) ** 2))
        return sorted(shares, key=shares.get, reverse=True)


def discover(machine, thresholds):
    """Verdict, names, residual of the acceleration of the base's columns alone and of the model."""
    regression = Regression(machine)
    if regression.refused:
        return "refused", [], None, None
    base = regression.base()
    tried = [regression.solve(threshold) for threshold in thresholds] + ([base] if len(thresholds) > 1 else [])
    best = min(error for _, error in tried)
    near = [entry for entry in tried if entry[1] <= WITHIN * best]
    coefficients, after = min(near, key=lambda entry: np.count_nonzero(entry[0]))
    names = regression.named(coefficients)
    verdict = "partly_explained" if names else "nothing_missing" if after < 0.1 else "unknown"
    return verdict, names, base[1], after
