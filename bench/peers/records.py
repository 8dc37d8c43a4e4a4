"""Blind cases of the hidden plant: made by its own program, read as arrays, and the sealed truth beside them."""
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TS = 1e-3

# Laws that are functions of (x, v, u, t): what a regression on a library can express.
EXPRESSIBLE = [
    "constant_load", "asymmetric_viscous", "stribeck", "quadratic_drag", "load_friction", "position_friction", "cogging",
    "gravity_load", "spring", "time_periodic", "dead_zone", "saturation", "pwm_dead_time", "encoder_eccentricity",
    "friction_drift", "gain_drift", "inertia_step",
]
# Laws with a state of their own: bristles, a second body, the past of the drive, rest.
HIDDEN_STATE = ["stiction", "dahl", "lugre", "backlash", "flexible_coupling", "delay", "electrical_lag"]


@dataclass
class Record:
    """One recording: session time (s), held drive (V), encoder position (rad), and what the encoder hid (rad)."""
    t: np.ndarray
    u: np.ndarray
    x: np.ndarray
    x_true: np.ndarray


@dataclass
class Case:
    """Recordings to fit and to score, and `key: value` of the sealed truth."""
    effect: str
    size: float
    seed: int
    fit: list
    score: list
    truth: dict

    def own_error(self):
        """RMS error of the truth against the held-out measurement (rad)."""
        return np.sqrt(np.mean(np.concatenate([r.x - r.x_true for r in self.score]) ** 2))


def parse(path):
    """The truth's lines; numbers as numbers."""
    truth = {}
    for line in path.read_text().splitlines():
        key, value = line.split(": ", 1)
        try:
            truth[key] = float(value)
        except ValueError:
            truth[key] = value
    return truth


def generate(program, place, effect, size, seed):
    """Runs the hidden plant's program."""
    subprocess.run([program, "--seed", str(seed), "--effects", effect, "--size", f"{size:g}",
                    "-o", place / "records", "--sealed", place / "sealed"], check=True)


def truth_of(program, folder, effect, size, seed):
    """The sealed truth alone."""
    place = Path(folder) / f"{effect}-{size:g}-{seed}"
    generate(program, place, effect, size, seed)
    truth = parse(place / "sealed" / "truth.txt")
    shutil.rmtree(place)
    return truth


def make(program, folder, effect, size, seed):
    """Generates the case and returns it; the files are removed."""
    place = Path(folder) / f"{effect}-{size:g}-{seed}"
    generate(program, place, effect, size, seed)
    roles = {"fit": [], "score": []}
    for file in (place / "records").iterdir():
        role, name = file.stem.split("-", 1)
        t, u, x = np.loadtxt(file, delimiter=",", comments="#", skiprows=5, unpack=True)
        x_true = np.loadtxt(place / "sealed" / f"{name}.csv", delimiter=",", skiprows=1, usecols=0)
        roles[role].append(Record(t, u, x, x_true))
    for records in roles.values():
        records.sort(key=lambda r: r.t[0])
    truth = parse(place / "sealed" / "truth.txt")
    shutil.rmtree(place)
    return Case(effect, size, seed, roles["fit"], roles["score"], truth)
