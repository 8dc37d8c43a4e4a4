"""The limit cycle of b*x'' + c*x' + f1*sgn(x') = u under the dual relay, by scipy's solve_ivp with events.

Usage: limit_cycle.py h1 h2 cycles repeats. Prints seconds per run (the best of `repeats`), the last period and peak.
The plant is that of the papers (b = 0.02685, c = 0.11, f1 = 0.5); rtol 1e-8. State: position, velocity, integral of x.
"""
import sys
import time

from scipy.integrate import solve_ivp

B, C, F1 = 0.02685, 0.11, 0.5


def event(index):
    def crossing(_, y):
        return y[index]

    crossing.terminal = True
    return crossing


REVERSAL, POSITION, INTEGRAL = event(1), event(0), event(2)


def run(h1, h2, cycles):
    """From rest at -0.3 with both relays at +1, until the integral relay has switched to +1 `cycles` times."""
    t, y, switched, extremes = 0.0, [-0.3, 0.0, 0.0], [], []
    sign_e, sign_i, direction = 1.0, 1.0, 1.0
    while len(switched) < cycles:
        force = h1 * sign_e + h2 * sign_i - F1 * direction

        def motion(_, y, force=force):
            return [y[1], (force - C * y[1]) / B, y[0]]

        # An event is armed with the direction in which it is crossed, so that it does not fire where it just did.
        REVERSAL.direction = -direction
        POSITION.direction = sign_e
        INTEGRAL.direction = sign_i
        step = solve_ivp(motion, (t, t + 10.0), y, method="RK45", rtol=1e-8, atol=1e-11,
                         events=[REVERSAL, POSITION, INTEGRAL])
        fired = [k for k in range(3) if len(step.t_events[k])]
        if not fired:
            raise SystemExit("no event within 10 s")
        if step.t[-1] <= t:
            raise SystemExit("an event fires without advancing")
        t, y = step.t[-1], list(step.y[:, -1])
        if fired[0] == 0:
            y[1], direction = 0.0, (1.0 if h1 * sign_e + h2 * sign_i > 0 else -1.0)
            extremes.append(y[0])
        elif fired[0] == 1:
            y[0], sign_e = 0.0, -sign_e
        else:
            y[2], sign_i = 0.0, -sign_i
            if sign_i > 0:
                switched.append(t)
    return switched[-1] - switched[-2], 0.5 * abs(extremes[-1] - extremes[-2])


def main():
    h1, h2 = float(sys.argv[1]), float(sys.argv[2])
    cycles, repeats = int(sys.argv[3]), int(sys.argv[4])
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        period, peak = run(h1, h2, cycles)
        best = min(best, time.perf_counter() - start)
    print(best, period, peak)


main()
