//! The page of a tracked reference: errors of all laws on one scale, the motion, the drive.

use std::fmt::Write as _;

use super::figure::{Figure, Ink, Series, Strip, stack};
use super::page::{Page, Section, table};
use super::text::{escape, number, quantity};
use crate::control::tracking::{Bench, Case};
use crate::recording::Units;

/// What the page shows.
#[derive(Clone, Copy, Debug)]
pub struct Story<'a> {
    /// The laws, the PID alone first.
    pub cases: &'a [Case],
    /// The reference, as it was given.
    pub reference: &'a str,
    /// The axis: what was simulated, or the board.
    pub plant: &'a str,
    /// Whether it was a board's axis: then errors are against its encoder.
    pub measured: bool,
    /// Units.
    pub units: &'a Units,
    /// Clock, encoder, limits.
    pub bench: &'a Bench,
}

/// The page as one file.
pub fn html(story: &Story<'_>) -> String {
    let Some((first, last)) = story.cases.first().zip(story.cases.iter().rfind(|case| case.name != "adaptive")) else {
        return String::new();
    };
    let (before, after) = (first.tracked.rms(), last.tracked.rms());
    let x = &story.units.x;
    let page = Page {
        title: "Breakaway tracking".into(),
        badge: if story.measured { "measured" } else { "simulated" }.into(),
        badge_class: "part",
        sentence: format!(
            "Compensation brings the tracking error from {} to {} rms, a factor of {}",
            quantity(before, x, 3),
            quantity(after, x, 3),
            number(before / after, 2)
        ),
        facts: vec![
            ("reference".into(), story.reference.to_owned()),
            ("tick".into(), quantity(story.bench.tick_s, "s", 3)),
            (if story.measured { "axis" } else { "simulated plant" }.into(), story.plant.to_owned()),
            ("ticks of delay".into(), story.bench.delay_ticks.to_string()),
            ("encoder step".into(), quantity(story.bench.encoder_step, x, 3)),
        ],
        lead: errors(story).html(),
        sections: vec![Section::new("In numbers", numbers(story)), Section::new("The motion", motion(story).html())],
    };
    page.html()
}

/// Length of the drawn stretch at most, as a share of the run's counted part: about two periods of ten.
const DRAWN: f64 = 0.25;

/// The samples that are drawn: from the first that counts.
fn drawn(case: &Case) -> std::ops::Range<usize> {
    let n = case.tracked.error.len();
    let from = case.tracked.from.min(n);
    from..(from + ((n - from) as f64 * DRAWN).ceil() as usize).min(n)
}

const fn ink(name: &str) -> Ink {
    // Names are ours; their first letters differ.
    match name.as_bytes() {
        [b'p', ..] => Ink::Before,
        [b'b', ..] => Ink::Drive,
        [b'm', ..] => Ink::After,
        _ => Ink::Floor,
    }
}

/// The errors: all together, and the compensated ones enlarged.
pub fn errors(story: &Story<'_>) -> Figure {
    let Some(first) = story.cases.first() else { return Figure::new("", "", |w| stack(w, &[], &[])) };
    let range = drawn(first);
    let t = &first.tracked.recording.t[range.clone()];
    let series = |case: &'_ Case| -> Vec<f64> { case.tracked.error[range.clone()].to_vec() };
    let all: Vec<Vec<f64>> = story.cases.iter().map(series).collect();
    let lines = |skip: usize| {
        story
            .cases
            .iter()
            .zip(&all)
            .skip(skip)
            .map(|(case, y)| Series { ink: ink(case.name), label: case.title, y })
            .collect()
    };
    let strip =
        |quantity, series, height, band| Strip { quantity, unit: &story.units.x, height, series, band, held: false };
    let band = (story.bench.encoder_step > 0.0).then_some(story.bench.encoder_step);
    let strips = [
        strip("tracking error, all", lines(0), 150.0, None),
        strip("tracking error, compensated", lines(1), 190.0, band),
    ];
    let position = if story.measured { "measured" } else { "true" };
    let caption = format!(
        "Reference minus {position} position. Below without the PID alone, on a scale of its own; the band is one encoder \
         step either way."
    );
    Figure::new("Tracking error", &caption, |width| stack(width, t, &strips))
}

/// Every figure of the page, in its order.
pub fn figures(story: &Story<'_>) -> Vec<Figure> {
    vec![errors(story), motion(story)]
}

fn motion(story: &Story<'_>) -> Figure {
    let (Some(first), Some(last)) = (story.cases.first(), story.cases.iter().rfind(|case| case.name != "adaptive"))
    else {
        return Figure::new("", "", |w| stack(w, &[], &[]));
    };
    let range = drawn(first);
    let t = &first.tracked.recording.t[range.clone()];
    let reference = &first.tracked.reference[range.clone()];
    let path = |case: &Case| -> Vec<f64> {
        range.clone().map(|k| case.tracked.reference[k] - case.tracked.error[k]).collect()
    };
    let (before, after) = (path(first), path(last));
    let (u_before, u_after) = (&first.tracked.recording.u[range.clone()], &last.tracked.recording.u[range.clone()]);
    let strips = [
        Strip {
            quantity: "position",
            unit: &story.units.x,
            height: 170.0,
            series: vec![
                Series { ink: Ink::Measured, label: "reference", y: reference },
                Series { ink: ink(first.name), label: first.title, y: &before },
                Series { ink: ink(last.name), label: last.title, y: &after },
            ],
            band: None,
            held: false,
        },
        Strip {
            quantity: "drive",
            unit: &story.units.u,
            height: 130.0,
            series: vec![
                Series { ink: ink(first.name), label: first.title, y: u_before },
                Series { ink: ink(last.name), label: last.title, y: u_after },
            ],
            band: None,
            held: true,
        },
    ];
    Figure::new("Position and drive", "The drive is what was applied.", |width| stack(width, t, &strips))
}

fn numbers(story: &Story<'_>) -> String {
    let x = &story.units.x;
    let best = story.cases.iter().map(|case| case.tracked.rms()).fold(f64::INFINITY, f64::min);
    let before = story.cases.first().map_or(f64::NAN, |case| case.tracked.rms());
    let rows: Vec<_> = story
        .cases
        .iter()
        .map(|case| {
            let rms = case.tracked.rms();
            let steps =
                if story.bench.encoder_step > 0.0 { number(rms / story.bench.encoder_step, 3) } else { "–".into() };
            let cells = vec![
                escape(case.title),
                escape(&quantity(rms, x, 3)),
                escape(&quantity(case.tracked.peak(), x, 3)),
                steps,
                number(before / rms, 3),
                escape(&quantity(case.tracked.drive_rms(), &story.units.u, 3)),
            ];
            (rms == best, cells)
        })
        .collect();
    let columns =
        [("", ""), ("rms", "n"), ("peak", "n"), ("rms in steps", "n"), ("PID alone over it", "n"), ("drive, rms", "n")];
    let mut out = table(&columns, &rows);
    // Writing to a String cannot fail.
    let note = if story.measured {
        "Errors are those of the encoder's reading. Its rounding is half a step either way; smaller errors cannot be \
         seen."
    } else {
        "Errors are those of the true position, which a real axis does not know. An error below a step of the \
         encoder is an average over many steps."
    };
    let _ = writeln!(out, "<p class=\"note\">{note}</p>");
    out
}
