"""The catalogue's laws as columns of a sparse regression: every law that is a function of (x, v, u, t).

Given for free, because a regression on fixed columns cannot find them: every nonlinear parameter (wave numbers, frequency of
the periodic force, thresholds, Stribeck velocity and exponent, warm-up time, time of the inertia step), at its TRUE value for
the machine and size at hand (the one that this seed would hide, where something else is hidden).
"""
import numpy as np

# Columns that every model has: b and c and f1 of the base. Never a name.
BASE = "base"
# The effects whose nonlinear parameters are told.
TOLD = ["cogging", "position_friction", "time_periodic", "dead_zone", "saturation", "pwm_dead_time", "inertia_step",
        "stribeck", "friction_drift"]


def nonlinear(truths):
    """The known nonlinear parameters, from the truths of one seed and size by effect."""
    pwm = truths["pwm_dead_time"]
    return {
        "n_cogging": truths["cogging"]["cogging.n"],
        "n_friction": truths["position_friction"]["position_friction.n"],
        "omega": truths["time_periodic"]["time_periodic.omega"],
        "dead_zone": truths["dead_zone"]["dead_zone.d"],
        "saturation": truths["saturation"]["saturation.u_max"],
        "i0": pwm["pwm_dead_time.i0"],
        "ke": pwm["pwm_dead_time.Ke"],
        "t0": truths["inertia_step"]["inertia_step.t0"],
        "vs": truths["stribeck"]["stribeck.vs"],
        "p": truths["stribeck"]["stribeck.p"],
        "warm_up": truths["friction_drift"]["friction_drift.T"],
    }


def columns(known, end):
    """(effect, function of x, v, u, t) for every column.

    What varies with the session time is taken about its mean over a session that ends at `end` (s), so that it is nearly
    orthogonal to the base's own column.
    """
    n, m, w = known["n_cogging"], known["n_friction"], known["omega"]
    d, top, i0, ke, t0 = (known[k] for k in ("dead_zone", "saturation", "i0", "ke", "t0"))
    vs, p, warm_up = known["vs"], known["p"], known["warm_up"]
    decay = warm_up / end * (1.0 - np.exp(-end / warm_up))
    later = 1.0 - t0 / end
    s = np.sign
    return [
        (BASE, lambda x, v, u, t: v),
        (BASE, lambda x, v, u, t: u),
        (BASE, lambda x, v, u, t: s(v)),
        ("constant_load", lambda x, v, u, t: np.ones_like(v)),
        ("asymmetric_viscous", lambda x, v, u, t: np.abs(v)),
        ("quadratic_drag", lambda x, v, u, t: v * np.abs(v)),
        ("load_friction", lambda x, v, u, t: np.abs(u) * s(v)),
        ("position_friction", lambda x, v, u, t: np.sin(m * x) * s(v)),
        ("position_friction", lambda x, v, u, t: np.cos(m * x) * s(v)),
        ("cogging", lambda x, v, u, t: np.sin(n * x)),
        ("cogging", lambda x, v, u, t: np.cos(n * x)),
        ("gravity_load", lambda x, v, u, t: np.sin(x)),
        ("gravity_load", lambda x, v, u, t: np.cos(x)),
        ("spring", lambda x, v, u, t: x),
        ("time_periodic", lambda x, v, u, t: np.sin(w * t)),
        ("time_periodic", lambda x, v, u, t: np.cos(w * t)),
        ("dead_zone", lambda x, v, u, t: np.clip(u, -d, d)),
        ("saturation", lambda x, v, u, t: u - np.clip(u, -top, top)),
        ("pwm_dead_time", lambda x, v, u, t: np.clip((u - ke * v) / i0, -1.0, 1.0)),
        ("gain_drift", lambda x, v, u, t: (t - 0.5 * end) * u),
        # y = x + A·sin(x+φ): ÿ = ẍ·(1 + A·cos) − A·ẋ²·sin.
        ("encoder_eccentricity", lambda x, v, u, t: v * v * np.sin(x)),
        ("encoder_eccentricity", lambda x, v, u, t: v * v * np.cos(x)),
        ("encoder_eccentricity", lambda x, v, u, t: u * np.sin(x)),
        ("encoder_eccentricity", lambda x, v, u, t: u * np.cos(x)),
        # A larger inertia scales all of the acceleration.
        ("inertia_step", lambda x, v, u, t: u * ((t >= t0) - later)),
        ("inertia_step", lambda x, v, u, t: v * ((t >= t0) - later)),
        ("inertia_step", lambda x, v, u, t: s(v) * ((t >= t0) - later)),
        ("stribeck", lambda x, v, u, t: np.exp(-(np.abs(v) / vs) ** p) * s(v)),
        ("friction_drift", lambda x, v, u, t: (np.exp(-t / warm_up) - decay) * s(v)),
    ]
