"""The interpreter's lock and Ctrl-C. No time is asserted: what has to happen is waited for, or has happened."""

import os
import signal
import subprocess
import sys
import textwrap
import threading

import breakaway as bk
import pytest
from conftest import simulated


def test_a_thread_counts_while_discover_works(arrays):
    """Without the lock a Python thread runs between two of the work's steps, and it could not with it."""
    count, stop, at_steps = [0], threading.Event(), []

    def counting():
        while not stop.is_set():
            count[0] += 1

    thread = threading.Thread(target=counting)
    thread.start()
    try:
        found = bk.discover(arrays, units=("V", "rad"), progress=lambda step: at_steps.append((count[0], step)))
    finally:
        stop.set()
        thread.join()
    assert [effect.name for effect in found.effects] == ["cogging"]
    counts = [count for count, _ in at_steps]
    assert len(counts) >= 3
    # An interpreter gives the lock to another thread every 5 ms; a million of loops takes it some 50 ms. A count that stood
    # still during the work would be the same at every step.
    assert counts[-1] > counts[0]
    assert "judging the measured forces" in at_steps[0][1]


def test_two_identifications_at_once_are_one_after_the_other():
    """Same bits from two threads, and with one thread of work each."""
    arrays = simulated(6.0)
    wanted = bk.identify(*arrays).document
    found = [None, None]

    def work(k):
        found[k] = bk.identify(*arrays, threads=1).document

    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [wanted, wanted]


def test_what_progress_raises_ends_the_work(arrays):
    class Enough(Exception):
        pass

    def enough(step):
        raise Enough(step)

    with pytest.raises(Enough):
        bk.discover(arrays, progress=enough)
    # The package goes on to work.
    assert bk.identify(*arrays).b.value > 0


@pytest.mark.skipif(os.name != "posix", reason="SIGINT is sent by os.kill")
def test_control_c_is_a_keyboard_interrupt(tmp_path):
    """A process that sends itself SIGINT at the first step of a discovery leaves by KeyboardInterrupt, and still works."""
    t, u, x = simulated()
    bk.recording(t, u, x, units=("V", "rad")).write(tmp_path / "rec.csv")
    program = textwrap.dedent(
        """
        import os, signal, sys
        import breakaway as bk
        # A shell starts what is in the background with SIGINT ignored, and this holds for its children too.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        steps = []
        def first(step):
            if not steps:
                os.kill(os.getpid(), signal.SIGINT)
            steps.append(step)
        try:
            found = bk.discover(sys.argv[1], progress=first)
        except KeyboardInterrupt:
            print("interrupted", bk.identify(sys.argv[1]).estimator != "")
        else:
            print("found", found.verdict)
        """
    )
    done = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "rec.csv")], capture_output=True, text=True, timeout=300
    )
    assert (done.stdout, done.returncode) == ("interrupted True\n", 0), done.stderr
    # The thread that is left says nothing.
    assert done.stderr == ""


def test_control_c_without_progress(tmp_path):
    """An alarm raises in the calling thread while the work goes on: signals are looked for by themselves."""

    class Alarm(Exception):
        pass

    def ring(*_):
        raise Alarm

    arrays = simulated(60.0)
    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Alarm):
            # A minute of data takes seconds; should a machine be faster than the alarm, it goes on until then.
            while True:
                bk.discover(arrays, threads=1)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
