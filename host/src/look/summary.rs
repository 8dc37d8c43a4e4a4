//! The channels of a log, one by one.

use super::guess::Guesses;
use crate::recording::formats::{Group, Log, Values};

/// Different texts that a summary shows.
const SHOWN: usize = 5;

/// A channel in short.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Its full name.
    pub name: String,
    /// Its unit, where the file says it.
    pub unit: Option<String>,
    /// Rows that have a value.
    pub rows: usize,
    /// Rows per second, where its time is known.
    pub rate_hz: Option<f64>,
    /// Lowest and highest number; `None` of texts.
    pub range: Option<(f64, f64)>,
    /// The first different texts.
    pub texts: Vec<String>,
    /// Numbers to draw, few of many; empty of texts.
    pub drawn: Vec<f64>,
}

/// Numbers of a drawing in a line.
const DRAWN: usize = 2048;

pub(super) fn summaries(log: &Log, guesses: &Guesses) -> Vec<Summary> {
    let time = guesses.time.as_ref().and_then(|time| log.find(&time.channel));
    let rate_of = |group: &Group| {
        let own = group.stamps_s.as_deref();
        let column = time.filter(|(of, _)| std::ptr::eq(*of, group)).and_then(|(_, channel)| channel.values.numbers());
        let per_unit = guesses.seconds_per_time_unit;
        match (own, column) {
            (_, Some(column)) => rate(column).map(|rate| rate / per_unit),
            (Some(own), None) => rate(own),
            (None, None) => None,
        }
    };
    let rates: Vec<Option<f64>> = log.groups.iter().map(rate_of).collect();
    let mut all = Vec::new();
    for (group, rate_hz) in log.groups.iter().zip(rates) {
        for channel in &group.channels {
            let mut summary = Summary {
                name: group.full_name(channel),
                unit: channel.unit.clone(),
                rows: 0,
                rate_hz,
                range: None,
                texts: Vec::new(),
                drawn: Vec::new(),
            };
            match &channel.values {
                Values::Numbers(numbers) => {
                    let finite = || numbers.iter().copied().filter(|number| number.is_finite());
                    summary.rows = finite().count();
                    summary.range = (summary.rows > 0).then(|| {
                        finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
                    });
                    summary.drawn = finite().step_by(summary.rows.div_ceil(DRAWN).max(1)).collect();
                }
                Values::Texts(texts) => {
                    summary.rows = texts.iter().filter(|text| !text.is_empty()).count();
                    for text in texts.iter().filter(|text| !text.is_empty()) {
                        if summary.texts.len() == SHOWN {
                            break;
                        }
                        if !summary.texts.iter().any(|known| **known == **text) {
                            summary.texts.push(text.to_string());
                        }
                    }
                }
            }
            all.push(summary);
        }
    }
    all
}

/// Rows per unit of a time.
fn rate(stamps: &[f64]) -> Option<f64> {
    let mut intervals: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).filter(|interval| *interval > 0.0).collect();
    if intervals.is_empty() {
        return None;
    }
    let middle = intervals.len() / 2;
    Some(1.0 / *intervals.select_nth_unstable_by(middle, f64::total_cmp).1)
}
