//! The state at the start of a segment: the effects' memories of the motion before it.

use std::ops::Range;

use breakaway_core::plant::{Base, Drive, Effect, Plant, State};
use breakaway_core::scalar::Real;

use super::prepare::MeasuredMotion;
use super::{Problem, Segment};

impl Problem<'_> {
    /// The state that the motion before the segment leaves. [`displaced`] moves it to a start.
    pub(super) fn state_before<R: Real>(&self, plant: &Plant<'_, R>, segment: Segment) -> State<R> {
        let track = &self.tracks[segment.track];
        if !plant.effects.iter().any(|effect| effect.kind.remembers()) {
            return plant.at_rest(R::ZERO);
        }
        let piece = track.pieces.partition_point(|&p| p <= segment.start) - 1;
        let earliest = track.pieces[piece];
        let first = segment.start.saturating_sub((self.warm_up_s / track.ts) as usize).max(earliest);
        let before = first..segment.start;
        // A bristle's start is free. So the fit does not need the derivatives of its history.
        if plant.effects.iter().all(|effect| effect.kind.bristles() || !effect.kind.remembers()) {
            let effects: Vec<Effect<f64>> =
                plant.effects.iter().map(|e| Effect { kind: e.kind, p: e.p.map(Real::to_f64) }).collect();
            let base = Base { b: plant.base.b.to_f64(), c: plant.base.c.to_f64(), f1: plant.base.f1.to_f64() };
            let plain = after_motion(&Plant { base, effects: &effects }, before, track);
            State { x: R::ZERO, v: R::ZERO, memory: plain.memory.map(|slot| slot.map(R::from_f64)) }
        } else {
            after_motion(plant, before, track)
        }
    }
}

/// The state before a segment, moved to a start. The start's last two numbers are added to the free memory.
pub(super) fn displaced<R: Real>(plant: &Plant<'_, R>, before: &State<R>, start: [R; 4]) -> State<R> {
    let [x, v, y, w] = start;
    let mut memory = before.memory;
    let mut remembering = plant.effects.iter().zip(memory.iter_mut());
    if let Some((effect, memory)) = remembering.find(|(effect, _)| effect.kind.free_memory() > 0) {
        effect.displaced(x, [y, w], memory);
    }
    State { x, v, memory }
}

/// The effects' memories after the measured motion `before`, from rest.
fn after_motion<R: Real>(plant: &Plant<'_, R>, before: Range<usize>, track: &MeasuredMotion) -> State<R> {
    let mut state = plant.at_rest(R::from_f64(track.xs[before.start]));
    for k in before {
        let drive = Drive { u: &track.u[..=k], ts: track.dt(k), t: track.t[k] };
        plant.effect_force(&mut state, drive, R::from_f64(track.xs[k]), R::from_f64(track.vs[k]), R::ZERO);
    }
    state
}
