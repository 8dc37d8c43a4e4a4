//! The measured force that a model leaves, in windows of the weak form.

use super::data::Data;
use super::screen::Screen;
use crate::fit::{Candidate, Segment};

/// Half-width of the windows where no ruling gives one, s.
pub(super) const HALF_WIDTH_S: f64 = 0.1;

/// Norm of the measured force that a model leaves in the held-out windows. The model's effects are kept and its base is
/// fitted anew. `None` where there are too few windows.
pub(super) fn held_out(data: &Data, model: &Candidate, half_width_s: f64) -> Option<f64> {
    let over = Data { fit: data.score.clone(), ..data.clone() };
    Some(Screen::of_width(&over, model, half_width_s)?.residual_norm())
}

/// The same in all windows.
pub(super) fn over_all(data: &Data, model: &Candidate, half_width_s: f64) -> Option<f64> {
    let over = Data { fit: data.fit.iter().chain(&data.score).copied().collect(), ..data.clone() };
    Some(Screen::of_width(&over, model, half_width_s)?.residual_norm())
}

/// The share in the fitted segments and in the held-out ones, over the drive's rms there. `None` for a second body, whose
/// force the measured motion does not tell.
pub(super) fn shares(data: &Data, model: &Candidate) -> Option<[f64; 2]> {
    if model.effects.iter().any(|effect| effect.kind.second_body()) {
        return None;
    }
    let share = |segments: &[Segment]| {
        let over = Data { fit: segments.to_vec(), ..data.clone() };
        let force = Screen::of_width(&over, model, HALF_WIDTH_S)?.residual_force();
        let left = force.iter().map(|force| force * force).sum::<f64>() / force.len() as f64;
        let drive = mean_square_drive(data, segments);
        (drive > 0.0).then(|| (left / drive).sqrt())
    };
    Some([share(&data.fit)?, share(&data.score)?])
}

/// Mean square of the drive over segments.
fn mean_square_drive(data: &Data, segments: &[Segment]) -> f64 {
    let drives = segments.iter().flat_map(|own| &data.tracks[own.track].u[own.start..own.start + own.len]);
    let (square, count) = drives.fold((0.0, 0_usize), |(square, count), u| (square + u * u, count + 1));
    square / count.max(1) as f64
}
