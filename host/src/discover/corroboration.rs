//! Whether names that the simulated motion alone gives are believed (docs/discovery.md, section 9).

use breakaway_core::plant::{Effect, Kind};

use super::data::{Data, FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::drive_free;
use super::force_residual;
use super::gap::AT_THE_NOISE;
use super::judge::library::tells;
use super::judge::ruling::Ruling;
use super::objections;
use super::outcome::Discovery;
use super::request::Request;
use crate::fit::Candidate;

/// Held-out simulation error, over the sensor's noise, below which a model is near that noise.
const NEAR: f64 = 5.0;
/// Largest share of an error that names may leave. Near the noise it is the held-out simulation error; elsewhere it is
/// the open-loop error.
const HALF: f64 = 0.5;
/// Growth of an error, of the measured force or of the open loop, at which it speaks against a name. Errors of equal
/// models differ by less.
const OBJECTION: f64 = 1.02;
/// Share of the force residual below which names must bring it where the motion does not come near the noise. What is
/// left there is a force, and a true name takes a part of it. An effect that the forces do not tell takes none; it must
/// halve the held-out simulation error instead.
const MATERIAL: f64 = 0.8;
/// Share of the energy that the names of the measured forces explain of them, which names of the motion must explain. A
/// further effect, or a rival that does as well, explains most of it. An effect of another machine explains none.
const AS_MUCH: f64 = 0.5;
/// Width of the windows in which the sensor's noise does not count, over that of the windows in which the judge ruled.
const WIDE: f64 = 4.0;

/// The errors of the model with the names of the simulated motion, beside those of the model without them.
#[derive(Clone, Copy, Debug, Default)]
struct Corroboration {
    /// Held-out simulation error over the sensor's noise: without the names, and with them.
    over_noise: [f64; 2],
    /// Held-out error over 1 s in open loop, position units.
    open_loop: [f64; 2],
    /// The same error of a cubic in time, which does not use the drive.
    drive_free: f64,
    /// Residual of the measured force, drive units; `None` where the recordings hold too few windows, and for a second
    /// body or bristles.
    force: Option<[f64; 2]>,
    /// Energy of the measured force that its own names explain, and that those of the motion explain. `None` as of `force`,
    /// and where an effect acts in less than a window.
    explained: Option<[f64; 2]>,
    /// See [`differs_untold`].
    untold: bool,
}

/// Whether the discovery `small` of the simulated motion replaces `before`, the discovery of the measured forces.
pub(super) fn believed(request: &Request, ruling: Option<&Ruling>, small: &Discovery, before: &Discovery) -> bool {
    if small.effects.is_empty() {
        return small.down_to_the_noise() && ruling.is_some_and(Ruling::tells_nothing_is_missing);
    }
    if ruling.is_some_and(|ruling| objections::any(ruling, &kinds(small), &small.model)) {
        return false;
    }
    if before.over_noise() < AT_THE_NOISE && generalises(&kinds(small), &kinds(before)) {
        return false;
    }
    let witnesses = Corroboration::of(request, ruling, small, before);
    let agree = ruling.is_some_and(|ruling| agree(ruling, &kinds(small), &kinds(before)));
    witnesses.believe(agree, small.down_to_the_noise())
}

fn kinds(found: &Discovery) -> Vec<Kind> {
    found.effects.iter().map(|named| named.kind).collect()
}

/// Whether a law among the `names` of the simulated motion took the place of a special case of it, which the measured forces
/// gave `before`. A law fits no worse than its special cases. So at the noise it is no better, and the special case stays. A
/// spring stayed one, which the motion exchanged for a ripple of a long wave (hidden plant, unkind world, seed 8852).
fn generalises(names: &[Kind], before: &[Kind]) -> bool {
    let lost = || before.iter().filter(|kind| !names.contains(kind));
    let new = names.iter().filter(|kind| !before.contains(kind));
    new.into_iter().any(|kind| lost().any(|special| kind.generalises(*special)))
}

/// Whether the measured forces gave each of the `names` of the simulated motion too. No name may be left `before`. Then the
/// search found a fit of the same names, and no third witness is needed.
fn agree(ruling: &Ruling, names: &[Kind], before: &[Kind]) -> bool {
    before.is_empty() && names.iter().all(|kind| objections::gave(ruling, *kind))
}

/// Whether the names of `small` and of `before` differ, and only by effects that the measured forces do not tell. What
/// is left of the forces is then the same with either.
pub(super) fn differs_untold(small: &Discovery, before: &Discovery) -> bool {
    let has = |found: &Discovery, kind: Kind| found.effects.iter().any(|named| named.kind == kind);
    let differs = |kind: &Kind| has(small, *kind) != has(before, *kind);
    let all = small.effects.iter().chain(&before.effects).map(|named| named.kind);
    let different: Vec<Kind> = all.filter(differs).collect();
    !different.is_empty() && !different.into_iter().any(tells)
}

/// The same as [`believed`] where there is no discovery of the measured forces. The names must come down to the noise. In
/// open loop they must follow no worse than the base, and no worse than the cubic in time.
pub(super) fn stands_alone(request: &Request, ruling: Option<&Ruling>, small: &Discovery) -> bool {
    if small.effects.is_empty() {
        return !small.down_to_the_noise() || ruling.is_some_and(Ruling::tells_nothing_is_missing);
    }
    let (Some(first), Some(last)) = (small.ladder.first(), small.ladder.last()) else { return false };
    let [before, after] = [first, last].map(|rung| rung.holdout_open_loop_rmse);
    let data = Data::new(&request.recordings, &request.holdout, FIT_SEGMENT_S);
    small.down_to_the_noise()
        && !ruling.is_some_and(|ruling| objections::any(ruling, &kinds(small), &small.model))
        && after <= OBJECTION * before
        && drive_free::error(&data).is_none_or(|curve| after <= curve)
}

/// See [`Corroboration::explained`].
fn explained(request: &Request, data: &Data, ruling: &Ruling, small: &Discovery) -> Option<[f64; 2]> {
    let named = ruling.findings.iter().map(|finding| finding.effect);
    let known = request.model.iter().flat_map(|model| model.effects.iter().copied());
    let of_forces: Vec<Effect<f64>> = known.clone().chain(named.clone()).collect();
    let untold = |effect: &Effect<f64>| effect.kind.second_body() || !tells(effect.kind);
    if named.len() == 0 || small.model.effects.iter().chain(&of_forces).any(untold) {
        return None;
    }
    let left = |effects: Vec<Effect<f64>>| {
        let model = Candidate { base: small.model.base, effects };
        force_residual::over_all(data, &model, ruling.half_width_s).map(|left| left * left)
    };
    let without = left(known.collect())?;
    Some([without - left(of_forces)?, without - left(small.model.effects.clone())?])
}

impl Corroboration {
    fn of(request: &Request, ruling: Option<&Ruling>, small: &Discovery, before: &Discovery) -> Self {
        let open_loop = |found: &Discovery| found.ladder.last().map_or(0.0, |rung| rung.holdout_open_loop_rmse);
        let prepared =
            [FIT_SEGMENT_S, SHORT_SEGMENT_S].map(|length| Data::new(&request.recordings, &request.holdout, length));
        let data = prepared.into_iter().find(|data| data.fit.len() >= 3 && !data.score.is_empty());
        let width_s = ruling.map_or(force_residual::HALF_WIDTH_S, |ruling| WIDE * ruling.half_width_s);
        // The measured motion tells neither the start of a second body nor how far bristles bend: they may bend by less
        // than the sensor's noise.
        let untold = |kind: Kind| kind.second_body() || kind.bristles();
        let hides = small.model.effects.iter().chain(&before.model.effects).any(|effect| untold(effect.kind));
        let force = data.as_ref().filter(|_| !hides).and_then(|data| {
            let of = |found: &Discovery| force_residual::held_out(data, &found.model, width_s);
            Some([of(before)?, of(small)?])
        });
        let explained = ruling.zip(data.as_ref()).and_then(|(ruling, data)| explained(request, data, ruling, small));
        Self {
            explained,
            over_noise: [before.over_noise(), small.over_noise()],
            open_loop: [open_loop(before), open_loop(small)],
            drive_free: data.as_ref().and_then(drive_free::error).unwrap_or(f64::INFINITY),
            force,
            untold: differs_untold(small, before),
        }
    }

    /// Whether the names are believed. Those on which forces and motion `agree` need not close the gap.
    fn believe(&self, agree: bool, down_to_the_noise: bool) -> bool {
        !self.loses_the_forces() && (agree && self.follows_by_the_drive() || self.holds(down_to_the_noise))
    }

    /// Whether the names leave most of what the names of the measured forces explain.
    fn loses_the_forces(&self) -> bool {
        self.explained.is_some_and(|[forces, names]| forces > 0.0 && names < AS_MUCH * forces)
    }

    /// Whether the model with the names follows the open loop better than a curve that does not use the drive.
    fn follows_by_the_drive(&self) -> bool {
        let [_, follows] = self.open_loop;
        follows <= self.drive_free
    }

    fn holds(&self, down_to_the_noise: bool) -> bool {
        let [without, with] = self.over_noise;
        let [drifts, follows] = self.open_loop;
        // No model follows impacts for longer than a part of a second. So at the noise the open loop may grow. Where no
        // window of 1 s is held out, both errors are 0.
        let drifts_off = follows > OBJECTION * drifts && with >= AT_THE_NOISE;
        if drifts_off || !self.follows_by_the_drive() {
            return false;
        }
        let force = self.force.map(|[before, after]| after / before);
        if force.is_some_and(|share| share > OBJECTION) && !down_to_the_noise {
            return false;
        }
        let near = with < NEAR.min(HALF * without).max(AT_THE_NOISE);
        let takes_its_part =
            if self.untold { with < HALF * without } else { force.is_some_and(|share| share < MATERIAL) };
        down_to_the_noise || near || takes_its_part && follows < HALF * drifts
    }
}

#[cfg(test)]
mod tests;
