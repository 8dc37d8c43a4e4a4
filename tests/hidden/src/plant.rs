//! The plant's integration: midpoint sub-steps while smooth, with reversal, stick and release located inside the
//! sub-step. Presliding states go by a splitting whose bristle part is exact (`friction.rs`).

use crate::{disturbance::Disturbance, drive::Drive, law::ForceLaw};

/// Tick of the kind world's recordings, s.
pub const TS: f64 = 1e-3;

/// Motion state; the second body is used only with a [`crate::law::Second`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    pub x: f64,
    pub v: f64,
    pub x2: f64,
    pub v2: f64,
    /// Bristle deflection.
    pub z: f64,
    /// Direction of sliding, 0 while stuck.
    pub slide: f64,
    /// Random torque, V.
    pub torque: f64,
}

impl State {
    /// At rest at x, both bodies together.
    pub fn at_rest(x: f64) -> Self {
        Self { x, x2: x, ..Self::default() }
    }

    /// Moving at v, both bodies together.
    pub fn moving(x: f64, v: f64) -> Self {
        Self { x, v, x2: x, v2: v, slide: sign(v), ..Self::default() }
    }

    fn shifted(&self, rate: &Rate, h: f64) -> Self {
        Self {
            x: self.x + h * rate.v,
            v: self.v + h * rate.a,
            x2: self.x2 + h * rate.v2,
            v2: self.v2 + h * rate.a2,
            ..*self
        }
    }
}

struct Rate {
    v: f64,
    a: f64,
    v2: f64,
    a2: f64,
}

/// Sign with sgn 0 = 0.
pub fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

impl ForceLaw {
    /// Force on the motor without its friction.
    pub fn free_force(&self, s: &State, t: f64, u: f64) -> f64 {
        let coupling = self.second.as_ref().map_or(0.0, |two| two.coupling(s.x - s.x2, s.v - s.v2));
        self.drive_force(u, s.x, s.v) - self.c * s.v + self.extra_force(s.x, s.v, t) + coupling + s.torque
    }

    /// Accelerations of motor and load under `force` on the motor.
    pub fn accelerations(&self, s: &State, t: f64, force: f64) -> (f64, f64) {
        let Some(two) = &self.second else {
            return (force / self.inertia(t), 0.0);
        };
        let load = two.ratio * self.b;
        let coupling = two.coupling(s.x - s.x2, s.v - s.v2);
        (force / (self.inertia(t) - load), -coupling / load)
    }

    fn rate(&self, s: &State, t: f64, u: f64) -> Rate {
        let friction = if s.slide == 0.0 { 0.0 } else { s.slide * self.sliding_level(s.x, s.v, t, u) };
        let (a, a2) = self.accelerations(s, t, self.free_force(s, t, u) - friction);
        let held = s.slide == 0.0;
        Rate { v: if held { 0.0 } else { s.v }, a: if held { 0.0 } else { a }, v2: s.v2, a2 }
    }

    fn midpoint(&self, s: &State, t: f64, h: f64, u: f64) -> State {
        let half = s.shifted(&self.rate(s, t, u), 0.5 * h);
        s.shifted(&self.rate(&half, t + 0.5 * h, u), h)
    }

    /// Advances by h under a constant delivered drive u.
    pub fn advance(&self, s: &mut State, t: f64, h: f64, u: f64) {
        let Some(two) = self.second.as_ref().filter(|two| two.gap > 0.0) else {
            self.advance_smooth(s, t, h, u);
            return;
        };
        // The contact's damping jumps where the faces meet: split the sub-step there.
        let clearance = |s: &State| (s.x - s.x2).abs() - 0.5 * two.gap;
        let before = clearance(s);
        let mut end = *s;
        self.advance_smooth(&mut end, t, h, u);
        let after = clearance(&end);
        if before * after < 0.0 {
            let part = h * before / (before - after);
            self.advance_smooth(s, t, part, u);
            self.advance_smooth(s, t + part, h - part, u);
        } else {
            *s = end;
        }
    }

    fn advance_smooth(&self, s: &mut State, t: f64, h: f64, u: f64) {
        if let Some(bristle) = &self.bristle {
            self.advance_bristle(bristle, s, t, h, u);
            return;
        }
        // A sub-step holds at most a reversal, a stick and a release.
        let mut done = 0.0;
        for _ in 0..5 {
            let rest = h - done;
            if rest <= 1e-12 * h {
                return;
            }
            done += if s.slide == 0.0 { self.stick(s, t + done, rest, u) } else { self.slide(s, t + done, rest, u) };
        }
        // More is a contact that pushes the body off and back within the sub-step: it stays.
        if s.v == 0.0 {
            s.slide = 0.0;
        }
        *s = self.midpoint(s, t + done, h - done, u);
    }

    /// Slides for at most h; stops at the instant the velocity reaches zero. Returns the time used.
    fn slide(&self, s: &mut State, t: f64, h: f64, u: f64) -> f64 {
        let end = self.midpoint(s, t, h, u);
        if end.v * s.slide >= 0.0 {
            *s = end;
            return h;
        }
        // Two secants on v(θ) = 0: the midpoint velocity is a parabola in θ.
        let mut theta = s.v / (s.v - end.v);
        let mut at = self.midpoint(s, t, theta * h, u);
        if theta > 0.0 && (at.v - s.v).abs() > 0.0 {
            theta = (theta * s.v / (s.v - at.v)).clamp(0.0, 1.0);
            at = self.midpoint(s, t, theta * h, u);
        }
        at.v = 0.0;
        at.slide = 0.0;
        *s = at;
        theta * h
    }

    /// Rests for at most h; leaves at the instant the force exceeds the break-away level.
    fn stick(&self, s: &mut State, t: f64, h: f64, u: f64) -> f64 {
        let surplus = |s: &State, t: f64| {
            let force = self.free_force(s, t, u);
            (force, force.abs() - self.rest_level(s.x, t, u))
        };
        let (force, now) = surplus(s, t);
        if now > 0.0 {
            s.slide = sign(force);
            return 0.0;
        }
        let end = self.midpoint(s, t, h, u);
        let (force, later) = surplus(&end, t + h);
        if later <= 0.0 {
            *s = end;
            return h;
        }
        let theta = -now / (later - now);
        *s = self.midpoint(s, t, theta * h, u);
        s.slide = sign(force);
        theta * h
    }
}

/// A plant being driven: law, state, drive memory, random torque.
#[derive(Clone, Debug)]
pub struct Plant<'a> {
    pub law: &'a ForceLaw,
    pub state: State,
    pub drive: Drive,
    /// Sub-steps per tick.
    pub substeps: usize,
    /// Nominal length of a sample, s.
    pub tick_s: f64,
    /// None: the torque in the state stays what it is.
    pub disturbance: Option<Disturbance>,
}

impl<'a> Plant<'a> {
    /// In the kind world.
    pub fn new(law: &'a ForceLaw, state: State, substeps: usize) -> Self {
        Self { law, state, drive: Drive::default(), substeps, tick_s: TS, disturbance: None }
    }

    /// Holds the drive u for the sample that starts at session time t, one tick long.
    #[cfg(test)]
    pub fn sample(&mut self, u: f64, t: f64) {
        self.sample_for(u, t, self.tick_s, |_, _| ());
    }

    /// Holds the drive u (V) for `duration` (s) from session time t on. `seen` gets the state at the end of each
    /// sub-step, with its time since t, s. Returns the mean random torque, V.
    pub fn sample_for(&mut self, u: f64, t: f64, duration: f64, mut seen: impl FnMut(f64, &State)) -> f64 {
        let ticks = duration / self.tick_s;
        self.drive.hold(self.law, u, t, ticks);
        // Longer samples get more sub-steps. A millionth is taken off, so that the rounding of a whole tick adds none.
        let substeps = (self.substeps as f64 * ticks - 1e-6).ceil().max(1.0);
        let h = duration / substeps;
        // A delayed edge falls inside the sample, and a sub-step ends there. With jitter none ends there, and the
        // sub-step gets the edge's mean drive.
        let edge = if ticks.to_bits() == 1f64.to_bits() { self.law.delay % self.tick_s } else { 0.0 };
        let mut impulse = 0.0;
        for i in 0..substeps as usize {
            let start = i as f64 * h;
            let end = start + h;
            if self.law.delay > 0.0 && start < edge && edge < end {
                impulse += self.piece(start, edge - start, t);
                impulse += self.piece(edge, end - edge, t);
            } else {
                impulse += self.piece(start, h, t);
            }
            seen(end, &self.state);
        }
        impulse / duration
    }

    /// Returns the random torque's impulse.
    fn piece(&mut self, offset: f64, h: f64, t: f64) -> f64 {
        if let Some(disturbance) = &mut self.disturbance {
            self.state.torque = disturbance.step(h);
        }
        let delivered = self.drive.deliver(self.law, offset, h, self.tick_s);
        self.law.advance(&mut self.state, t + offset, h, delivered);
        h * self.state.torque
    }
}
