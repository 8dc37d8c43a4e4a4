"""Scenarios whose missing effect is a mechanism of MuJoCo's own: bodies, joints, limits, contacts, and a fluid."""

import math

import mujoco
from machine import SI, Machine

EARTH = 9.81


class Gravity(Machine):
    """An arm on a horizontal shaft."""

    lead = ("gravity_load",)

    def gravity(self):
        return f"0 0 -{EARTH}"

    def bodies(self):
        length = 0.2
        mass = self.level * SI / (EARTH * length)
        x, z = length * math.cos(self.phase), length * math.sin(self.phase)
        return f'<body><inertial pos="{x} 0 {z}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/></body>'


class Swing(Gravity):
    """The same arm, and a controller keeps it within part of a turn."""

    within_rad = 1.2
    # A slope of gravity over part of a turn is a spring's.
    also = ("spring", "constant_load")


class Elbow(Gravity):
    """An arm with a second link that swings freely."""

    outside = True
    also = ("gravity_load", "flexible_coupling")
    lead = ()

    def bodies(self):
        length = 0.15
        mass = self.level * SI / (EARTH * length) / 2
        bob = f'<inertial pos="0 0 -{length / 2}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>'
        link = f'<body pos="0 0 -{length}"><joint type="hinge" axis="0 1 0" damping="{0.002 * self.level * SI}"/>{bob}</body>'
        return f'<body><inertial pos="0 0 -{length}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>{link}</body>'


class Spring(Machine):
    """A spring to the frame."""

    lead = ("spring",)
    also = ("constant_load",)
    within_rad = 2.0

    def rotor(self):
        rest = self.draw.uniform(-1.0, 1.0)
        return self.b, f'stiffness="{self.level / 2.0 * SI:.9g}" springref="{rest:.4f}"'


class Coupling(Machine):
    """Half of the inertia or less behind a shaft that gives."""

    lead = ("flexible_coupling",)

    def set_up(self):
        self.share = self.draw.uniform(0.15, 0.5)
        self.hz = self.draw.uniform(6.0, 40.0)

    def rotor(self):
        return (1 - self.share) * self.b, ""

    def bodies(self):
        load = self.share * self.b * SI
        stiffness = load * (2 * math.pi * self.hz) ** 2
        damping = 2 * 0.03 * math.sqrt(stiffness * load)
        return f"""<body><joint type="hinge" axis="0 1 0" stiffness="{stiffness:.9g}" damping="{damping:.9g}"/>
        <inertial pos="0 0 0" mass="1" diaginertia="{load:.9g} {load:.9g} {load:.9g}"/></body>"""


class Backlash(Coupling):
    """Half of the inertia or less behind a joint with play, whose ends yield for 2 ms."""

    lead = ("backlash",)

    def bodies(self):
        load = self.share * self.b * SI
        half = self.draw.uniform(0.01, 0.08)
        return f"""<body><joint type="hinge" axis="0 1 0" limited="true" range="-{half:.5f} {half:.5f}"
        solreflimit="0.002 1" damping="{1e-3 * self.c * SI:.9g}"/>
        <inertial pos="0 0 0" mass="1" diaginertia="{load:.9g} {load:.9g} {load:.9g}"/></body>"""


class EndStop(Machine):
    """A rubber stop that a controller runs into."""

    lead = ("end_stop",)
    within_rad = 2.0

    def set_up(self):
        self.stop_rad = self.draw.uniform(0.7, 1.3)

    def force(self, x, velocity, t, u):
        depth = x - self.stop_rad
        return -max(0.0, self.level * (depth / 0.3) + 0.02 * self.level * velocity) if depth > 0 else 0.0


class TwoStops(EndStop):
    """A rubber stop at either end."""

    def force(self, x, velocity, t, u):
        return super().force(x, velocity, t, u) - super().force(-x, -velocity, t, u)


class Drag(Machine):
    """A paddle in a fluid: MuJoCo's drag of a box."""

    lead = ("quadratic_drag",)

    def set_up(self):
        # At the speed that the limit drives to, about the level: two faces of 8 cm, 10 cm off the shaft, ½·ρ·A·v² each.
        speed = (self.limit - self.f1) / self.c
        self.density = self.level * SI / (0.08**2 * 0.1 * (0.1 * speed) ** 2)

    def fluid(self):
        return f'density="{self.density:.6g}"'

    def bodies(self):
        # The thin side lies along the motion, the face across it.
        box = 'type="box" size="0.04 0.04 0.001" mass="1e-6" contype="0" conaffinity="0"'
        return "".join(f'<body pos="{at} 0 0"><geom {box}/></body>' for at in (0.1, -0.1))


class SliderCrank(Machine):
    """A crank that moves a mass on a guide: its inertia depends on the angle. No name of the catalogue says so."""

    outside = True

    def set_up(self):
        self.crank, self.rod = 0.05, 0.15
        self.mass = self.draw.uniform(0.3, 1.0) * self.b * SI / self.crank**2

    def start_rad(self):
        # The rod and the slide stand where they fit to this angle.
        return 0.0

    def bodies(self):
        rod = 0.02 * self.mass * self.rod**2 / 3
        return f"""<body pos="{self.crank} 0 0"><joint type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="{0.02 * self.mass:.9g}" diaginertia="{rod:.9g} {rod:.9g} {rod:.9g}"/>
        <site name="far" pos="{self.rod} 0 0"/></body>"""

    def beside(self):
        slide = f"""<body pos="{self.crank + self.rod} 0 0"><joint type="slide" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="{self.mass:.9g}" diaginertia="1e-6 1e-6 1e-6"/><site name="pin"/></body>"""
        return slide, '<equality><connect site1="far" site2="pin" solref="0.001 1"/></equality>'


class Payload(Machine):
    """A load is put down or picked up while a session runs."""

    lead = ("inertia_step",)
    runs_on = True

    def set_up(self):
        self.changed = 0.0
        self.ratio = self.draw.choice([-1, 1]) * self.draw.uniform(0.15, 0.5)
        self.at_s = self.draw.uniform(15.0, 45.0)

    def change(self, model, t):
        ratio = self.ratio if t > self.at_s else 0.0
        if ratio != self.changed:
            self.changed = ratio
            model.body_inertia[1, :] = self.b * SI * (1 + ratio)
            # MuJoCo keeps the inertia of a body that only turns: it is computed anew, beside the running simulation.
            mujoco.mj_setConst(model, mujoco.MjData(model))
