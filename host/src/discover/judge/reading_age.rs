//! The age of held readings: how much later than the position the drive is written.
//!
//! A sensor with a clock of its own gives a position that is up to one interval old. A bus adds its own time. The drive is
//! exact only beside a position of its own age, so the age is found before anything else. Whether it is so long that it
//! delays the loop is decided later (`clock.rs`).

use super::dataset::Dataset;
use super::regression::rms;
use super::ruling::narrowest;
use super::settings::Settings;
use super::sides::Model;
use super::term::{Arrival, Name, Term};
use super::weak_form::WeakForm;
use super::weights::Weights;
use crate::fit::golden_section;
use crate::recording::Recording;

/// Ages that are tried before the best is refined between its neighbours.
const GRID: usize = 16;
/// Golden sections: they find the age to a thousandth of a step of the grid.
const SECTIONS: usize = 14;

/// The age at which the drive leaves least of the acceleration, s. `None` where no reading is held, or where the
/// recordings hold too little motion. Also `None` where the best age is the longest that the sensor's clock explains.
pub fn reading_age_s(recordings: &[Recording], settings: &Settings) -> Option<f64> {
    let dataset = Dataset::new(recordings, settings);
    let most = dataset.unsure_s;
    if most <= 0.0 {
        return None;
    }
    let form = WeakForm::new(&dataset, narrowest(&dataset, settings)?, settings)?;
    let step = most / GRID as f64;
    let left = |age_s: f64| left(&form, age_s, settings);
    let grid = (0..=GRID).map(|i| (i, left(i as f64 * step)));
    let (best, _) = grid.min_by(|a, b| a.1.total_cmp(&b.1))?;
    if best == GRID {
        return None;
    }
    let bracket = [(best as f64 - 1.0).max(0.0) * step, (best as f64 + 1.0) * step];
    Some(golden_section(bracket, SECTIONS, left))
}

/// Rms of the acceleration that the base leaves, where the drive comes `age_s` late; infinite where it cannot be
/// fitted.
fn left(form: &WeakForm<'_>, age_s: f64, settings: &Settings) -> f64 {
    let mut term = Term::force(Name::Decoy("age of the readings"), Vec::new());
    term.drive = Some(Arrival::Delay(age_s));
    let model = Model { terms: vec![term] };
    let fitted = model.fit(form, &Weights::equal(form), settings);
    fitted.map_or(f64::INFINITY, |fitted| rms(&fitted.a.residual))
}
