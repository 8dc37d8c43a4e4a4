//! Encoders that roll over: the position starts anew after a turn, or where the counter is full.

use std::fmt;
use std::str::FromStr;

use super::outliers::Path;
use super::timing::median;

/// Least size of a roll-over in the largest other change: at four rows a turn, which way the axis turned is still plain.
const LEAST: f64 = 4.0;
/// A jump this share of the largest one is a roll-over as well: it is the turn less what the axis moved in that row.
const ALIKE: f64 = 0.7;
/// Distance of a roll-over from a turn, as a share of the turn, within which it is one.
const NEAR: f64 = 0.02;
/// Share of the jumps that must go against the motion around them.
const AGAINST: f64 = 0.8;

/// What to do with a position that rolls over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wrap {
    /// It does not: what looks like it is motion.
    None,
    /// It starts anew after this many position units.
    Modulus(f64),
}

impl FromStr for Wrap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            _ if text == "none" => Ok(Self::None),
            Ok(modulus) if modulus.is_finite() && modulus > 0.0 => Ok(Self::Modulus(modulus)),
            _ => Err("expected a positive number, such as `4096`, or `none`".to_owned()),
        }
    }
}

impl fmt::Display for Wrap {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => out.write_str("none"),
            Self::Modulus(modulus) => write!(out, "{modulus}"),
        }
    }
}

/// Joins what rolls over: every change becomes the smallest that differs from it by whole multiples of `modulus`.
pub(super) fn unwrap(x: &mut [f64], modulus: f64) {
    let mut turns = 0.0;
    let mut before = x.first().copied().unwrap_or(0.0);
    for value in x {
        turns -= ((*value - before) / modulus).round();
        before = *value;
        *value += turns * modulus;
    }
}

/// A roll-over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RollOver {
    /// The first row after one.
    pub row: usize,
    /// How many there are.
    pub times: usize,
    /// Position units after which it starts anew.
    pub modulus: f64,
}

impl Path<'_> {
    /// Whether the position rolls over. All its jumps then have one size and reach from one end of its range to the other.
    /// They go against the motion around them, or by a full turn of the unit or of a binary counter.
    pub(super) fn roll_over(&self, unit: &str) -> Option<RollOver> {
        let rows = 1..self.x.len();
        let sizes = || rows.clone().map(|row| self.change(row).abs());
        let largest = sizes().fold(0.0, f64::max);
        let others = sizes().filter(|size| *size <= ALIKE * largest).fold(0.0, f64::max);
        if others <= 0.0 || largest < LEAST * others {
            return None;
        }
        let jumps: Vec<usize> = rows.filter(|&row| self.change(row).abs() > ALIKE * largest).collect();
        // What the axis moves in the rows around a jump.
        let around = |row: usize| {
            let beside =
                [self.change(row - 1), self.change(row + 1)].into_iter().filter(|c| c.abs() <= others && *c != 0.0);
            let (sum, count) = beside.fold((0.0, 0), |(sum, count), c| (sum + c, count + 1));
            sum / f64::from(count.max(1))
        };
        let turned: Vec<f64> = jumps.iter().map(|&row| (self.change(row) - around(row)).abs()).collect();
        let modulus = median(turned.clone());
        let x = self.x.iter();
        let (low, high) = x.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        let alike = turned.iter().all(|size| (size - modulus).abs() <= 2.0 * others);
        if !alike || high - low > modulus + 2.0 * others {
            return None;
        }
        let with = |sign: f64| jumps.iter().filter(|&&row| sign * self.change(row) * around(row) > 0.0).count() as f64;
        let turn = turns(unit, modulus).find(|turn| (modulus - turn).abs() <= NEAR * turn);
        let against = with(-1.0) >= AGAINST * jumps.len() as f64;
        let by_a_turn = turn.is_some() && with(1.0) <= (1.0 - AGAINST) * jumps.len() as f64;
        (against || by_a_turn).then(|| RollOver {
            row: jumps[0],
            times: jumps.len(),
            modulus: turn.unwrap_or_else(|| short(modulus)),
        })
    }
}

/// Whether a leap of `size` is a full turn, to within the axis's motion from row to row. Such a position hovers about
/// the end of its range.
pub(super) fn is_turn(size: f64, regular: f64, unit: &str) -> bool {
    turns(unit, size).any(|turn| (size - turn).abs() <= 2.0 * regular)
}

/// Full turns near `size` in a position unit: a turn of the axis, or a full counter of 8 bits and more.
fn turns(unit: &str, size: f64) -> impl Iterator<Item = f64> {
    let turn = match unit {
        "rad" => Some(std::f64::consts::TAU),
        "mrad" => Some(1e3 * std::f64::consts::TAU),
        "deg" => Some(360.0),
        "rev" | "turns" => Some(1.0),
        _ => None,
    };
    let bits = size.log2().round();
    let counter = (turn.is_none() && (8.0..=32.0).contains(&bits)).then(|| bits.exp2());
    turn.into_iter().chain(counter)
}

/// A number without the digits it does not have.
fn short(modulus: f64) -> f64 {
    format!("{modulus:.3e}").parse().unwrap_or(modulus)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 s at 1 kHz, twice 2.9 turns there and back, at most 0.0046 turns a row.
    fn turns_there_and_back(modulus: f64, step: f64) -> Vec<f64> {
        let x = |k: i32| 1.45 * modulus * (1.0 - (std::f64::consts::FRAC_PI_2 * 1e-3 * 2.0 * f64::from(k)).cos());
        (0..4000).map(|k| (x(k) / step).round() * step).collect()
    }

    fn rolled(x: &[f64], modulus: f64) -> Vec<f64> {
        x.iter().map(|x| x.rem_euclid(modulus)).collect()
    }

    /// The turn is found, and joining by it gives back the path. This holds for a turn in rad, deg and rev, counters
    /// of 12 and 16 bits, and an encoder of 20 000 counts that nothing names.
    #[test]
    fn a_turn_is_found_and_joined() {
        let cases = [
            ("rad", std::f64::consts::TAU, 1e-3),
            ("deg", 360.0, 0.1),
            ("rev", 1.0, 1e-4),
            ("counts", 4096.0, 1.0),
            ("x", 65_536.0, 1.0),
            ("counts", 20_000.0, 1.0),
        ];
        for (unit, modulus, step) in cases {
            let path = turns_there_and_back(modulus, step);
            assert_eq!(Path::new(&path, &[]).roll_over(unit), None, "{unit}");
            let mut x = rolled(&path, modulus);
            let found = Path::new(&x, &[]).roll_over(unit).unwrap_or_else(|| panic!("{unit} {modulus}"));
            assert!((found.modulus / modulus - 1.0).abs() < 1e-3, "{unit} {modulus}: {found:?}");
            assert_eq!(found.times, 8, "{unit}: {found:?}");
            unwrap(&mut x, modulus);
            assert!(x.iter().zip(&path).all(|(a, b)| (a - b).abs() < 1e-9 * modulus), "{unit}");
        }
    }

    /// A position that hovers about zero in a counter of 16 bits.
    #[test]
    fn hovering_about_the_end_of_a_counter_is_a_roll_over() {
        let path: Vec<f64> = (0..500).map(|k| (20.0 * (0.05 * f64::from(k)).sin()).round()).collect();
        let found = Path::new(&rolled(&path, 65_536.0), &[]).roll_over("counts").unwrap();
        assert_eq!(found.modulus, 65_536.0);
    }

    /// A break-away from rest to rest within one row goes the way of the creep before it, and is motion.
    #[test]
    fn a_break_away_is_motion() {
        let creep: Vec<f64> =
            (0..200).map(|k| if k < 100 { 1e-5 * f64::from(k) } else { 0.3 + 1e-5 * f64::from(k) }).collect();
        for unit in ["rad", "deg", "counts", "x"] {
            assert_eq!(Path::new(&creep, &[]).roll_over(unit), None, "{unit}");
        }
    }
}
