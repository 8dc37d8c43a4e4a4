//! The page of an identification: measured and fitted limit cycles, the sine fits, the model and the estimators.

use std::fmt::Write as _;

use super::choice;
use super::figure::{Figure, Ink, Loop, Series, Strip, loops, stack};
use super::page::{Section, list, table};
use super::text::{escape, number, quantity, with_error};
use crate::identify::estimate::{Identification, Value};
use crate::identify::typical::Typical;
use crate::recording::Units;
use crate::sine::SineFit;
use breakaway_core::plant::Base;

/// A span of motion, measured and simulated on the same drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Span {
    /// Time, s.
    pub t: Vec<f64>,
    /// Drive.
    pub u: Vec<f64>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// Position simulated with the identified model, from a fitted initial state.
    pub simulated: Vec<f64>,
    /// The fitted sine; empty for none.
    pub sine: Vec<f64>,
}

/// One relay experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Its name.
    pub name: String,
    /// Amplitude on the error, drive units.
    pub h1: f64,
    /// Amplitude on the error's integral, drive units.
    pub h2: f64,
    /// The sine fitted to the settled part.
    pub sine: SineFit,
    /// Two settled periods or so.
    pub span: Span,
    /// The measured cycle in the plane: positions and velocities.
    pub measured: [Vec<f64>; 2],
    /// The cycle that the identified model makes under the same relay.
    pub predicted: [Vec<f64>; 2],
}

/// What the page shows.
#[derive(Clone, Debug)]
pub struct Story<'a> {
    /// The relay experiments; at least one.
    pub cycles: Vec<Cycle>,
    /// The identified model.
    pub identified: &'a Identification,
    /// Units.
    pub units: Units,
    /// The true model, in a demonstration.
    pub truth: Option<Base<f64>>,
}

/// The parts of the page.
pub fn sections(story: &Story<'_>) -> Vec<Section> {
    let mut out = vec![Section::new("The relay experiments", relay(story)), Section::new("The model", model(story))];
    let remarks: Vec<String> = story
        .identified
        .undetermined
        .iter()
        .map(|missing| format!("{}: {}", missing.parameter, missing.advice))
        .chain(story.identified.remarks.iter().map(ToString::to_string))
        .collect();
    if !remarks.is_empty() {
        out.push(Section::new("What the data cannot tell", list(&remarks)));
    }
    out
}

/// All limit cycles in the plane of position and velocity.
pub fn limit_cycles(story: &Story<'_>) -> Figure {
    let mut curves = Vec::new();
    for cycle in &story.cycles {
        let [x, y] = &cycle.measured;
        curves.push(Loop { ink: Ink::Measured, label: "measured", x, y });
    }
    for cycle in &story.cycles {
        let [x, y] = &cycle.predicted;
        curves.push(Loop { ink: Ink::After, label: "identified model under the same relay", x, y });
    }
    let unit = &story.units.x;
    let speed = format!("{unit}/s");
    let caption = "Each relay experiment settles into a closed loop whose size and speed depend on inertia and friction. \
                   The loops of the identified model run in the middle of the measured ones.";
    Figure::new("Limit cycles, measured and predicted", caption, |width| {
        loops(width, ("position", unit), ("velocity", &speed), &curves)
    })
}

fn span_figure(story: &Story<'_>, cycle: &Cycle) -> Figure {
    let title = format!("Relay at h1 = {}, h2 = {} {}", cycle.h1, cycle.h2, story.units.u);
    let caption = "The simulation is given an initial position and velocity and the recorded drive, nothing else. The band \
                   is the noise of the position.";
    drawn(&cycle.span, &story.units, story.identified.noise, &title, caption)
}

fn drawn(span: &Span, units: &Units, noise: f64, title: &str, caption: &str) -> Figure {
    let mut positions = vec![Series { ink: Ink::Measured, label: "measured", y: &span.measured }];
    if !span.sine.is_empty() {
        positions.push(Series { ink: Ink::Before, label: "fitted sine", y: &span.sine });
    }
    positions.push(Series { ink: Ink::After, label: "simulated", y: &span.simulated });
    let gap: Vec<f64> = span.measured.iter().zip(&span.simulated).map(|(x, s)| x - s).collect();
    let strips = [
        Strip { quantity: "position", unit: &units.x, height: 190.0, series: positions, band: None, held: false },
        Strip {
            quantity: "measured − simulated",
            unit: &units.x,
            height: 90.0,
            series: vec![Series { ink: Ink::After, label: "simulated", y: &gap }],
            band: Some(noise),
            held: false,
        },
        Strip {
            quantity: "drive",
            unit: &units.u,
            height: 70.0,
            series: vec![Series { ink: Ink::Drive, label: "drive", y: &span.u }],
            band: None,
            held: true,
        },
    ];
    Figure::new(title, caption, |width| stack(width, &span.t, &strips))
}

/// A stretch of a recording, measured and simulated with the identified model; `noise` is that of the position.
pub fn typical_figure(found: &Typical, units: &Units, noise: f64) -> Figure {
    let Typical { name, t, u, measured, simulated } = found;
    let span =
        Span { t: t.clone(), u: u.clone(), measured: measured.clone(), simulated: simulated.clone(), sine: Vec::new() };
    let title = format!("Measured and simulated, {name}, from t = {:.2} s", t.first().copied().unwrap_or(0.0));
    let caption = "One second on which the error of the simulation is the median of the recording's. The simulation is given \
                   an initial position and velocity and the recorded drive, nothing else. The band is the noise of the position.";
    drawn(&span, units, noise, &title, caption)
}

fn relay(story: &Story<'_>) -> String {
    let mut out = limit_cycles(story).html();
    let rows: Vec<_> = story
        .cycles
        .iter()
        .map(|cycle| {
            let (fit, x) = (&cycle.sine, &story.units.x);
            let cells = vec![
                format!("{} + {} {}", cycle.h1, cycle.h2, escape(&story.units.u)),
                escape(&format!("{} {x}", with_error(fit.amplitude, fit.se.amplitude))),
                escape(&format!("{} rad/s", with_error(fit.omega_rad_s, fit.se.omega_rad_s))),
                escape(&format!("{} {x}", with_error(fit.offset, fit.se.offset))),
                number(fit.cycles, 3),
            ];
            (false, cells)
        })
        .collect();
    let columns = [("h1 + h2", "q"), ("amplitude", "q"), ("ω", "q"), ("offset", "q"), ("cycles", "n")];
    out.push_str("<p>A sine fitted to the settled part of each:</p>\n");
    out.push_str(&table(&columns, &rows));
    if let Some(cycle) = story.cycles.first() {
        out.push_str(&span_figure(story, cycle).html());
    }
    out
}

fn model(story: &Story<'_>) -> String {
    let (best, units) = (&story.identified.best, &story.units);
    let truth = story.truth.map(|base| [base.b, base.c, base.f1]);
    let mut columns = vec![("", ""), ("value ± standard error", "q"), ("unit", ""), ("what it is", "w")];
    if truth.is_some() {
        columns.extend([("true", "n"), ("off by", "n")]);
    }
    let rows: [(&str, Value, String, &str); 3] = [
        ("b", best.b, units.of_b(), "inertia over motor gain"),
        ("c", best.c, units.of_c(), "viscous friction and back-EMF"),
        ("f1", best.f1, units.of_f1(), "Coulomb friction"),
    ];
    let rows: Vec<_> = rows
        .into_iter()
        .enumerate()
        .map(|(i, (symbol, value, unit, meaning))| {
            let number_ = escape(&with_error(value.value, value.se));
            let mut cells = vec![format!("<i>{symbol}</i>"), number_, escape(&unit), meaning.to_owned()];
            if let Some(truth) = truth {
                cells.extend([number(truth[i], 4), escape(&percent(value.value, truth[i]))]);
            }
            (false, cells)
        })
        .collect();
    let mut out = format!("<p class=\"law\">b·ẍ + c·ẋ + f1·sgn ẋ = u</p>\n{}", table(&columns, &rows));
    out.push_str("<h3>By estimator</h3>\n");
    let rows: Vec<_> = story
        .identified
        .estimates
        .iter()
        .map(|estimate| {
            let mut cells = vec![escape(&estimate.estimator.replace('_', " "))];
            for (i, value) in [estimate.b, estimate.c, estimate.f1].into_iter().enumerate() {
                let mut cell = escape(&with_error(value.value, value.se));
                if let Some(truth) = truth {
                    let _ =
                        write!(cell, "<br><span class=\"note\">({})</span>", escape(&percent(value.value, truth[i])));
                }
                cells.push(cell);
            }
            (estimate.estimator == best.estimator, cells)
        })
        .collect();
    out.push_str(&table(&[("estimator", ""), ("b", "q"), ("c", "q"), ("f1", "q")], &rows));
    let mut sentences = vec![format!("Reported: {}.", choice::choice(&story.identified.choice))];
    sentences.extend(story.identified.gravity.iter().map(|trial| format!("Note: {}.", choice::gravity(trial))));
    // Writing to a String cannot fail.
    for sentence in sentences {
        let _ = writeln!(out, "<p>{}</p>", escape(&sentence));
    }
    let _ = writeln!(
        out,
        "<p class=\"note\">Noise of the position {}; simulation error over 0.4 s {}.</p>",
        escape(&quantity(story.identified.noise, &units.x, 3)),
        escape(&quantity(story.identified.simulation_error, &units.x, 3)),
    );
    out
}

/// How far a value is off the truth, with sign, in per cent.
pub fn percent(value: f64, truth: f64) -> String {
    let off = 100.0 * (value - truth) / truth;
    if off.abs() < 0.001 {
        return "< 0.001 %".to_owned();
    }
    let sign = if off > 0.0 { "+" } else { "" };
    format!("{sign}{} %", number(off, 2))
}
