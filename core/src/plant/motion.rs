//! Motion of the plant with any effects: fixed sub-steps, an implicit friction law, reversals split where they happen.
//!
//! Within a sub-step the smooth forces are taken at its middle (second order) and the viscous term implicitly. Where
//! the velocity passes zero the sub-step is split there: the body either stays (|force| ≤ break-away level) or goes on
//! with the opposite friction. On the base plant this agrees with the closed form to O(h³) per step.
//!
//! A fit does this some hundred million times. Therefore sums over the effects are loops, because an iterator's
//! `fold` is called for every effect. And a sub-step is one function, because otherwise a number with its derivatives
//! is copied from call to call.
#![allow(clippy::inline_always, reason = "a fifth of a discovery's time")]

use super::base::Base;
use super::effect::{ActsIn, Effect, Held, Instant, MAX_PARAMETERS, Memory};
use crate::scalar::Real;

/// Most effects a plant carries at once.
pub const MAX_EFFECTS: usize = 6;

/// Most sub-steps of a sample period; faster dynamics than that are not resolved.
pub const MAX_SUB_STEPS: usize = 8;

/// Position and velocity of the motor, and what each effect remembers.
#[derive(Clone, Copy, Debug)]
pub struct State<R> {
    /// True position.
    pub x: R,
    /// Velocity.
    pub v: R,
    /// Extra state of each effect.
    pub memory: [Memory<R>; MAX_EFFECTS],
}

/// The applied drive up to now, held from sample to sample.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'a> {
    /// Samples, the last one being applied now; must not be empty.
    pub u: &'a [f64],
    /// Sample period, s.
    pub ts: f64,
    /// Session time of the present sample, s.
    pub t: f64,
}

/// The base model and its effects.
#[derive(Clone, Copy, Debug)]
pub struct Plant<'a, R> {
    /// Base equation.
    pub base: Base<R>,
    /// Effects, at most [`MAX_EFFECTS`]; more are ignored.
    pub effects: &'a [Effect<R>],
}

impl<R: Real> Effect<R> {
    /// The parameters' values. A loop: `array::map` calls its closure for every one, which shows where a simulation is
    /// run on numbers with many derivatives.
    fn plain(&self) -> [f64; MAX_PARAMETERS] {
        let mut p = [0.0; MAX_PARAMETERS];
        for (value, parameter) in p.iter_mut().zip(&self.p) {
            *value = parameter.to_f64();
        }
        p
    }

    /// The mechanics over a whole sample of `h` seconds in which the motor moves from `at.x` at `at.v`, in sub-steps
    /// that resolve them. Returns the mean reaction.
    fn mechanics_in_parts(&self, base: &Base<R>, at: &Instant<R>, memory: &mut Memory<R>, h: f64) -> R {
        let inertia = Base { b: base.b.to_f64(), c: 0.0, f1: 0.0 };
        let bandwidth = self.kind.bandwidth(&self.plain(), &inertia);
        let parts = libm::ceil(h * bandwidth / 0.25).clamp(1.0, MAX_SUB_STEPS as f64);
        let h_part = h / parts;
        let mut sum = R::ZERO;
        for i in 0..parts as usize {
            let x = at.x + at.v.scale(h_part * (i as f64 + 0.5));
            sum += self.mechanics(base, &Instant { x, ..*at }, memory, h_part);
        }
        sum.scale(1.0 / parts)
    }
}

impl<R: Real> Plant<'_, R> {
    /// The effects that act in `place`.
    #[inline(always)]
    fn acting(&self, place: ActsIn) -> impl Iterator<Item = &Effect<R>> {
        self.effects.iter().filter(move |effect| effect.kind.acts_in() == place)
    }

    /// The same with what each remembers.
    #[inline(always)]
    fn remembering<'m>(
        &self,
        memory: &'m mut [Memory<R>; MAX_EFFECTS],
        place: ActsIn,
    ) -> impl Iterator<Item = (&Effect<R>, &'m mut Memory<R>)> {
        self.effects.iter().zip(memory).filter(move |(effect, _)| effect.kind.acts_in() == place)
    }

    /// The plant at rest at `x`.
    pub fn at_rest(&self, x: R) -> State<R> {
        let mut memory = [[R::ZERO; 3]; MAX_EFFECTS];
        for (effect, slot) in self.effects.iter().zip(memory.iter_mut()) {
            *slot = effect.at_rest(x);
        }
        State { x, v: R::ZERO, memory }
    }

    /// Sub-steps of one sample period that resolve the fastest dynamics of the effects.
    pub fn sub_steps(&self, ts: f64) -> usize {
        let base = Base { b: self.base.b.to_f64(), c: self.base.c.to_f64(), f1: self.base.f1.to_f64() };
        let mut fastest = base.c / base.b;
        for effect in self.effects {
            fastest = fastest.max(effect.kind.bandwidth(&effect.plain(), &base));
        }
        let least = self.effects.iter().map(|effect| effect.kind.sub_steps()).max().unwrap_or(1);
        libm::ceil(ts * fastest / 0.25).clamp(least as f64, MAX_SUB_STEPS as f64) as usize
    }

    /// What the sensor reports at true position `x`.
    #[inline(always)]
    pub fn measured(&self, x: R) -> R {
        let mut reading = x;
        for effect in self.acting(ActsIn::Sensor) {
            reading += effect.sensor(x);
        }
        reading
    }

    /// Advances one sample period in `n` sub-steps (see [`Self::sub_steps`]), or one more where the drive that arrives
    /// switches within the sample. No sub-step reaches over that instant, so the drive is exact in each.
    #[inline(always)]
    pub fn advance(&self, state: &mut State<R>, drive: Drive<'_>, n: usize) {
        let edge_s = self.switches_at(drive.ts);
        let parts = |span_s: f64| libm::ceil(n as f64 * span_s / drive.ts) as usize;
        let (before, after) = if edge_s > 0.0 { (parts(edge_s), parts(drive.ts - edge_s)) } else { (0, n) };
        let (h_before, h_after) = (edge_s / before.max(1) as f64, (drive.ts - edge_s) / after as f64);
        let mut from_s = 0.0;
        let shaped = self.effects.iter().any(|effect| effect.kind.shapes_the_drive());
        for i in 0..before + after {
            let h = if i < before { h_before } else { h_after };
            let t = R::from_f64(drive.t + from_s + 0.5 * h);
            let u = self.effective_drive(state, drive, t, from_s, h);
            self.sub_step(state, t, u, h);
            if shaped && state.v != R::ZERO {
                // The mean of the drive gives the velocity. How the drive changes about its mean moves the body too.
                let lead = self.lead(state) / self.inertia(t, state);
                state.x += lead.scale(h * h);
            }
            from_s += h;
        }
    }

    /// The instant within a sample of `ts` seconds at which the drive that arrives switches, s; 0 where it does not.
    #[inline(always)]
    fn switches_at(&self, ts: f64) -> f64 {
        let mut edge_s: f64 = 0.0;
        for effect in self.acting(ActsIn::Drive) {
            edge_s = edge_s.max(effect.switches_at(ts));
        }
        edge_s
    }

    /// See `Law::lead`, of all effects.
    #[inline(always)]
    fn lead(&self, state: &State<R>) -> R {
        let mut sum = R::ZERO;
        for (effect, memory) in self.effects.iter().zip(&state.memory) {
            if effect.kind.shapes_the_drive() {
                sum += effect.lead(memory);
            }
        }
        sum
    }

    /// What the effects add to the balance of forces along an imposed motion, in drive units. The motion has position
    /// `x`, velocity `v` and acceleration `a` at the sample, `b·a + c·v + f1·sgn v − u − (this) = 0` on the true
    /// plant.
    ///
    /// Advances the memories over the sample period; used also to bring them up to date before a segment in the middle
    /// of a recording. Sensor effects act on the measured position and are not in it.
    pub fn effect_force(&self, state: &mut State<R>, drive: Drive<'_>, x: R, v: R, a: R) -> R {
        let h = drive.ts;
        let t = R::from_f64(drive.t + 0.5 * drive.ts);
        state.x = x;
        state.v = v;
        let held = R::from_f64(drive.u.last().copied().unwrap_or(0.0));
        let u = self.effective_drive(state, drive, t, 0.0, drive.ts);
        let at = Instant { t, x, v, u, over_s: h };
        let level = self.level(&at);
        let mut force = self.force(&at) - held;
        let mut inertia = R::ONE;
        let mut bristle = None;
        for (effect, memory) in self.effects.iter().zip(state.memory.iter_mut()) {
            inertia *= effect.inertia(t, memory);
            if effect.kind.acts_in() != ActsIn::Mechanics {
                continue;
            }
            if effect.kind.bristles() {
                bristle = Some(effect.bristle(level, v, memory, h));
            }
            force += effect.mechanics_in_parts(&self.base, &at, memory, drive.ts);
            let (mut x_end, mut v_end) = (x + v.scale(h), v);
            effect.impact(&mut x_end, &mut v_end, memory, h);
            force += self.base.b * (v_end - v).scale(1.0 / h);
        }
        let friction = bristle.unwrap_or(level * v.sgn());
        force + self.base.f1 * v.sgn() - friction - (inertia - R::ONE) * self.base.b * a
    }

    #[inline(always)]
    fn effective_drive(&self, state: &mut State<R>, drive: Drive<'_>, t: R, from_s: f64, h: f64) -> R {
        let u = R::from_f64(drive.u.last().copied().unwrap_or(0.0));
        let mut at = Instant { t, x: state.x, v: state.v, u, over_s: h };
        let past = Held { u: drive.u, ts: drive.ts, from_s };
        let mut place = Some(0);
        while let Some(here) = place.take() {
            for (effect, memory) in self.remembering(&mut state.memory, ActsIn::Drive) {
                let own = effect.kind.along_the_drive();
                if own == here {
                    at.u = effect.drive(&at, past, memory, h);
                } else if own > here && place.is_none_or(|next| own < next) {
                    place = Some(own);
                }
            }
        }
        at.u
    }

    #[inline(always)]
    fn level(&self, at: &Instant<R>) -> R {
        let mut level = self.base.f1;
        for effect in self.acting(ActsIn::Force) {
            level += effect.level(&self.base, at);
        }
        level.max(R::ZERO)
    }

    #[inline(always)]
    fn force(&self, at: &Instant<R>) -> R {
        let mut force = at.u;
        for effect in self.acting(ActsIn::Force) {
            force += effect.force(at);
        }
        force
    }

    #[inline(always)]
    fn breakaway(&self, at: &Instant<R>) -> R {
        let mut level = self.level(at);
        for effect in self.acting(ActsIn::Force) {
            level += effect.breakaway();
        }
        level
    }

    #[inline(always)]
    fn sub_step(&self, state: &mut State<R>, t: R, u: R, h: f64) {
        if self.effects.iter().any(|effect| effect.kind.acts_in() == ActsIn::Mechanics) {
            return self.sub_step_with_memory(state, t, u, h);
        }
        let (x0, v0) = (state.x, state.v);
        let start = Instant { t, x: x0, v: v0, u, over_s: h };
        let mut sgn = v0.sgn();
        if v0 == R::ZERO {
            let force = self.force(&start);
            if force.abs() <= self.breakaway(&start) {
                return;
            }
            sgn = force.sgn();
        }
        let b = self.inertia(t, state);
        let mut mid = start;
        if !self.effects.is_empty() {
            // The base's own forces predict the middle: an effect's share in that is of third order.
            let a0 = (u - self.base.f1 * sgn - self.base.c * v0) / b;
            mid = Self::middle(&start, v0 + a0.scale(0.5 * h), sgn, h);
        }
        let net = self.force(&mid) - self.level(&mid) * sgn;
        self.finish(state, &mid, R::ZERO, b, net, sgn, h);
    }

    /// As [`Self::sub_step`], beside bristles or a second body: their reaction is predicted too.
    fn sub_step_with_memory(&self, state: &mut State<R>, t: R, u: R, h: f64) {
        let (x0, v0) = (state.x, state.v);
        let b = self.inertia(t, state);
        let start = Instant { t, x: x0, v: v0, u, over_s: h };
        let bristles = self.effects.iter().any(|effect| effect.kind.bristles());
        let at_rest = !bristles && v0 == R::ZERO;
        let rest = if at_rest { self.force(&start) } else { R::ZERO };
        let sgn = match (bristles, at_rest) {
            (true, _) => R::ZERO,
            (_, true) => rest.sgn(),
            _ => v0.sgn(),
        };
        let sliding = |at: &Instant<R>| if bristles { R::ZERO } else { self.level(at) * sgn };
        let a0 = (self.force(&start) + self.predicted_reaction(&start, &state.memory, bristles, h)
            - sliding(&start)
            - self.base.c * v0)
            / b;
        let mid = Self::middle(&start, v0 + a0.scale(0.5 * h), sgn, h);
        let reaction = self.reaction(&mid, &mut state.memory, bristles, h);
        let stuck = at_rest && (rest + reaction).abs() <= self.breakaway(&start);
        if !stuck {
            self.finish(state, &mid, reaction, b, self.force(&mid) + reaction - sliding(&mid), sgn, h);
        }
        for (effect, memory) in self.remembering(&mut state.memory, ActsIn::Mechanics) {
            effect.impact(&mut state.x, &mut state.v, memory, h);
        }
    }

    /// The middle of a sub-step, given the velocity expected there; friction does not carry past zero.
    #[inline(always)]
    fn middle(start: &Instant<R>, v_mid: R, sgn: R, h: f64) -> Instant<R> {
        let v = if v_mid * sgn < R::ZERO { R::ZERO } else { v_mid };
        Instant { x: start.x + (start.v + v).scale(0.25 * h), v, ..*start }
    }

    #[inline(always)]
    fn inertia(&self, t: R, state: &State<R>) -> R {
        let mut b = self.base.b;
        for (effect, memory) in self.effects.iter().zip(state.memory.iter()) {
            b *= effect.inertia(t, memory);
        }
        b
    }

    /// Mean force of bristles and second bodies on the motor over a sub-step; advances their memories.
    #[inline(always)]
    fn reaction(&self, mid: &Instant<R>, memory: &mut [Memory<R>; MAX_EFFECTS], bristles: bool, h: f64) -> R {
        let level = if bristles { self.level(mid) } else { R::ZERO };
        let mut sum = R::ZERO;
        for (effect, slot) in self.remembering(memory, ActsIn::Mechanics) {
            sum += self.reaction_of(effect, level, mid, slot, h);
        }
        sum
    }

    /// The same, the memories left as they are.
    #[inline(always)]
    fn predicted_reaction(&self, at: &Instant<R>, memory: &[Memory<R>; MAX_EFFECTS], bristles: bool, h: f64) -> R {
        let level = if bristles { self.level(at) } else { R::ZERO };
        let mut sum = R::ZERO;
        for (effect, slot) in self.remembering(&mut memory.clone(), ActsIn::Mechanics) {
            sum += self.reaction_of(effect, level, at, slot, h);
        }
        sum
    }

    #[inline(always)]
    fn reaction_of(&self, effect: &Effect<R>, level: R, mid: &Instant<R>, memory: &mut Memory<R>, h: f64) -> R {
        let held = if effect.kind.bristles() { -effect.bristle(level, mid.v, memory, h) } else { R::ZERO };
        held + effect.mechanics(&self.base, mid, memory, h)
    }

    /// Moves on under the net force; where the velocity would pass zero against `sgn` the sub-step is split.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    fn finish(&self, state: &mut State<R>, mid: &Instant<R>, reaction: R, b: R, net: R, sgn: R, h: f64) {
        let v0 = state.v;
        let inertia = b.scale(1.0 / h);
        let drag = self.base.c.scale(0.5);
        let v1 = ((inertia - drag) * v0 + net) / (inertia + drag);
        if v1 * sgn >= R::ZERO {
            state.x += (v0 + v1).scale(0.5 * h);
            state.v = v1;
        } else {
            self.reverse(state, mid, reaction, b, v1, h);
        }
    }

    /// The velocity passes zero within the sub-step: up to there with the old friction, then stick or go on.
    fn reverse(&self, state: &mut State<R>, mid: &Instant<R>, reaction: R, b: R, v1: R, h: f64) {
        let v0 = state.v;
        let before = (v0 / (v0 - v1)).scale(h);
        let after = R::from_f64(h) - before;
        let x_zero = state.x + (v0 * before).scale(0.5);
        let at_zero = Instant { x: x_zero, v: R::ZERO, ..*mid };
        let force = self.force(&at_zero) + reaction;
        state.x = x_zero;
        state.v = R::ZERO;
        if force.abs() <= self.breakaway(&at_zero) || force.sgn() == v0.sgn() {
            return;
        }
        let a = (force - self.level(&at_zero) * force.sgn()) / b;
        let v = a * after / (R::ONE + (self.base.c * after / b).scale(0.5));
        state.x += (v * after).scale(0.5);
        state.v = v;
    }
}
