"""A motor with an encoder as MuJoCo's body on a hinge, and where a scenario may change it.

All sizes are in units of the drive (V) and of the position (rad), as the recordings have them. `SI` is how many newton metres
a volt makes: MuJoCo is given the products. A scenario is a class below `Machine`. It changes the methods that differ, and
says which names are true of it.
"""

import math
import random

SI = 0.05
STEP_S = 1e-4
# Friction that holds within two steps; by default MuJoCo lets a held joint creep for 20 ms.
FRICTION = 'solreffriction="0.0002 1" solimpfriction="0.99 0.999 0.001 0.5 2"'


class Machine:
    """Nothing is missing: inertia, viscous and Coulomb friction."""

    #: Effects that are missing, one of which must lead. `dahl~lugre` is one that has either name.
    lead = ()
    #: Further names that are also true.
    also = ()
    #: Whether no name of the catalogue is the whole truth.
    outside = False
    #: Half of the range in which a controller keeps it; None where it may turn freely.
    within_rad = None
    #: Whether the recordings' stamps must run on, since the effect lives in the session's time.
    runs_on = False

    def __init__(self, draw: random.Random):
        self.draw = draw
        self.limit = draw.choice([5.0, 12.0, 24.0])
        speed = draw.uniform(8.0, 40.0)
        self.f1 = draw.uniform(0.05, 0.2) * self.limit
        self.c = draw.uniform(0.5, 0.8) * self.limit / speed
        self.b = self.c * math.exp(draw.uniform(math.log(0.06), math.log(0.5)))
        #: Size of what is missing, of the drive's limit.
        self.size = math.exp(draw.uniform(math.log(0.04), math.log(0.25)))
        self.level = self.size * self.limit
        self.phase = draw.uniform(-math.pi, math.pi)
        self.set_up()

    def about(self):
        """What the machine is, in a sentence."""
        return self.__doc__.splitlines()[0]

    def set_up(self):
        """Draws what the scenario adds."""

    def gravity(self):
        """Acceleration of gravity as MuJoCo takes it. The shaft is the y axis."""
        return "0 0 0"

    def fluid(self):
        """Attributes of the medium."""
        return ""

    def rotor(self):
        """Inertia of the rotor, and attributes of its joint."""
        return self.b, ""

    def bodies(self):
        """What hangs on the rotor."""
        return ""

    def beside(self):
        """What stands beside the rotor in the world, and constraints."""
        return "", ""

    def electronics(self, u, x, velocity, t):
        """The drive that acts, for the one that is asked for. `t` is the session's time."""
        return u

    def force(self, x, velocity, t, u):
        """A further force on the shaft."""
        return 0.0

    def friction(self, x, velocity, t, u):
        """Level of the dry friction."""
        return self.f1

    def sensor(self, x):
        """What the encoder would show without its steps."""
        return x

    def start_rad(self):
        """Where a recording begins, whose position is 0 there."""
        return 0.0 if self.within_rad else self.draw.uniform(-math.pi, math.pi)

    def begin(self):
        """A recording begins at rest."""

    def change(self, model, t):
        """Changes the body while it runs."""

    def xml(self):
        """The model."""
        inertia, joint = self.rotor()
        beside, constraints = self.beside()
        round_body = f'mass="1" diaginertia="{inertia * SI:.9g} {inertia * SI:.9g} {inertia * SI:.9g}"'
        return f"""<mujoco>
  <compiler angle="radian"/>
  <option timestep="{STEP_S}" gravity="{self.gravity()}" integrator="implicitfast" {self.fluid()}/>
  <worldbody>
    <body name="rotor"><inertial pos="0 0 0" {round_body}/>
      <joint name="shaft" type="hinge" axis="0 1 0" damping="{self.c * SI:.9g}" frictionloss="{self.f1 * SI:.9g}"
        {FRICTION} {joint}/>
      {self.bodies()}
    </body>
    {beside}
  </worldbody>
  {constraints}
</mujoco>"""
