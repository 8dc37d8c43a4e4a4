//! Drive and position in each other's place.

use super::equation_error::{SIGNIFICANCE, both_directions, from_weak, negative, solve_base, unexplained};
use super::weak;
use crate::fit::session;
use crate::recording::Recording;

/// Share of what one assignment of the columns leaves unexplained below which the other one is the right one. A controller makes
/// the drive follow the position, and the two then look alike to a factor of two or three.
const MUCH_BETTER: f64 = 0.2;

/// Swaps drive and position, and returns the root mean square of the drive that stays unexplained then, over the drive's.
///
/// `None` if the swapped columns are no axis: inertia must be positive beyond its error, and no friction negative. `None`
/// too if they do not explain more than the columns as they are, which leave `left`: by any amount if `any`, else by much.
/// An axis whose columns are swapped leads its drive, as if friction gave power.
pub(super) fn explains_more(recordings: &[Recording], left: f64, any: bool) -> Option<f64> {
    let swap = |r: &Recording| Recording { u: r.x.clone(), x: r.u.clone(), encoder_step: None, ..r.clone() };
    let windows = weak::windows(&session(&recordings.iter().map(swap).collect::<Vec<_>>()));
    if windows.len() < 12 {
        return None;
    }
    let both = both_directions(&windows);
    let fit = solve_base(&windows, both).ok()?;
    let estimate = from_weak(&fit, both);
    let is_axis = estimate.b.value > SIGNIFICANCE * estimate.b.se && !negative(estimate.c) && !negative(estimate.f1);
    let most = if any { left } else { MUCH_BETTER * left };
    is_axis.then(|| unexplained(&fit, &windows)).filter(|other| *other < most)
}
