"""Simulates windows of a drive with MuJoCo: `simulate.py MODEL.xml WINDOWS.json`, positions as JSON on standard output.

A window has the stamps `t`, the drives `u` held from stamp to stamp, the `start` (position, velocity), and where the model
has them the `bristle` and the position and velocity of a `second` body.
"""

import json
import math
import sys

import mujoco


def simulate(model, window, step):
    """Positions at the stamps of a window."""
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = window["start"]
    if model.nq > 1 and window["second"] is not None:
        position, velocity = window["second"]
        data.qpos[1], data.qvel[1] = position - data.qpos[0], velocity - data.qvel[0]
    if window["bristle"] is not None:
        data.act[model.actuator("friction").actadr[0]] = window["bristle"]
    positions = []
    stamps, drives = window["t"], window["u"]
    for index, drive in enumerate(drives):
        positions.append(float(data.qpos[0]))
        if index + 1 == len(drives):
            break
        interval = stamps[index + 1] - stamps[index]
        steps = max(1, math.ceil(interval / step - 1e-6))
        model.opt.timestep = interval / steps
        data.ctrl[0] = drive
        mujoco.mj_step(model, data, nstep=steps)
    return positions


def main():
    """Reads the model and the windows, and writes the positions."""
    model = mujoco.MjModel.from_xml_path(sys.argv[1])
    step = model.opt.timestep
    with open(sys.argv[2], encoding="utf-8") as file:
        windows = json.load(file)
    json.dump([simulate(model, window, step) for window in windows], sys.stdout)


if __name__ == "__main__":
    main()
