"""The tables of the discovery bench, from the rows of PySINDy and of `cargo xtask blind`."""
import csv
import json
from dataclasses import dataclass

import numpy as np

from records import EXPRESSIBLE, HIDDEN_STATE

OURS = "Breakaway"


@dataclass
class Row:
    hidden: str
    size: float
    seed: int
    named: list
    over_truth: float
    seconds: float


def sindy(folder):
    """Rows of PySINDy by method."""
    methods = {}
    with (folder / "sindy.csv").open() as file:
        for r in csv.DictReader(file):
            named = r["named"].split("+") if r["named"] else []
            row = Row(r["hidden"], float(r["size_percent"]), int(r["seed"]), named,
                      float(r["held_out_rad"]) / float(r["own_rad"]), float(r["seconds"]))
            methods.setdefault(f"PySINDy, {r['method']}", []).append(row)
    return methods


def ours(folder):
    """Our rows, of the same cases."""
    rows = []
    with (folder / "ours.csv").open() as file:
        for r in csv.DictReader(file):
            named = r["named"].split("+") if r["named"] else []
            rows.append(Row(r["hidden"] or "none", float(r["size_percent"]), int(r["seed"]), named,
                            float(r["over_truth"]), float(r["seconds"])))
    return rows


def share(rows, test):
    good = sum(1 for r in rows if test(r))
    return f"{good} of {len(rows)} ({100 * good / len(rows):.0f} %)" if rows else "–"


def first(row):
    return row.named[:1] == [row.hidden]


def only(row):
    return row.named == [row.hidden]


def wrong(row):
    return any(name != row.hidden for name in row.named)


def number(values):
    """Median and 90 %; infinite where the formula ran away."""
    return f"{np.median(values):.2f}, {np.quantile(values, 0.9, method='higher'):.3g}" if len(values) else "–"


def markdown(folder):
    methods = {OURS: ours(folder), **sindy(folder)}
    cases = [{(r.hidden, r.size, r.seed) for r in rows} for rows in methods.values()]
    common = set.intersection(*cases)
    methods = {name: [r for r in rows if (r.hidden, r.size, r.seed) in common] for name, rows in methods.items()}
    chosen = json.loads((folder / "chosen.json").read_text())
    lines = [f"{len(common)} sessions, each by every method. " + " ".join(
        f"Tuned for {m}: smoothing over {s['window']} samples, threshold {s['threshold']}"
        + (f", subdomains of ±{1e3 * s['half_s']:.0f} ms" if s["half_s"] else "") + "." for m, s in chosen.items()), ""]
    lines += ["| | " + " | ".join(methods) + " |", "|---|" + "---|" * len(methods)]

    def line(title, cell):
        lines.append(f"| {title} | " + " | ".join(cell(rows) for rows in methods.values()) + " |")

    def among(names, size=None):
        return lambda rows: [r for r in rows if r.hidden in names and (size is None or r.size == size)]

    for size in (10.0, 3.0):
        here = among(EXPRESSIBLE, size)
        line(f"**laws in (x, v, u, t), {size:g} %**: strongest name right", lambda rows, here=here: share(here(rows), first))
        line("… and nothing else named", lambda rows, here=here: share(here(rows), only))
        line("… a wrong name among those given", lambda rows, here=here: share(here(rows), wrong))
        line("… held-out error over the truth's own (median, 90 %)",
             lambda rows, here=here: number([r.over_truth for r in here(rows)]))
    for size in (10.0, 3.0):
        here = among(HIDDEN_STATE, size)
        line(f"**laws with a state of their own, {size:g} %**: strongest name right",
             lambda rows, here=here: share(here(rows), first))
        line("… a wrong name among those given", lambda rows, here=here: share(here(rows), wrong))
        line("… held-out error over the truth's own (median, 90 %)",
             lambda rows, here=here: number([r.over_truth for r in here(rows)]))
    line("**clean**: something named", lambda rows: share(among(["none"])(rows), lambda r: bool(r.named)))
    line("… held-out error over the truth's own (median, 90 %)",
         lambda rows: number([r.over_truth for r in among(["none"])(rows)]))
    line("seconds (median)", lambda rows: f"{np.median([r.seconds for r in rows]):.2f}")

    lines += ["", "By effect, strongest name right of the cases at 10 % and at 3 %:", ""]
    lines += ["| hidden | " + " | ".join(methods) + " |", "|---|" + "---|" * len(methods)]
    for effect in EXPRESSIBLE + HIDDEN_STATE:
        cells = []
        for rows in methods.values():
            parts = [[r for r in rows if r.hidden == effect and r.size == size] for size in (10.0, 3.0)]
            cells.append(", ".join(f"{sum(map(first, part))}/{len(part)}" for part in parts))
        lines.append(f"| {effect} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
