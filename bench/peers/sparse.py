"""PySINDy on one case: STLSQ, its ensemble and the weak form, all on the same columns.

The model is v' = Σ coefficient·column. State: the velocity of the smoothed position, in units in which v' has an RMS of 1;
every column is scaled to an RMS of 1 too, so that a threshold is the share of the acceleration that a term must make; the base's own columns are smaller, so that none is ever thresholded.
Columns enter as control inputs, computed beforehand. The drive at a sample is the mean of the holds before and after it (what
a central derivative sees). Samples at rest (below three times the velocity's noise) have no drive, so that a held
body is no contradiction to the formula.
"""
import warnings
from dataclasses import dataclass

import numpy as np
import pysindy as ps
from scipy.signal import savgol_filter

import library
from records import TS

# Every fit recording of the suite is a multiple of this long.
PIECE = 2000
# Subdomains per piece of the weak form.
SUBDOMAINS = 60
METHODS = ("STLSQ", "ensemble", "weak form")


@dataclass
class Settings:
    """What is tuned: the smoothing window (samples), the threshold, and half the weak form's subdomain (s)."""
    window: int
    threshold: float
    half_s: float = 0.0


def velocity(x, window):
    """Smoothed position and its derivative by PySINDy's smoothed finite difference (Savitzky-Golay, cubic)."""
    smooth = ps.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 3})
    rate = smooth._differentiate(x[:, None], TS)[:, 0]
    return savgol_filter(x, window, 3), rate


class Regression:
    """Columns and target of one case at one smoothing window."""

    def __init__(self, case, known, window):
        tracks = []
        for r in case.fit:
            x, v = velocity(r.x, window)
            _, a = velocity(v, window)
            u = 0.5 * (r.u + np.concatenate(([r.u[0]], r.u[:-1])))
            tracks.append((x, v, u, r.t, a))
        noise = np.median([np.std(np.diff(r.x, 3)) / np.sqrt(20.0) for r in case.fit])
        # Variance of the slope of a cubic smoother, about that of a line over 2/3 of its length.
        still = 3.0 * noise * np.sqrt(12.0 / (0.67 * window) ** 3) / TS
        self.table = library.columns(known, case.fit[-1].t[-1])
        self.features = {}
        self.names = [name for name, _ in self.table]
        self.unit = np.sqrt(np.mean(np.concatenate([a for *_, a in tracks]) ** 2))
        raw = []
        for x, v, u, t, _ in tracks:
            moving = np.abs(v) > still
            raw.append(np.column_stack([f(x, v, u, t) * moving for _, f in self.table[1:]]))
        self.scale = np.sqrt(np.mean(np.concatenate(raw) ** 2, axis=0))
        self.scale[self.scale == 0.0] = 1.0
        # Small columns have large coefficients, which no threshold takes: u and sgn v stay (and v, whose coefficient is c/b).
        self.scale[[i for i, name in enumerate(self.names[1:]) if name == library.BASE]] *= 30.0
        self.columns = [c / self.scale for c in raw]
        self.v = [v[:, None] / self.unit for _, v, *_ in tracks]
        self.a = [a[:, None] / self.unit for *_, a in tracks]

    def pieces(self, tracks):
        return [t[i:i + PIECE] for t in tracks for i in range(0, len(t) - PIECE + 1, PIECE)]

    def optimizer(self, method, settings):
        stlsq = ps.STLSQ(threshold=settings.threshold, alpha=1e-12, max_iter=40)
        if method == "ensemble":
            return ps.EnsembleOptimizer(stlsq, bagging=True, n_models=20, n_subset=8000)
        return stlsq

    def fit(self, method, settings):
        """Coefficients in physical units (acceleration per column), and the share of each column in the acceleration."""
        np.random.seed(1)
        optimizer = self.optimizer(method, settings)
        key = (method.startswith("weak form"), settings.half_s)
        if key in self.features:
            # Another threshold on the same features, which PySINDy would only compute again.
            optimizer.fit(*self.features[key])
            scaled = np.ravel(optimizer.coef_)
        else:
            inner = optimizer.fit

            def keep(x, y):
                self.features[key] = (x, y)
                return inner(x, y)

            optimizer.fit = keep
            if key[0]:
                weak = ps.WeakPDELibrary(function_library=ps.IdentityLibrary(), spatiotemporal_grid=np.arange(PIECE) * TS,
                                         K=SUBDOMAINS, H_xt=settings.half_s)
                model = ps.SINDy(feature_library=weak, optimizer=optimizer)
                model.fit(self.pieces(self.v), t=TS, u=self.pieces(self.columns))
            else:
                model = ps.SINDy(feature_library=ps.IdentityLibrary(), optimizer=optimizer)
                model.fit(self.v, t=TS, x_dot=self.a, u=self.columns)
            scaled = model.coefficients()[0]
        return np.concatenate((scaled[:1], scaled[1:] / self.scale * self.unit)), scaled

    def names_found(self, scaled):
        """Effects whose terms survived, the one with the largest joint share of the acceleration first."""
        shares = {}
        for effect in set(self.names) - {library.BASE}:
            chosen = [i - 1 for i, name in enumerate(self.names) if name == effect and scaled[i] != 0.0]
            if chosen:
                joint = np.concatenate([c[:, chosen] for c in self.columns]) @ scaled[[i + 1 for i in chosen]]
                shares[effect] = np.sqrt(np.mean(joint ** 2))
        return sorted(shares, key=shares.get, reverse=True)

    def held_out(self, case, coefficients, window):
        """RMS error (rad) of the simulated formula over held-out segments of 0.4 s, initial states fitted."""
        length, substeps = 400, 4
        chosen = [i for i, c in enumerate(coefficients) if c != 0.0]
        starts, u, t, x = [], [], [], []
        for r in case.score:
            smooth, v = velocity(r.x, window)
            for i in range(0, len(r.x) - length + 1, length):
                starts.append((smooth[i], v[i]))
                u.append(r.u[i:i + length])
                t.append(r.t[i:i + length])
                x.append(r.x[i:i + length])
        u, t, x = np.array(u).T, np.array(t).T, np.array(x).T
        state = np.array(starts).T.copy()

        def run(state):
            position, v = state[0].copy(), state[1].copy()
            path = np.empty_like(x)
            for k in range(length):
                path[k] = position
                for j in range(substeps):
                    now = t[k] + j * TS / substeps
                    a = sum(coefficients[i] * self.table[i][1](position, v, u[k], now) for i in chosen)
                    v = v + a * TS / substeps
                    position = position + v * TS / substeps
            return path

        # Gauss-Newton on the two initial values of every segment; a formula may run away.
        best = np.full(x.shape[1], np.inf)
        for _ in range(3):
            path = run(state)
            error = np.mean((path - x) ** 2, axis=0)
            best = np.fmin(best, error)
            steps = 1e-4 * np.maximum(np.abs(x - x[0]).max(axis=0), 1e-3), 1e-3 * np.maximum(np.abs(state[1]), 0.1)
            slopes = []
            for row in (0, 1):
                moved = state.copy()
                moved[row] += steps[row]
                slopes.append((run(moved) - path) / steps[row])
            p, q, r = slopes[0], slopes[1], x - path
            pp, pq, qq = (p * p).sum(0), (p * q).sum(0), (q * q).sum(0)
            pr, qr = (p * r).sum(0), (q * r).sum(0)
            det = pp * qq - pq * pq
            with np.errstate(all="ignore"):
                step = np.array([(qq * pr - pq * qr) / det, (pp * qr - pq * pr) / det])
            good = np.isfinite(step).all(axis=0)
            state[:, good] += step[:, good]
        best = np.fmin(best, np.mean((run(state) - x) ** 2, axis=0))
        return np.sqrt(np.mean(best))


def quiet():
    """PySINDy and scikit-learn warn of what is expected here: thresholds that leave nothing, iterations that end."""
    warnings.filterwarnings("ignore")
    np.seterr(over="ignore", invalid="ignore")
