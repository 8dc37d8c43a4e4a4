#!/usr/bin/env python3
"""Discover what the models of many machines miss, on a Dask cluster, into one Parquet file.

    fleet.py MACHINES -o OUT [--scheduler ADDRESS | --scheduler-file FILE] [-- OPTIONS OF breakaway discover]

MACHINES holds one folder per machine: fit/*.csv and score/*.csv as `breakaway run suite` writes them, or *.csv, and
base.toml or model.toml if there is a model to start from. MACHINES and OUT must be seen by all workers under the same
path, and the package `breakaway` must be installed on each of them. Without a scheduler the workers are this computer's
cores.

Each machine is one task: `breakaway.discover`, one thread. Its worker writes OUT/MACHINE/ (improved.toml,
report.html, result.json); when all are done, OUT/fleet.parquet has one row per machine. A machine whose result is there,
from the same files, program and options, is not worked on again. What goes wrong with a machine is its row.
"""

import argparse
import hashlib
import json
import os
import sys
import uuid
from pathlib import Path

import breakaway as bk
import pyarrow as pa
import pyarrow.parquet as pq
from distributed import Client, as_completed, get_worker

SCHEMA = pa.schema(
    [
        ("machine", pa.string()),
        ("verdict", pa.string()),
        ("sentence", pa.string()),
        ("effects", pa.list_(pa.string())),
        ("tied", pa.list_(pa.string())),
        ("shrink", pa.float64()),
        ("noise_factor", pa.float64()),
        ("noise_floor", pa.float64()),
        ("b", pa.float64()),
        ("c", pa.float64()),
        ("f1", pa.float64()),
        ("seconds", pa.float64()),
        ("worker", pa.string()),
        ("skipped", pa.bool_()),
        ("reason", pa.string()),
        ("result", pa.string()),
    ]
)


def inputs(folder):
    """The files of a machine, as `breakaway discover --fleet` takes them."""
    fit, score = (sorted((folder / part).glob("*.csv")) for part in ("fit", "score"))
    if score and not fit:
        raise ValueError(f"recordings to score but none to fit: {folder} has score/*.csv and needs fit/*.csv too")
    fit = fit or sorted(folder.glob("*.csv"))
    if not fit:
        raise ValueError(f"no recordings: {folder} needs fit/*.csv (and score/*.csv), or *.csv")
    models = [path for path in (folder / "base.toml", folder / "model.toml") if path.exists()]
    if len(models) > 1:
        raise ValueError(f"{folder} has base.toml and model.toml; keep the one to start from")
    return fit, score, models


def made_of(folder, files, version, options):
    """What decides a result: the content of the files, the program, its options."""
    digests = {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
    return {"version": version, "options": options, "inputs": digests}


def write_whole(path, data):
    """Beside its place, then renamed: a reader sees the old file or the new one, never a part."""
    beside = path.with_name(f".fleet-{uuid.uuid4().hex}")
    try:
        with open(beside, "xb") as out:
            out.write(data)
            out.flush()
            os.fsync(out.fileno())
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def reading():
    """The options of `breakaway discover` that may come after `--`: columns and rows, and a model to start from."""
    parser = argparse.ArgumentParser(prog="fleet.py … --", add_help=False, allow_abbrev=False)
    for flag in ("--time", "--time-unit", "--input", "--position", "--current", "--wrap", "--model"):
        parser.add_argument(flag)
    for flag in ("--fs", "--encoder-step", "--counts-per-turn"):
        parser.add_argument(flag, type=float)
    parser.add_argument("--where", action="append")
    parser.add_argument("--from", dest="from_s", type=float)
    parser.add_argument("--to", dest="to_s", type=float)
    return parser


def discover(folder, out, options):
    """One machine, on a worker: its row. Never raises: a reason is a row too."""
    folder, place = Path(folder), Path(out) / Path(folder).name
    row = {"machine": folder.name, "worker": worker(), "skipped": False}
    try:
        fit, score, models = inputs(folder)
        source = made_of(folder, fit + score + models, f"breakaway {bk.__version__}", options)
        result = place / "result.json"
        kept = read(result)
        if kept is not None and kept.get("fleet") == source:
            return row | summary(kept) | {"skipped": True}
        place.mkdir(parents=True, exist_ok=True)
        # Of other files, if they are there at all.
        for old in ("result.json", "improved.toml", "report.html"):
            (place / old).unlink(missing_ok=True)
        write_whole(place / "started.json", json.dumps({"worker": row["worker"], "pid": os.getpid()}).encode())
        given = vars(reading().parse_args(options))
        start = given.pop("model")
        # The workers share the cores already.
        found = bk.discover(fit, holdout=score, model=models[0] if models else start, threads=1, **given)
        found.model.write(place / "improved.toml")
        found.write_report(place / "report.html")
        document = found.document | {"fleet": source}
        write_whole(result, (json.dumps(document, indent=2) + "\n").encode())
        return row | summary(document)
    except (OSError, ValueError, bk.Error) as error:
        return row | {"reason": str(error)}
    finally:
        (place / "started.json").unlink(missing_ok=True)


def worker():
    try:
        return str(get_worker().name)
    except ValueError:
        return ""


def read(path):
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        return None


def summary(document):
    """The row of a result: the same quantities as in the table of `breakaway discover --fleet`."""
    ladder, noise = document["ladder"], document["noise_floor"]

    def ratio(above, below):
        return above / below if above is not None and below else None

    rivals = [rival["name"] for effect in document["effects"] for rival in effect["rivals"] if rival["tied"]]
    ends = (ladder[0], ladder[-1]) if ladder else ({}, {})
    return {
        "verdict": document["verdict"],
        "sentence": document["sentence"],
        "effects": [effect["name"] for effect in document["effects"]],
        "tied": rivals,
        "shrink": ratio(*(end.get("holdout_open_loop_rmse") for end in ends)),
        "noise_factor": ratio(ends[1].get("holdout_rmse"), noise),
        "noise_floor": noise,
        **{symbol: document["base"].get(symbol, {}).get("value") for symbol in ("b", "c", "f1")},
        "seconds": document["seconds"],
        "result": json.dumps(document),
    }


def cluster(args):
    """The cluster that was named, or the cores of this computer."""
    if args.scheduler_file:
        return Client(scheduler_file=args.scheduler_file)
    if args.scheduler:
        return Client(args.scheduler)
    return Client(threads_per_worker=1, dashboard_address=None)


def run(client, machines, out, options):
    """The rows of all machines, by name."""
    tasks = {
        # Not pure: a scheduler that is up for weeks must not answer with what it still knows of older files.
        client.submit(discover, str(folder), str(out), options, pure=False): folder.name
        for folder in machines
    }
    rows = []
    for future in as_completed(tasks):
        # What `discover` cannot return itself: its workers died under it, or the program is wrong.
        error = future.exception()
        lost = {"machine": tasks[future], "skipped": False, "reason": repr(error)}
        rows.append(future.result() if error is None else lost)
        print(f"{len(rows)}/{len(tasks)} {tasks[future]}", file=sys.stderr, flush=True)
    return sorted(rows, key=lambda row: row["machine"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("machines", type=Path, help="folder with one folder per machine")
    parser.add_argument("-o", "--out", type=Path, required=True, help="folder for results and fleet.parquet")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--scheduler", help="address of a Dask scheduler, such as tcp://10.0.0.5:8786")
    where.add_argument("--scheduler-file", help="the file that `dask scheduler --scheduler-file` wrote")
    parser.usage = parser.format_usage().removeprefix("usage: ").rstrip() + " [-- options of breakaway discover]"
    ours, options = sys.argv[1:], []
    if "--" in ours:
        at = ours.index("--")
        ours, options = ours[:at], ours[at + 1 :]
    args = parser.parse_args(ours)
    reading().parse_args(options)
    if not args.machines.is_dir():
        parser.error(f"{args.machines} is not a folder")
    machines = sorted(path for path in args.machines.resolve().iterdir() if path.is_dir() and path.name[0] != ".")
    if not machines:
        parser.error(f"{args.machines} holds no machine: it needs one folder per machine")
    out = args.out.resolve()
    if args.machines.resolve() in (out, out.parent):
        parser.error(f"results in {args.out} would be taken for a machine of {args.machines}")
    out.mkdir(parents=True, exist_ok=True)
    with cluster(args) as client:
        rows = run(client, machines, out, options)
    sink = pa.BufferOutputStream()
    pq.write_table(pa.Table.from_pylist(rows, schema=SCHEMA), sink)
    write_whole(out / "fleet.parquet", sink.getvalue().to_pybytes())
    failed = [row for row in rows if row.get("reason")]
    for row in failed:
        print(f"{row['machine']}: failed: {row['reason']}", file=sys.stderr)
    skipped = sum(row["skipped"] for row in rows)
    print(f"{len(rows)} machines, {skipped} kept, {len(failed)} failed: {out / 'fleet.parquet'}")
    return 1 if len(failed) == len(rows) else 0


if __name__ == "__main__":
    sys.exit(main())
