"""What a user drives a machine with: a drive over time, or a controller that follows a position over time."""

import math


def chirp(draw, limit):
    """A sine whose frequency rises from .2 Hz to 10 Hz."""
    level, last = draw.uniform(0.5, 1.0) * limit, draw.uniform(4.0, 10.0)

    def drive(t, duration):
        rate = math.log(last / 0.2) / duration
        return level * math.sin(2 * math.pi * 0.2 * (math.exp(rate * t) - 1) / rate)

    return drive


def steps(draw, limit):
    """Levels at random, each held for .1 s to 1 s."""
    edges = [0.0]
    while edges[-1] < 60.0:
        edges.append(edges[-1] + draw.uniform(0.1, 1.0))
    levels = [draw.uniform(-1.0, 1.0) * limit for _ in edges]
    state = {"at": 0}

    def drive(t, _duration):
        while edges[state["at"] + 1] <= t:
            state["at"] += 1
        return levels[state["at"]]

    return drive


def multisine(draw, limit):
    """Eight sines up to 12 Hz, of equal amplitude."""
    waves = [(draw.uniform(0.1, 12.0), draw.uniform(-math.pi, math.pi)) for _ in range(8)]
    level = draw.uniform(0.2, 0.35) * limit

    def drive(t, _duration):
        return max(-limit, min(limit, level * sum(math.sin(2 * math.pi * hz * t + phase) for hz, phase in waves)))

    return drive


def staircase(draw, limit):
    """Up and down through levels of .5 s, both ways."""
    count = draw.choice([4, 5, 6])

    def drive(t, _duration):
        k = int(t / 0.5) % (4 * count)
        up = k if k <= count else 2 * count - k if k <= 3 * count else k - 4 * count
        return limit * up / count

    return drive


OPEN = (chirp, steps, multisine, staircase)


def moves(draw, within):
    """Smooth moves between random positions, with rests between them."""
    now, at, legs = 0.0, 0.0, []
    while now < 60.0:
        move, rest, to = draw.uniform(0.2, 1.2), draw.choice([0.0, 0.1, 0.4]), draw.uniform(-within, within)
        legs.append((now, move, at, to))
        now, at = now + move + rest, to
    state = {"leg": 0}

    def wanted(t):
        while state["leg"] + 1 < len(legs) and legs[state["leg"] + 1][0] <= t:
            state["leg"] += 1
        begin, move, a, b = legs[state["leg"]]
        s = min((t - begin) / move, 1.0)
        return a + (b - a) * s**3 * (10 - 15 * s + 6 * s * s)

    return wanted


def sines(draw, within):
    """Three sines up to 3 Hz."""
    waves = [(draw.uniform(0.1, 3.0), draw.uniform(-math.pi, math.pi)) for _ in range(3)]

    def wanted(t):
        return within / 2.0 * sum(math.sin(2 * math.pi * hz * t + phase) for hz, phase in waves) * min(1.0, t)

    return wanted


CLOSED = (moves, sines)


def controller(draw, machine, wanted):
    """A PD controller with a bandwidth of 1.5 Hz to 4 Hz for the machine's inertia."""
    omega = 2 * math.pi * draw.uniform(1.5, 4.0)
    stiffness, damping = machine.b * omega**2, max(0.0, 1.4 * machine.b * omega - machine.c)

    def drive(t, x, velocity):
        u = stiffness * (wanted(t) - x) - damping * velocity + 0.5 * machine.f1
        return max(-machine.limit, min(machine.limit, u))

    return drive
