"""Sessions of machines that MuJoCo simulates: `session.py FOLDER --seeds 1..5 [--scenarios Gravity,Drag]`.

A session is a folder `SCENARIO-SEED` of four recordings, and `truth.csv`: the names that are true of it, and its world.
Everything is drawn by the seed and the scenario's name: machine, drives, rate, clock, encoder, and a random torque. A row of a
recording holds the stamp, the drive that is asked for from then on, and the position.
"""

import argparse
import csv
import math
import multiprocessing
import pathlib
import random

import bodies
import drives
import laws
import mujoco
import pairs
from machine import SI, STEP_S, Machine

RECORDINGS = 4


def scenarios():
    """All of them, by name."""
    found = {"Plain": Machine}
    for module in (bodies, laws):
        own = {name: what for name, what in vars(module).items() if isinstance(what, type) and what is not Machine}
        found |= own
    return found | {what.__name__: what for what in pairs.PAIRS}


def drawn_world(draw):
    """What surrounds the machine."""
    rate = draw.choice([250, 400, 500, 1000, 1000, 2000])
    return {
        "rate_hz": rate,
        "counts": draw.choice([2048, 4096, 8192, 16384, 65536]),
        "torque_noise": math.exp(draw.uniform(math.log(5e-4), math.log(1e-2))),
        "torque_noise_hz": draw.uniform(10.0, 200.0),
        "jitter": draw.choice([0.0, 0.0, 0.02, 0.1]),
        "stamps_are_nominal": draw.random() < 0.5,
        "runs_on": draw.random() < 0.5,
        "duration_s": draw.uniform(10.0, 18.0),
    }


def driven(machine, draw):
    """The drive of a recording, of time, shown position and speed."""
    if machine.within_rad is None and draw.random() < 0.7:
        pattern = draw.choice(drives.OPEN)(draw, machine.limit)
        return lambda t, duration, _x, _velocity: pattern(t, duration)
    reach = machine.within_rad or draw.uniform(2.0, 12.0)
    follow = drives.controller(draw, machine, draw.choice(drives.CLOSED)(draw, reach))
    return lambda t, _duration, x, velocity: follow(t, x, velocity)


def record(machine, model, world, draw, start_s):
    """Rows of one recording, that begins at rest at this time of the session."""
    data = mujoco.MjData(model)
    period_s, duration_s = 1.0 / world["rate_hz"], world["duration_s"]
    drive, start_rad = driven(machine, draw), machine.start_rad()
    data.qpos[0] = start_rad
    machine.begin()
    step_rad = 2 * math.pi / world["counts"]
    keep = math.exp(-2 * math.pi * world["torque_noise_hz"] * STEP_S)
    kick = world["torque_noise"] * machine.limit * math.sqrt(1 - keep**2)
    noise, u, rows, next_s, last = 0.0, 0.0, [], 0.0, None
    for k in range(int(duration_s / STEP_S)):
        t = k * STEP_S
        x, velocity = float(data.qpos[0]), float(data.qvel[0])
        if t >= next_s:
            shown = math.floor(machine.sensor(x) / step_rad) * step_rad - start_rad
            # A controller has half of its speed from the differences of what its encoder shows.
            difference = 0.0 if last is None else (shown - last) / period_s
            u, last = drive(t, duration_s, shown, 0.5 * (difference + velocity)), shown
            rows.append((start_s + (len(rows) * period_s if world["stamps_are_nominal"] else t), u, shown))
            next_s = len(rows) * period_s + draw.gauss(0.0, world["jitter"]) * period_s
        noise = keep * noise + kick * draw.gauss(0.0, 1.0)
        acting = machine.electronics(u, x, velocity, start_s + t)
        data.qfrc_applied[0] = SI * (acting + noise + machine.force(x, velocity, start_s + t, acting))
        model.dof_frictionloss[0] = SI * machine.friction(x, velocity, start_s + t, acting)
        machine.change(model, start_s + t)
        mujoco.mj_step(model, data)
    return rows


def write(folder, name, seed):
    """One session, unless the folder holds it; the truth is written last."""
    place = folder / f"{name}-{seed}"
    if (place / "truth.csv").exists():
        return
    draw = random.Random(f"{name} {seed}")
    machine, world = scenarios()[name](draw), drawn_world(draw)
    model = mujoco.MjModel.from_xml_string(machine.xml())
    place.mkdir(parents=True, exist_ok=True)
    for k in range(RECORDINGS):
        start_s = k * (world["duration_s"] + 1.0)
        shift = 0.0 if machine.runs_on or world["runs_on"] else start_s
        rows = record(machine, model, world, draw, start_s)
        lines = [f"{t - shift:.6f},{u:.6g},{x:.9g}" for t, u, x in rows]
        (place / f"{k + 1}.csv").write_text("# units: t=s, u=V, x=rad\nt,u,x\n" + "\n".join(lines) + "\n")
    truth = {
        "scenario": name,
        "seed": seed,
        "about": machine.about(),
        "lead": "+".join(machine.lead),
        "also": "+".join(machine.also),
        "outside": str(machine.outside).lower(),
        "size_percent": f"{100 * machine.size:.1f}",
        "world": " ".join(f"{key}={value:.4g}" for key, value in world.items()),
    }
    with (place / "truth.csv").open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([truth.keys(), truth.values()])


def main():
    """Makes what is asked for, a session for each processor at a time."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("folder", type=pathlib.Path)
    asked.add_argument("--seeds", required=True, help="such as 1..5, whose end is left out, or 7")
    asked.add_argument("--scenarios", help="names with commas between; all by default")
    options = asked.parse_args()
    first, _, end = options.seeds.partition("..")
    seeds = range(int(first), int(end) if end else int(first) + 1)
    names = options.scenarios.split(",") if options.scenarios else list(scenarios())
    unknown = [name for name in names if name not in scenarios()]
    if unknown:
        asked.error(f"no scenario is called {unknown[0]}: {', '.join(scenarios())}")
    with multiprocessing.Pool() as pool:
        pool.starmap(write, [(options.folder, name, seed) for seed in seeds for name in names], chunksize=1)


if __name__ == "__main__":
    main()
