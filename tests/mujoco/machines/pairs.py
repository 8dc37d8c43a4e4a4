"""Machines with two missing effects."""

from bodies import Backlash, Coupling, Gravity
from laws import Cogging, Eccentric, Late, Warming, Worm


def both(one, other, text):
    """A machine that is both; the first's own draws come first."""

    def set_up(self):
        one.set_up(self)
        other.set_up(self)

    members = {
        "__doc__": text,
        "lead": one.lead + other.lead,
        "also": one.also + other.also,
        "runs_on": one.runs_on or other.runs_on,
        "set_up": set_up,
    }
    return type(one.__name__ + other.__name__, (one, other), members)


PAIRS = [
    both(Gravity, Cogging, "An arm on a horizontal shaft with a ripple."),
    both(Gravity, Worm, "An arm on a horizontal shaft, behind a worm gear."),
    both(Gravity, Late, "An arm on a horizontal shaft, and a drive that acts late."),
    both(Coupling, Cogging, "A shaft that gives, and a ripple."),
    both(Backlash, Worm, "Play, and friction that grows with the torque."),
    both(Warming, Cogging, "Grease that warms up, and a ripple."),
    both(Late, Eccentric, "A drive that acts late, and an encoder disc off its centre."),
]
