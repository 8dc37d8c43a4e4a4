"""Scenarios whose missing effect is a law of drive, friction, force, or sensor, applied at each of MuJoCo's steps."""

import math

from machine import STEP_S, Machine


class Asymmetric(Machine):
    """More viscous friction one way."""

    lead = ("asymmetric_viscous",)
    also = ("constant_load",)

    def force(self, x, velocity, t, u):
        return -self.size * self.c * abs(velocity)


class Load(Machine):
    """A constant load, such as a counterweight's rope."""

    lead = ("constant_load",)

    def force(self, x, velocity, t, u):
        return 0.5 * self.level


class Stribeck(Machine):
    """Friction that falls with speed."""

    lead = ("stribeck",)
    also = ("stiction",)

    def set_up(self):
        self.speed = self.draw.uniform(0.3, 3.0)

    def friction(self, x, velocity, t, u):
        return self.f1 + self.level * math.exp(-((velocity / self.speed) ** 2))


class Bristle(Machine):
    """A brush: a pad that slides under Coulomb's law, on a spring. Two of them of unlike stiffness."""

    lead = ("dahl~lugre",)

    def set_up(self):
        travel = math.exp(self.draw.uniform(math.log(0.02), math.log(0.3)))
        self.pads = [[0.5 * self.level, travel, 0.0], [0.5 * self.level, 3 * travel, 0.0]]

    def begin(self):
        for pad in self.pads:
            pad[2] = 0.0

    def force(self, x, velocity, t, u):
        total = 0.0
        for pad in self.pads:
            level, travel, bent = pad
            pad[2] = min(max(bent + velocity * STEP_S, -travel), travel)
            total -= level * pad[2] / travel
        return total


class Worm(Machine):
    """Friction that grows with the torque that is transmitted."""

    lead = ("load_friction",)

    def friction(self, x, velocity, t, u):
        return self.f1 + self.size * abs(u)


class BentShaft(Machine):
    """Friction over the angle."""

    lead = ("position_friction",)

    def set_up(self):
        self.depth = min(0.9, self.level / self.f1)
        self.waves = self.draw.choice([1, 1, 2, 3])

    def friction(self, x, velocity, t, u):
        return self.f1 * (1 + self.depth * math.sin(self.waves * x + self.phase))


class Cogging(Machine):
    """A ripple over the angle, and three tenths of it at twice the waves."""

    lead = ("cogging",)

    def set_up(self):
        self.waves = self.draw.choice([4, 6, 7, 8, 12, 14, 21])

    def force(self, x, velocity, t, u):
        angle = self.waves * x + self.phase
        return self.level * (math.sin(angle) + 0.3 * math.sin(2 * angle + 1.0))


class Shaking(Machine):
    """A neighbour that vibrates."""

    lead = ("time_periodic",)
    runs_on = True

    def set_up(self):
        self.hz = self.draw.uniform(0.7, 15.0)

    def force(self, x, velocity, t, u):
        return 0.5 * self.level * math.sin(2 * math.pi * self.hz * t + self.phase)


class Warming(Machine):
    """Friction that falls while the grease warms up."""

    lead = ("friction_drift",)
    runs_on = True

    def set_up(self):
        self.time_constant_s = self.draw.uniform(10.0, 40.0)

    def friction(self, x, velocity, t, u):
        return self.f1 + self.level * math.exp(-t / self.time_constant_s)


class Battery(Machine):
    """A gain that falls by .1 to .6 % a second."""

    lead = ("gain_drift",)
    runs_on = True

    def set_up(self):
        self.rate = 0.024 * self.size

    def electronics(self, u, x, velocity, t):
        return u * (1 - self.rate * t)


class DeadZone(Machine):
    """An amplifier that loses a constant part."""

    lead = ("dead_zone",)

    def electronics(self, u, x, velocity, t):
        return math.copysign(max(0.0, abs(u) - self.level), u)


class DeadTime(Machine):
    """A bridge that loses voltage against the current's direction."""

    lead = ("pwm_dead_time",)

    def set_up(self):
        self.back_emf = 0.6 * self.c

    def electronics(self, u, x, velocity, t):
        current = u - self.back_emf * velocity
        return u - self.level * min(max(current / (0.04 * self.limit), -1.0), 1.0)


class Clipping(Machine):
    """A supply that ends below the largest drive."""

    lead = ("saturation",)

    def electronics(self, u, x, velocity, t):
        end = (1 - self.size) * 0.9 * self.limit
        return min(max(u, -end), end)


class Lag(Machine):
    """A current that follows its voltage late."""

    lead = ("electrical_lag",)
    also = ("delay",)

    def set_up(self):
        self.time_constant_s = self.draw.uniform(0.003, 0.02)

    def begin(self):
        self.acting = 0.0

    def electronics(self, u, x, velocity, t):
        self.acting += (u - self.acting) * STEP_S / self.time_constant_s
        return self.acting


class Late(Machine):
    """A drive that acts some milliseconds late."""

    lead = ("delay",)
    also = ("electrical_lag",)

    def set_up(self):
        self.steps = round(self.draw.uniform(0.003, 0.02) / STEP_S)

    def begin(self):
        self.line = [0.0] * self.steps

    def electronics(self, u, x, velocity, t):
        self.line.append(u)
        return self.line.pop(0)


class Eccentric(Machine):
    """An encoder disc off its centre, by .3 to 3 hundredths of a radian."""

    lead = ("encoder_eccentricity",)

    def sensor(self, x):
        return x + 0.1 * self.size * math.sin(x + self.phase)


class Bump(Machine):
    """A spot of a tenth of a turn that pushes back and forth. No name of the catalogue says so."""

    outside = True
    also = ("cogging",)

    def force(self, x, velocity, t, u):
        angle = math.remainder(x - self.phase, 2 * math.pi) / 0.3
        return 2 * self.level * angle * math.exp(-(angle**2))


class GainOverPosition(Machine):
    """A motor whose gain falls towards one side of the turn. No name of the catalogue says so."""

    outside = True

    def electronics(self, u, x, velocity, t):
        return u * (1 - self.size * (1 + math.sin(x + self.phase)))
