"""Sine fits against scipy's curve_fit and IEEE 1057's four-parameter fit.

sine.py FOLDER make    draws the records
sine.py FOLDER table   fits them by the peers, and makes the table with ours (FOLDER/sine_ours.csv)

A record: A = 1, random phase and dc, white noise; the methods are told an estimate of the frequency that is off by up to
±5 %. The peers are also run from the interpolated peak of the record's spectrum, as their users would where they have no
estimate.
"""
import csv
import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import OptimizeWarning, curve_fit
import warnings

CYCLES = [(2.3, 50), (5.4, 100), (20.7, 40)]
SNR_DB = [10.0, 20.0, 40.0]
RUNS = 100
REPEATS = 3
# Further off than this many bounds, a fit has found something else.
LOST = 10.0


def make(folder):
    rng = np.random.default_rng(1057)
    samples, rows = [], []
    for cycles, per_cycle in CYCLES:
        for snr in SNR_DB:
            sigma = np.sqrt(0.5 * 10 ** (-snr / 10))
            for _ in range(RUNS):
                n, ts, omega = int(round(cycles * per_cycle)), 1e-3, 2 * np.pi / (per_cycle * 1e-3)
                phase, dc = rng.uniform(-np.pi, np.pi), rng.uniform(-0.3, 0.3)
                t = np.arange(n) * ts
                samples.append(np.sin(omega * t + phase) + dc + sigma * rng.standard_normal(n))
                rows.append([n, ts, omega * rng.uniform(0.95, 1.05), omega, phase, sigma, cycles, per_cycle, snr])
    np.concatenate(samples).tofile(folder / "sine.bin")
    with (folder / "sine.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["samples", "ts_s", "estimate_rad_s", "omega_rad_s", "phase_rad", "sigma", "cycles", "per_cycle", "snr"])
        writer.writerows(rows)


def bound(n, ts, omega, phase, sigma):
    """Cramér-Rao bounds of ω and A, from the Fisher information of (A, ω, θ, d)."""
    t = np.arange(n) * ts
    s, c = np.sin(omega * t + phase), np.cos(omega * t + phase)
    slopes = np.column_stack([s, t * c, c, np.ones(n)])
    covariance = sigma ** 2 * np.linalg.inv(slopes.T @ slopes)
    return np.sqrt(covariance[1, 1]), np.sqrt(covariance[0, 0])


def spectral_peak(y, ts):
    """Peak of the Hann-windowed spectrum, interpolated."""
    n = len(y)
    power = np.abs(np.fft.rfft((y - y.mean()) * np.hanning(n)))
    k = 1 + int(np.argmax(power[1:-1]))
    a, b, c = np.log(power[k - 1:k + 2])
    return 2 * np.pi * (k + 0.5 * (a - c) / (a - 2 * b + c)) / (n * ts)


def three_parameters(y, t, omega):
    columns = np.column_stack([np.cos(omega * t), np.sin(omega * t), np.ones_like(t)])
    return np.linalg.lstsq(columns, y, rcond=None)[0]


def ieee_1057(y, t, omega):
    """IEEE 1057, the four-parameter fit: the linear fit with a column for the change of the frequency."""
    a, b, _ = three_parameters(y, t, omega)
    for _ in range(30):
        s, c = np.sin(omega * t), np.cos(omega * t)
        columns = np.column_stack([c, s, np.ones_like(t), t * (b * c - a * s)])
        a, b, _, change = np.linalg.lstsq(columns, y, rcond=None)[0]
        omega += change
        if abs(change) < 1e-12 * abs(omega):
            break
    a, b, _ = three_parameters(y, t, omega)
    return omega, np.hypot(a, b)


def wave(t, amplitude, omega, phase, dc):
    return amplitude * np.sin(omega * t + phase) + dc


def scipy_fit(y, t, omega):
    a, b, dc = three_parameters(y, t, omega)
    try:
        p, _ = curve_fit(wave, t, y, p0=[np.hypot(a, b), omega, np.arctan2(a, b), dc])
    except RuntimeError:
        return np.nan, np.nan
    return p[1], abs(p[0])


METHODS = [
    ("scipy `curve_fit`, from the estimate", scipy_fit, False),
    ("scipy `curve_fit`, from the spectrum", scipy_fit, True),
    ("IEEE 1057, from the estimate", ieee_1057, False),
    ("IEEE 1057, from the spectrum", ieee_1057, True),
]
OURS = [("batch", "Breakaway, batch"), ("streaming f32", "Breakaway, streaming, f32, 32 blocks")]


def main():
    folder, what = Path(sys.argv[1]), sys.argv[2]
    folder.mkdir(parents=True, exist_ok=True)
    if what == "make":
        return make(folder)
    warnings.simplefilter("ignore", OptimizeWarning)
    np.seterr(all="ignore")
    y_all, at = np.fromfile(folder / "sine.bin"), 0
    with (folder / "sine.csv").open() as file:
        records = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    results = {name: [] for name, *_ in METHODS}
    for r in records:
        n, ts = int(r["samples"]), r["ts_s"]
        y, t = y_all[at:at + n], np.arange(n) * ts
        at += n
        for name, method, spectrum in METHODS:
            times = []
            for _ in range(REPEATS):
                start = time.perf_counter()
                omega, amplitude = method(y, t, spectral_peak(y, ts) if spectrum else r["estimate_rad_s"])
                times.append(time.perf_counter() - start)
            results[name].append((omega, amplitude, np.median(times)))
    titles = dict(OURS)
    with (folder / "sine_ours.csv").open() as file:
        for row in csv.DictReader(file):
            results.setdefault(titles[row["method"]], []).append(
                (float(row["omega_rad_s"]), float(row["amplitude"]), float(row["seconds"])))
    text = table(records, results)
    (folder / "sine.md").write_text(text)
    print(text)


def table(records, results):
    bounds = np.array([bound(int(r["samples"]), r["ts_s"], r["omega_rad_s"], r["phase_rad"], r["sigma"]) for r in records])
    omega = np.array([r["omega_rad_s"] for r in records])
    cells = [(c, s) for c, _ in CYCLES for s in SNR_DB]
    head = ["fit"] + [f"{c:g} cycles, {s:g} dB" for c, s in cells] + ["lost", "µs per fit", "time over ours"]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    ours = np.median([r[2] for r in results[OURS[0][1]]])
    for name, rows in results.items():
        found = np.array(rows)
        errors = np.column_stack([found[:, 0] - omega, found[:, 1] - 1.0]) / bounds
        good = np.abs(errors[:, 0]) < LOST
        row = [name]
        for c, s in cells:
            here = good & np.array([r["cycles"] == c and r["snr"] == s for r in records])
            row.append(", ".join(f"{here.sum() / np.sum(errors[here, k] ** 2):.2f}" for k in (0, 1)) if here.any() else "–")
        seconds = np.median(found[:, 2])
        row += [f"{(~good).sum()} of {len(good)}", f"{1e6 * seconds:.0f}", f"{seconds / ours:.1f}"]
        lines.append("| " + " | ".join(row) + " |")
    return "\n".join(lines) + "\n"


main()
