"""Discovery against PySINDy on blind cases of the hidden plant.

discovery.py HIDDEN FOLDER tune   chooses thresholds and windows on the tuning seeds
discovery.py HIDDEN FOLDER run    the test seeds, a row per case and method, into FOLDER/sindy.csv (goes on where it stopped)
discovery.py HIDDEN FOLDER table  the tables, from FOLDER/sindy.csv and FOLDER/ours.csv
"""
import csv
import json
import sys
import time
from pathlib import Path

import discovery_table
import library
import records
import sparse

# (seed, size in %): never used below.
TUNING = [(601, 10.0), (602, 3.0)]
TEST_SEEDS = range(891, 893)
TEST_SIZES = (10.0, 3.0)
CLEAN_SEEDS = range(1901, 1913)
THRESHOLDS = (0.01, 0.02, 0.05, 0.1)
WINDOWS = (21, 41)
HALVES_S = (0.04, 0.1)
# Beside the tuned ones: what a user gets who would rather have a false name than none.
LOW = f"weak form, threshold {min(THRESHOLDS)}"
HEADER = ["hidden", "size_percent", "seed", "method", "named", "held_out_rad", "own_rad", "seconds"]


def grid(method):
    """Every combination that is tried."""
    halves = HALVES_S if method == "weak form" else (0.0,)
    return [sparse.Settings(w, t, h) for w in WINDOWS for h in halves for t in THRESHOLDS]


def tune(program, folder):
    """The most right names (strongest term) per hidden effect less the false names per clean case."""
    points = {method: [[0.0, s] for s in grid(method)] for method in sparse.METHODS}
    for seed, size in TUNING:
        told = library.nonlinear({e: records.truth_of(program, folder, e, size, seed) for e in library.TOLD})
        for effect in records.EXPRESSIBLE + ["none"]:
            case = records.make(program, folder, effect, size, seed)
            regressions = {w: sparse.Regression(case, told, w) for w in WINDOWS}
            for method, list_ in points.items():
                for entry in list_:
                    regression = regressions[entry[1].window]
                    named = regression.names_found(regression.fit(method, entry[1])[1])
                    if effect == "none":
                        entry[0] -= len(named) / len(TUNING)
                    else:
                        entry[0] += (named[:1] == [effect]) / (len(TUNING) * len(records.EXPRESSIBLE))
            print("tuned on", effect, size, seed, flush=True)
    chosen = {}
    for method, list_ in points.items():
        for score, settings in list_:
            print(f"{method}: {settings}: {score:.3f}")
        chosen[method] = vars(max(list_, key=lambda entry: entry[0])[1])
    chosen[LOW] = {**chosen["weak form"], "threshold": min(THRESHOLDS)}
    (folder / "chosen.json").write_text(json.dumps(chosen, indent=1))
    print(chosen)


def cases():
    """(seed, size, effects) of the test."""
    for size in TEST_SIZES:
        for seed in TEST_SEEDS:
            yield seed, size, records.EXPRESSIBLE + records.HIDDEN_STATE
    for seed in CLEAN_SEEDS:
        yield seed, 10.0, ["none"]


def run(program, folder):
    """Every test case by every method."""
    chosen = {m: sparse.Settings(**s) for m, s in json.loads((folder / "chosen.json").read_text()).items()}
    path = folder / "sindy.csv"
    done = set()
    if path.exists():
        with path.open() as file:
            done = {(r["hidden"], float(r["size_percent"]), int(r["seed"]), r["method"]) for r in csv.DictReader(file)}
    with path.open("a", newline="") as file:
        writer = csv.writer(file)
        if not done:
            writer.writerow(HEADER)
        for seed, size, effects in cases():
            todo = [e for e in effects if any((e, size, seed, m) not in done for m in chosen)]
            if not todo:
                continue
            told = library.nonlinear({e: records.truth_of(program, folder, e, size, seed) for e in library.TOLD})
            for effect in todo:
                case = records.make(program, folder, effect, size, seed)
                own = case.own_error()
                for method, settings in chosen.items():
                    if (effect, size, seed, method) in done:
                        continue
                    start = time.perf_counter()
                    regression = sparse.Regression(case, told, settings.window)
                    physical, scaled = regression.fit(method, settings)
                    named = regression.names_found(scaled)
                    seconds = time.perf_counter() - start
                    error = regression.held_out(case, physical, settings.window)
                    writer.writerow([effect, size, seed, method, "+".join(named), error, own, seconds])
                file.flush()
                print(effect, size, seed, flush=True)


def main():
    program, folder, what = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
    folder.mkdir(parents=True, exist_ok=True)
    sparse.quiet()
    if what == "table":
        text = discovery_table.markdown(folder)
        (folder / "discovery.md").write_text(text)
        print(text)
    else:
        {"tune": tune, "run": run}[what](program, folder)


main()
