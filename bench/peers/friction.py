"""Friction identification against least squares on filtered derivatives, on relay experiments of the hidden plant.

friction.py FOLDER    reads friction.csv, friction.bin (recordings) and friction_ours.csv, writes FOLDER/friction.md

The peer: zero-phase Butterworth (second order, `filtfilt`), `gradient` twice, `lstsq` of u on [a, v, sgn v] over the samples
above 5 % of the largest speed. Plain: the drive as it is. Matched: drive and sgn v through the same filter, which removes the
filter's bias. The cut-off is the best of five for the first ten seeds, which are not in the table.
"""
import csv
import sys
import time
from pathlib import Path

import numpy as np
from scipy.signal import butter, filtfilt

TS = 1e-3
CUTOFFS_HZ = [10.0, 20.0, 40.0, 80.0, 160.0]
TUNING = 10


def least_squares(records, cutoff, matched):
    rows, right = [], []
    b, a = butter(2, cutoff * 2 * TS)
    for u, x in records:
        x = filtfilt(b, a, x)
        v = np.gradient(x, TS)
        acceleration = np.gradient(v, TS)
        # The drive is held: a central derivative sees the mean of the holds on both sides.
        u = 0.5 * (u + np.concatenate(([u[0]], u[:-1])))
        sign = np.sign(v)
        moving = np.abs(v) > 0.05 * np.abs(v).max()
        if matched:
            u, sign = filtfilt(b, a, u), filtfilt(b, a, sign)
        rows.append(np.column_stack([acceleration, v, sign])[moving])
        right.append(u[moving])
    return np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]


def main():
    folder = Path(sys.argv[1])
    numbers, at = np.fromfile(folder / "friction.bin"), 0
    cases = []
    with (folder / "friction.csv").open() as file:
        for row in csv.DictReader(file):
            records = []
            for key in ("samples_1", "samples_2"):
                n = int(row[key])
                records.append((numbers[at:at + n], numbers[at + n:at + 2 * n]))
                at += 2 * n
            cases.append((int(row["seed"]), records, np.array([float(row[k]) for k in ("b", "c", "f1")])))
    seeds = [seed for seed, *_ in cases[TUNING:]]
    errors, seconds = {}, {}
    for matched in (False, True):
        def off(case, cutoff):
            return least_squares(case[1], cutoff, matched) / case[2] - 1.0

        costs = [np.median([np.abs(off(c, f)).max() for c in cases[:TUNING]]) for f in CUTOFFS_HZ]
        cutoff = CUTOFFS_HZ[int(np.argmin(costs))]
        name = f"least squares, {'matched' if matched else 'plain'}, {cutoff:g} Hz"
        start = time.perf_counter()
        errors[name] = {case[0]: off(case, cutoff) for case in cases[TUNING:]}
        seconds[name] = (time.perf_counter() - start) / len(seeds)
    truth = {seed: parameters for seed, _, parameters in cases}
    times = {}
    with (folder / "friction_ours.csv").open() as file:
        for row in csv.DictReader(file):
            seed = int(row["seed"])
            if seed in seeds:
                found = np.array([float(row[k]) for k in ("b", "c", "f1")])
                errors.setdefault(row["estimator"], {})[seed] = found / truth[seed] - 1.0
                times.setdefault(row["estimator"], []).append(float(row["seconds"]))
    titles = {"equation 17": "the paper's equation 17, as printed", "memo listing": "the memo's listing, as printed",
              "corrected formulas": "the describing function's formulas, corrected",
              "describing_function": "Breakaway, describing function", "modulating": "Breakaway, modulating functions (the streaming one)",
              "weak_form": "Breakaway, weak form", "output_error": "Breakaway, output error", "best": "Breakaway, what `identify` answers"}
    lines = ["| estimator | b, % (median, RMS) | c, % | f1, % | answered | time |", "|---|---|---|---|---|---|"]
    order = [k for k in errors if k.startswith("least")] + [k for k in titles if k in errors]
    for key in order:
        found = 100 * np.array(list(errors[key].values()))
        cells = [f"{np.median(np.abs(found[:, k])):.2f}, {np.sqrt(np.mean(found[:, k] ** 2)):.2f}" for k in range(3)]
        spent = seconds.get(key) or (np.median(times[key]) if key == "best" else None)
        lines.append(f"| {titles.get(key, key)} | " + " | ".join(cells) + f" | {len(found)} of {len(seeds)} | "
                     + (f"{1e3 * spent:.0f} ms" if spent else "") + " |")
    text = "\n".join(lines) + "\n"
    (folder / "friction.md").write_text(text)
    print(text)


main()
