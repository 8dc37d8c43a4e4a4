//! Whether names that the simulated motion alone gives are believed (docs/discovery.md, section 9).

use breakaway_core::plant::Effect;

use super::data::{Data, FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::drive_free;
use super::engine::Request;
use super::judge::ruling::Ruling;
use super::outcome::Discovery;
use super::screen::Screen;
use crate::identify::shooting::Candidate;

/// Held-out simulation error over the sensor's noise below which a model is near that noise.
const NEAR: f64 = 5.0;
/// Share of an error that names near the noise may leave of it, at the most, and share of the open-loop error that others may.
const HALF: f64 = 0.5;
/// Growth of the force residual at which the measured forces object to a name.
const OBJECTION: f64 = 1.02;
/// Share of the force residual that names must leave below where the motion does not come near the noise: what is left then is a force,
/// and a true name takes a part of it.
const MATERIAL: f64 = 0.8;
/// Windows of the measured forces where the judge has none, half-width in s.
const HALF_WIDTH_S: f64 = 0.1;
/// Those of the judge's windows in which the sensor's noise does not count, over those in which it ruled.
const WIDE: f64 = 4.0;

/// What the names of the simulated motion come to, beside the model without them.
#[derive(Clone, Copy, Debug, Default)]
struct Corroboration {
    /// Held-out simulation error over the sensor's noise: without the names, and with them.
    over_noise: [f64; 2],
    /// Held-out error over 1 s in open loop, position units.
    open_loop: [f64; 2],
    /// The same of a curve that knows nothing of the drive.
    drive_free: f64,
    /// Residual of the measured force, drive units; none where the recordings hold too few windows.
    force: Option<[f64; 2]>,
}

/// Whether `small`, which the simulated motion found, is believed in place of `before`, which the measured forces bear out.
pub(super) fn believed(request: &Request, ruling: Option<&Ruling>, small: &Discovery, before: &Discovery) -> bool {
    if small.effects.is_empty() {
        return small.down_to_the_noise() && ruling.is_some_and(Ruling::tells_nothing_is_missing);
    }
    Corroboration::of(request, ruling, small, before).holds(small.down_to_the_noise())
}

/// The same where the measured forces bear nothing out: the names come down to the noise, and do better than the base and the curve.
pub(super) fn stands_alone(request: &Request, small: &Discovery) -> bool {
    let (Some(first), Some(last)) = (small.ladder.first(), small.ladder.last()) else { return false };
    let [before, after] = [first, last].map(|rung| rung.holdout_open_loop_rmse);
    let data = Data::new(&request.recordings, &request.holdout, FIT_SEGMENT_S);
    small.effects.is_empty()
        || small.down_to_the_noise() && after <= before && drive_free::error(&data).is_none_or(|curve| after <= curve)
}

impl Corroboration {
    fn of(request: &Request, ruling: Option<&Ruling>, small: &Discovery, before: &Discovery) -> Self {
        let open_loop = |found: &Discovery| found.ladder.last().map_or(0.0, |rung| rung.holdout_open_loop_rmse);
        let prepared =
            [FIT_SEGMENT_S, SHORT_SEGMENT_S].map(|length| Data::new(&request.recordings, &request.holdout, length));
        let data = prepared.into_iter().find(|data| data.fit.len() >= 3 && !data.score.is_empty());
        let width_s = ruling.map_or(HALF_WIDTH_S, |ruling| WIDE * ruling.half_width_s);
        // The force of a second body follows from where it began, which the measured motion does not tell.
        let bodies = small.model.effects.iter().chain(&before.model.effects).any(|effect| effect.kind.second_body());
        let force = data.as_ref().filter(|_| !bodies).and_then(|data| {
            let of = |found: &Discovery| force_residual(data, &found.model, width_s);
            Some([of(before)?, of(small)?])
        });
        Self {
            over_noise: [before.over_noise(), small.over_noise()],
            open_loop: [open_loop(before), open_loop(small)],
            drive_free: data.as_ref().and_then(drive_free::error).unwrap_or(f64::INFINITY),
            force,
        }
    }

    fn holds(&self, down_to_the_noise: bool) -> bool {
        let [without, with] = self.over_noise;
        let [drifts, follows] = self.open_loop;
        // Where no window of 1 s is held out, both errors are 0.
        if follows > drifts || follows > self.drive_free {
            return false;
        }
        let force = self.force.map(|[before, after]| after / before);
        if force.is_some_and(|share| share > OBJECTION) && !down_to_the_noise {
            return false;
        }
        let near = with < NEAR.min(HALF * without);
        down_to_the_noise || near || force.is_some_and(|share| share < MATERIAL) && follows < HALF * drifts
    }
}

/// Root of the sum of squares that the measured force leaves in the held-out windows, with the effects of a model as they are and a base
/// of their own.
fn force_residual(data: &Data, model: &Candidate, half_width_s: f64) -> Option<f64> {
    let held_out = Data { fit: data.score.clone(), ..data.clone() };
    let effects: Vec<Effect<f64>> = model.effects.clone();
    let screen = Screen::of_width(&held_out, &Candidate { base: model.base, effects }, half_width_s)?;
    Some(screen.residual_norm())
}
