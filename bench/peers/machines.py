"""PySINDy and ten minutes of least squares on the real machines.

machines.py FOLDER    reads FOLDER/machines (written by the example `machines --export`), writes a file of rows per method into
                      FOLDER, which the example scores by the rule of docs/machines.md (`--compare`)
"""
import csv
import sys
import time
from pathlib import Path

import machines_data
import machines_least_squares
import machines_sindy
import sparse

# The columns of docs/machines.csv.
HEADER = ["machine", "split", "commit", "verdict", "named", "parameters", "force_before", "force_after", "open_loop_before",
          "open_loop_after", "drive_free", "noise", "unit", "seconds", "note"]
METHODS = {
    "least_squares": lambda machine: machines_least_squares.discover(machine, machines_least_squares.USUAL_FALL),
    "least_squares_best": lambda machine: machines_least_squares.discover(machine, machines_least_squares.BEST_FALL),
    "sindy": lambda machine: machines_sindy.discover(machine, [machines_sindy.TUNED]),
    "sindy_held_out": lambda machine: machines_sindy.discover(machine, machines_sindy.THRESHOLDS),
}


def main():
    folder = Path(sys.argv[1])
    sparse.quiet()
    machines = machines_data.load(folder / "machines")
    for method, discover in METHODS.items():
        with (folder / f"machines_{method}.csv").open("w", newline="") as file:
            rows = csv.DictWriter(file, HEADER, restval="")
            rows.writeheader()
            for machine in machines:
                start = time.perf_counter()
                verdict, names, before, after = discover(machine)
                seconds = time.perf_counter() - start
                row = {"machine": machine.name, "split": "all", "verdict": verdict, "named": "+".join(names),
                       "unit": machine.unit, "seconds": round(seconds, 2)}
                # The residual of PySINDy is one of acceleration, not of force.
                if before is not None and method.startswith("least_squares"):
                    row |= {"force_before": f"{before:.4g}", "force_after": f"{after:.4g}"}
                rows.writerow(row)
                shown = "" if before is None else f"{100 * before:.1f} -> {100 * after:.1f} %"
                print(f"{method:18} {machine.name:11} {verdict:17} {'+'.join(names)} {shown} {seconds:.1f} s", flush=True)


main()
