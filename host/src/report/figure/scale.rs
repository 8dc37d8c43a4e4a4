//! Axes: from data to a share of the panel, and the ticks.

use crate::report::text::{quantity, scaled_unit};

/// A tick: where (in data) and what it says.
pub type Tick = (f64, String);

/// Maps data onto 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Evenly, from the first to the second number.
    Linear(f64, f64),
    /// By the logarithm; both ends > 0.
    Log(f64, f64),
}

impl Scale {
    /// A linear scale over the finite `values`, with `margin` (a share of the span) on both sides.
    pub fn over(values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|value| value.is_finite()) {
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let span = high - low;
        let pad = if span > 0.0 { margin * span } else { 0.5 * low.abs().max(1e-9) };
        Self::Linear(low - pad, high + pad)
    }

    /// A logarithmic scale over the positive `values`, with a factor of room below and above.
    pub fn log_over(values: impl IntoIterator<Item = f64>, below: f64, above: f64) -> Self {
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        for value in values.into_iter().filter(|value| value.is_finite() && *value > 0.0) {
            low = low.min(value);
            high = high.max(value);
        }
        if high <= 0.0 {
            (low, high) = (0.1, 1.0);
        }
        Self::Log(low / below, high * above)
    }

    /// The place of a value; 0 and 1 are the ends. Not finite for what has no place.
    pub fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear(low, high) => (value - low) / (high - low),
            Self::Log(low, high) => (value / low).ln() / (high / low).ln(),
        }
    }

    /// What the ends stand for, as JSON for the page's script: kind, both ends in the unit of the labels, that unit, and
    /// the quantity. `named` is (quantity, unit).
    pub fn attribute(self, named: (&str, &str)) -> String {
        let (kind, low, high, (power, unit)) = match self {
            Self::Linear(low, high) => ("linear", low, high, scaled_unit(low.abs().max(high.abs()), named.1)),
            Self::Log(low, high) => ("log", low, high, (0, named.1.to_owned())),
        };
        let factor = 10f64.powi(power);
        serde_json::json!([kind, low / factor, high / factor, unit, named.0]).to_string()
    }

    /// Ticks, about `count` of them, and the unit that their labels are in.
    pub fn ticks(self, count: usize, unit: &str) -> (Vec<Tick>, String) {
        match self {
            Self::Linear(low, high) => linear(low, high, count, unit),
            Self::Log(low, high) => (logarithmic(low, high, unit), unit.to_owned()),
        }
    }
}

fn linear(low: f64, high: f64, count: usize, unit: &str) -> (Vec<Tick>, String) {
    let (power, unit) = scaled_unit(low.abs().max(high.abs()), unit);
    let factor = 10f64.powi(power);
    let (low, high) = (low / factor, high / factor);
    let rough = (high - low) / count.max(2) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * decade).into_iter().find(|s| *s >= 0.7 * rough).unwrap_or(rough);
    let decimals = (0..10).find(|d| is_whole(step * 10f64.powi(*d))).unwrap_or(10) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    let ticks = (first..=last.min(first + 50)).map(|i| {
        let value = i as f64 * step;
        (value * factor, format!("{value:.decimals$}").replace('-', "−"))
    });
    (ticks.collect(), unit)
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6 * value.abs().max(1.0)
}

fn logarithmic(low: f64, high: f64, unit: &str) -> Vec<Tick> {
    let decades = (high / low).log10();
    let multiples: &[f64] = if decades <= 1.2 {
        &[1.0, 2.0, 3.0, 5.0]
    } else if decades <= 2.5 {
        &[1.0, 3.0]
    } else {
        &[1.0]
    };
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    (first..=last)
        .flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)))
        .filter(|value| (low..=high).contains(value))
        .map(|value| (value, quantity(value, unit, 1)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let (ticks, unit) = Scale::Linear(-0.0013, 0.0021).ticks(4, "rad");
        assert_eq!(unit, "mrad");
        assert_eq!(ticks.iter().map(|t| t.1.as_str()).collect::<Vec<_>>(), ["−1", "0", "1", "2"]);
        let (ticks, _) = Scale::Log(2e-4, 3e-2).ticks(4, "m");
        assert_eq!(
            ticks.iter().map(|t| t.1.as_str()).collect::<Vec<_>>(),
            ["300 µm", "1 mm", "3 mm", "10 mm", "30 mm"]
        );
    }

    #[test]
    fn scales_survive_constant_and_missing_data() {
        for scale in [Scale::over([], 0.1), Scale::over([2.0, 2.0], 0.1), Scale::log_over([0.0, f64::NAN], 2.0, 2.0)] {
            assert!(scale.place(1.0).is_finite());
            assert!(scale.ticks(5, "V").0.len() < 60);
        }
    }
}
