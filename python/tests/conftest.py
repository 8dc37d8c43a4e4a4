"""What the tests share: the command to compare with, recordings, and where the measured ones are."""

import json
import os
import subprocess
from pathlib import Path

import breakaway as bk
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]

#: An axis of 0.03 V·s²/rad with a ripple of seven periods per turn, as .ci/stranger has it.
MODEL = bk.Model.of(
    0.03,
    0.1,
    0.4,
    effects=[{"name": "cogging", "A": 0.25, "n": 7.0, "phi": 0.5}],
    units=("V", "rad"),
)


def drive(seconds, tick_s=1e-3):
    """Three sines that move the axis over several periods of its ripple, V."""
    t = np.arange(int(seconds / tick_s)) * tick_s
    parts = [(1.6, 0.6, 0.0), (1.2, 1.7, 1.0), (0.8, 4.1, 2.0)]
    return sum(amplitude * np.sin(2 * np.pi * hz * t + phase) for amplitude, hz, phase in parts)


def simulated(seconds=20.0, encoder_step=1e-3):
    """Arrays of the simulated axis, writeable and contiguous."""
    run = bk.simulate(MODEL, drive(seconds), encoder_step=encoder_step)
    return tuple(np.array(column) for column in (run.recording.t, run.recording.u, run.recording.x))


@pytest.fixture(scope="session")
def arrays():
    return simulated()


@pytest.fixture(scope="session")
def command():
    """Runs the command; its JSON document, or where it fails its message."""
    program = os.environ.get("BREAKAWAY_COMMAND", str(ROOT / "target/debug/breakaway"))

    def run(*words):
        done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
        if done.returncode != 0:
            return done.stderr.splitlines()[-1].removeprefix("error: ")
        return json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def measured():
    """The file of a measured recording; in CI its absence is a failure."""
    folder = Path(os.environ.get("BREAKAWAY_DATA", ROOT.parent / "shared/data"))

    def file(name):
        if (folder / name).exists():
            return folder / name
        reason = f"{name} is not in {folder}: set BREAKAWAY_DATA"
        if "CI" in os.environ:
            pytest.fail(reason)
        pytest.skip(reason)

    return file
