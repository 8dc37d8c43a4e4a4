//! A frequency response for people: what stands out in it, a table, and the drawing.

use std::f64::consts::PI;
use std::fmt::Write as _;

use super::figure::{Figure, Reading, bode};
use super::text::{number, with_error};
use crate::recording::Units;
use crate::response::{FrequencyResponse, Mode, Point};

/// Rows of the table in a decade of frequencies.
const ROWS_PER_DECADE: f64 = 8.0;

/// What is doubtful: kind and sentence.
pub fn remarks(found: &FrequencyResponse) -> Vec<(&'static str, String)> {
    let mut remarks = Vec::new();
    if found.interpolated {
        let text =
            "the clock jitters, so that the position was interpolated; gains near half the sampling rate are too small";
        remarks.push(("interpolated", text.to_owned()));
    }
    for mode in found.resonances.iter().chain(&found.antiresonances).filter(|mode| found.is_narrow(mode)) {
        let at_hz = number(mode.frequency_hz.value, 3);
        let text = format!(
            "segments widen what is at {at_hz} Hz, and its damping ratio is too large; give a longer --segment"
        );
        remarks.push(("narrow", text));
    }
    remarks
}

/// Unit of the gain.
pub fn gain_unit(units: &Units) -> String {
    format!("{}/{}", units.x, units.u)
}

/// The page.
pub fn page(found: &FrequencyResponse, units: &Units, left_out: &[String]) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let mut say = |line: std::fmt::Arguments<'_>| {
        let _ = writeln!(text, "{line}");
    };
    let coherent: Vec<&Point> = found.coherent().collect();
    say(format_args!(
        "{} segments of {} s, {} Hz between frequencies",
        found.segments,
        number(found.segment_s, 3),
        number(found.segment_s.recip(), 3)
    ));
    if let (Some(first), Some(last)) = (coherent.first(), coherent.last()) {
        say(format_args!(
            "coherent at {} of {} frequencies, from {} to {} Hz\n",
            coherent.len(),
            found.points.len(),
            number(first.frequency_hz, 3),
            number(last.frequency_hz, 3)
        ));
    }
    let kinds = [("antiresonance", &found.antiresonances), ("resonance", &found.resonances)];
    let mut modes: Vec<(&str, &Mode)> =
        kinds.iter().flat_map(|(name, modes)| modes.iter().map(|mode| (*name, mode))).collect();
    modes.sort_by(|a, b| a.1.frequency_hz.value.total_cmp(&b.1.frequency_hz.value));
    for (name, Mode { frequency_hz, damping_ratio }) in &modes {
        let frequency = with_error(frequency_hz.value, frequency_hz.se);
        let damping = with_error(damping_ratio.value, damping_ratio.se);
        say(format_args!("{name:<15}{frequency:>18} Hz   damping ratio {damping}"));
    }
    if modes.is_empty() {
        say(format_args!("no resonance and no antiresonance where the response is coherent"));
    }
    match found.delay_s {
        Some(delay) => {
            say(format_args!("{:<15}{:>18} ms", "delay", with_error(1e3 * delay.value, 1e3 * delay.se)));
        }
        None => say(format_args!("no delay: too few frequencies are coherent")),
    }
    let gain = format!("gain, {}", gain_unit(units));
    say(format_args!("\n{:>14}{gain:>18}{:>12}{:>12}", "frequency, Hz", "phase, °", "coherence"));
    let mut next_hz = 0.0;
    for point in coherent.iter().filter(|point| {
        let due = point.frequency_hz >= next_hz;
        if due {
            next_hz = point.frequency_hz * 10f64.powf(ROWS_PER_DECADE.recip());
        }
        due
    }) {
        say(format_args!(
            "{:>14}{:>18}{:>12.0}{:>12.3}",
            number(point.frequency_hz, 3),
            number(point.response.norm(), 3),
            point.phase_rad * 180.0 / PI,
            point.coherence
        ));
    }
    let own = remarks(found).into_iter().map(|(_, text)| text);
    for remark in own.chain(left_out.iter().cloned()) {
        say(format_args!("\n{remark}"));
    }
    text
}

/// Gain, phase and coherence over the frequency.
pub fn figure(found: &FrequencyResponse, units: &Units, name: &str) -> Figure {
    let frequency: Vec<f64> = found.points.iter().map(|point| point.frequency_hz).collect();
    // What is not coherent leaves a hole in gain and phase.
    let of = |value: &dyn Fn(&Point) -> f64| -> Vec<f64> {
        found.points.iter().map(|point| if point.coherent { value(point) } else { f64::NAN }).collect()
    };
    let gain = of(&|point| point.response.norm());
    let phase = of(&|point| point.phase_rad * 180.0 / PI);
    let coherence: Vec<f64> = found.points.iter().map(|point| point.coherence).collect();
    let frequencies = |modes: &[Mode]| modes.iter().map(|mode| mode.frequency_hz.value).collect::<Vec<_>>();
    let reading = Reading {
        frequency: &frequency,
        gain: &gain,
        gain_unit: &gain_unit(units),
        phase: &phase,
        coherence: &coherence,
        resonances: &frequencies(&found.resonances),
        antiresonances: &frequencies(&found.antiresonances),
    };
    let caption = "Position over drive. Gain and phase stand where the coherence suffices. Dashed lines are resonances, dotted \
                   ones antiresonances.";
    Figure::new(format!("Frequency response, {name}"), caption, |width| bode(width, &reading))
}
