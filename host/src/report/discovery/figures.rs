//! The figures of a discovery.

use super::fold::Fold;
use super::sentence::within_a_sentence;
use crate::discover::outcome::{Discovery, Overlay, WhereRow};
use crate::report::figure::{Bar, Figure, Ink, Series, Step, Strip, bars, bins, fold as fold_sheet, ladder, stack};
use crate::report::text::quantity;

/// The ladder.
pub fn ladder_figure(discovery: &Discovery) -> Figure {
    let mut known = 0;
    let steps: Vec<Step> = discovery
        .ladder
        .iter()
        .map(|rung| {
            let new: Vec<&str> = rung.effects.iter().skip(known).map(|kind| kind.definition().title).collect();
            known = rung.effects.len();
            let label = if new.is_empty() { "base model".to_owned() } else { format!("+ {}", new.join(" + ")) };
            Step { label, open_loop: rung.holdout_open_loop_rmse, holdout: rung.holdout_rmse, fit: rung.fit_rmse }
        })
        .collect();
    let caption = "Error of the simulated position as effects are added to the model. Held-out recordings were never fitted; \
                   the circles are simulated for one second on the drive alone, from a fitted start. Nothing can fall \
                   below the noise.";
    let (noise, unit) = (discovery.noise_floor, &discovery.units.x);
    Figure::new("The ladder", caption, |width| ladder(width, &steps, noise, unit))
}

/// What the base model is called in a legend: before something, if there is an after.
fn base_label(improved: bool) -> &'static str {
    if improved { "before: base model" } else { "base model" }
}

/// Measured and simulated position, what is left between them, and the drive.
pub fn overlay_figure(discovery: &Discovery, overlay: &Overlay) -> Figure {
    let gap = |model: &[f64]| -> Vec<f64> { overlay.measured.iter().zip(model).map(|(x, m)| x - m).collect() };
    let (before, after) = (gap(&overlay.before), gap(&overlay.after));
    let (base, last) = (base_label(!overlay.after.is_empty()), "after: effects added");
    let mut positions = vec![
        Series { ink: Ink::Measured, label: "measured", y: &overlay.measured },
        Series { ink: Ink::Before, label: base, y: &overlay.before },
    ];
    let mut gaps = vec![Series { ink: Ink::Before, label: base, y: &before }];
    if !overlay.after.is_empty() {
        positions.push(Series { ink: Ink::After, label: last, y: &overlay.after });
        gaps.push(Series { ink: Ink::After, label: last, y: &after });
    }
    let units = &discovery.units;
    let strip = |quantity, unit, height, series| Strip { quantity, unit, height, series, band: None, held: false };
    let strips = [
        strip("position", units.x.as_str(), 190.0, positions),
        Strip { band: Some(discovery.noise_floor), ..strip("measured − simulated", &units.x, 120.0, gaps) },
        Strip {
            held: true,
            ..strip("drive", &units.u, 60.0, vec![Series { ink: Ink::Drive, label: "drive", y: &overlay.u }])
        },
    ];
    let strips = if overlay.u.is_empty() { &strips[..2] } else { &strips[..] };
    let title = format!("Measured and simulated, {}", overlay.title);
    let caption = "Held-out data. Above, the broad line is the measurement and the thin one the simulation. Below is \
         their difference, with the noise as a band. At the bottom is the drive, the same for both.";
    Figure::new(title, caption, |width| stack(width, &overlay.t, strips))
}

/// The share of the gap that each coordinate carries.
pub(super) fn map_figure(discovery: &Discovery) -> Figure {
    let added = !discovery.effects.is_empty();
    let rows: Vec<Bar<'_>> = discovery
        .where_map
        .iter()
        .map(|row| Bar { label: row.coordinate, before: row.r2, after: added.then_some(row.r2_after) })
        .collect();
    let caption = if added {
        "Share of the unexplained force that its average over this coordinate predicts (cross-validated R²), for the \
         base model and after the last effect."
    } else {
        "Share of the unexplained force that its average over this coordinate predicts (cross-validated R²)."
    };
    Figure::new("Where the gap is", caption, |width| bars(width, "share of the unexplained force", &rows))
}

/// The residual force over one coordinate.
pub(super) fn curve_figure(discovery: &Discovery, row: &WhereRow) -> Figure {
    let after = if discovery.effects.is_empty() { &[][..] } else { &row.curve_after[..] };
    let caption = "Mean unexplained force in bins, with two standard errors on both sides. A curve away from zero is the \
                   shape of the missing effect.";
    let force = ("unexplained force", discovery.units.u.as_str());
    Figure::new(format!("Unexplained force over {}", row.coordinate), caption, |width| {
        bins(width, (row.coordinate, &row.unit), force, &row.curve, after)
    })
}

/// The force that an effect explains, over one of its periods.
pub(super) fn fold_figure(discovery: &Discovery, fold: &Fold) -> Figure {
    let definition = fold.kind.definition();
    let period = quantity(fold.period, &discovery.units.x, 3);
    let title = format!("{} over one period", definition.title);
    let caption = format!(
        "The force that the model without {} leaves, from all fitted recordings. It is folded onto one period of {period} of \
         the {}. Where the law is right, the means lie on it.",
        within_a_sentence(definition.title),
        fold.coordinate
    );
    let x = format!("{} within the period", fold.coordinate);
    Figure::new(title, caption, |width| {
        let force = ("force", discovery.units.u.as_str());
        fold_sheet(width, (&x, &discovery.units.x), force, &fold.points, &fold.law)
    })
}
