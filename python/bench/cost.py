"""What a call in Python costs, in processor time of the command: `python cost.py BREAKAWAY RECORDINGS`.

BREAKAWAY is the command, built as the installed wheel is (docs/python.md). RECORDINGS is the folder of the measured
recordings. Both read the same files and start anew each time. `call` is the call alone, as a notebook pays for it again
and again; `process` has Python's start and its imports too. Of some runs by turns the least processor time counts, user
and system, of all threads.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

RUNS = 5
# An axis with a hidden ripple, as in the README.
AXIS = """\
base = { b = 0.02685, c = 0.11, f1 = 0.5 }
units = { u = "V", x = "rad" }
[[effect]]
name = "cogging"
A = 0.2
n = 7.0
phi = 0.5
"""


def processor_s(words):
    """User and system time of a process that must succeed, and what it printed."""
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    printed = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"exit code {process.returncode}: {' '.join(words)}")
    return usage.ru_utime + usage.ru_stime, printed


def python_s(call):
    """The time of a call alone, and of its process."""
    clock = "time.process_time()"
    program = f"import time, breakaway as bk\nbegan = {clock}\n{call}\nprint({clock} - began)"
    whole, printed = processor_s([sys.executable, "-c", program])
    return float(printed), whole


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    command, recordings = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2])
    emps = str(recordings / "emps/emps_train.csv")
    with tempfile.TemporaryDirectory() as place:
        axis, session = Path(place) / "axis.toml", Path(place) / "session"
        axis.write_text(AXIS)
        subprocess.run([command, "run", "suite", "--model", axis, "-o", session, "--quiet"], check=True, capture_output=True)
        fit, score = (sorted(str(path) for path in (session / part).glob("*.csv")) for part in ("fit", "score"))
        columns = ["--time", "t_s", "--input", "u_V", "--position", "x_m"]
        named = "time='t_s', input='u_V', position='x_m'"
        cases = [
            ("identify, EMPS", ["identify", emps, *columns], f"bk.identify({emps!r}, {named})"),
            ("discover, EMPS", ["discover", emps, *columns], f"bk.discover({emps!r}, {named})"),
            ("identify, simulated axis", ["identify", *fit], f"bk.identify({fit!r})"),
            ("discover, simulated axis", ["discover", *fit, "--holdout", *score], f"bk.discover({fit!r}, holdout={score!r})"),
        ]
        print(f"{'processor time, s':26}{'command':>10}{'call':>10}{'process':>10}{'call / command':>17}{'process / command':>20}")
        for name, words, call in cases:
            times = [(processor_s([command, *words])[0], *python_s(call)) for _ in range(RUNS)]
            own, alone, whole = (min(column) for column in zip(*times))
            print(f"{name:26}{own:10.3f}{alone:10.3f}{whole:10.3f}{alone / own:17.2f}{whole / own:20.2f}", flush=True)


main()
