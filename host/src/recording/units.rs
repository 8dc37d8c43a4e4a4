//! Units of the columns, as far as a file tells them.

use serde::Serialize;

use super::header::Header;

/// Units of the drive and of the position, as the user calls them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct Units {
    /// Drive unit, e.g. `V` or `A`; `u` where it is not known.
    pub u: String,
    /// Position unit, e.g. `rad`, `m`, `counts`; `x` where it is not known.
    pub x: String,
}

impl Default for Units {
    /// Not known: `u` and `x` stand for themselves, so that b reads `u·s²/x`.
    fn default() -> Self {
        Self { u: "u".to_owned(), x: "x".to_owned() }
    }
}

impl Units {
    /// How many radians one position unit is, or `None` where the position is no angle (`m`) or its unit is not known. Counts
    /// are an angle if it is known how many make a turn; so is a unit that nobody named.
    pub fn radians(&self, counts_per_turn: Option<f64>) -> Option<f64> {
        let turn = std::f64::consts::TAU;
        match self.x.to_lowercase().as_str() {
            "rad" | "radian" | "radians" => Some(1.0),
            "mrad" => Some(1e-3),
            "urad" | "\u{b5}rad" | "\u{3bc}rad" => Some(1e-6),
            "deg" | "\u{b0}" | "degree" | "degrees" => Some(turn / 360.0),
            "arcmin" => Some(turn / 21_600.0),
            "arcsec" => Some(turn / 1_296_000.0),
            "gon" | "grad" => Some(turn / 400.0),
            "rev" | "revs" | "revolution" | "revolutions" | "turn" | "turns" => Some(turn),
            "counts" | "count" | "cnt" | "cnts" | "ticks" | "tick" | "steps" | "step" | "lsb" | "x" => {
                counts_per_turn.map(|counts| turn / counts)
            }
            _ => None,
        }
    }
}

/// What a column's name may end in, after the last `_`: `u_V`, `x_rad`, `iq_A`.
const SUFFIXES: [&str; 20] = [
    "V", "mV", "A", "mA", "N", "Nm", "mNm", "pct", "pwm", "rad", "mrad", "deg", "rev", "turns", "m", "mm", "um",
    "counts", "ticks", "steps",
];

/// Unit of a column: the header's `units` line, else the suffix of its name, else its unit in brackets, else none.
pub(super) fn of_column(name: &str, header: &Header) -> Option<String> {
    if let Some(unit) = header.units.get(name) {
        return Some(unit.clone());
    }
    let suffix = name.rsplit_once('_').map(|(_, suffix)| suffix);
    if let Some(suffix) = suffix
        && SUFFIXES.contains(&suffix)
    {
        return Some(suffix.to_owned());
    }
    let bracketed = name
        .strip_suffix(']')
        .and_then(|rest| rest.rsplit_once('['))
        .or_else(|| name.strip_suffix(')').and_then(|rest| rest.rsplit_once('(')));
    bracketed.map(|(_, unit)| unit.trim().to_owned()).filter(|unit| !unit.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn is 2π rad in each unit of angle; counts need their number, and a length is no angle.
    #[test]
    fn a_turn_is_a_turn_in_every_unit() {
        let radians = |x: &str, counts| Units { u: "V".to_owned(), x: x.to_owned() }.radians(counts);
        let turns = [
            ("rad", std::f64::consts::TAU),
            ("mrad", 1e3 * std::f64::consts::TAU),
            ("deg", 360.0),
            ("\u{b0}", 360.0),
            ("arcmin", 21_600.0),
            ("arcsec", 1_296_000.0),
            ("gon", 400.0),
            ("rev", 1.0),
            ("Turns", 1.0),
        ];
        for (unit, turn) in turns {
            let radians = radians(unit, None).unwrap_or_else(|| panic!("{unit}"));
            assert!((radians * turn / std::f64::consts::TAU - 1.0).abs() < 1e-15, "{unit}");
        }
        assert_eq!(radians("counts", None), None);
        assert_eq!(radians("counts", Some(4096.0)), Some(std::f64::consts::TAU / 4096.0));
        assert_eq!(radians("x", Some(4096.0)), Some(std::f64::consts::TAU / 4096.0));
        for unit in ["m", "mm", "um", "x", "V"] {
            assert_eq!(radians(unit, None), None, "{unit}");
        }
        assert_eq!(radians("m", Some(4096.0)), None);
    }

    #[test]
    fn units_come_from_the_header_the_suffix_or_the_brackets() {
        let mut header = Header::default();
        header.units.insert("x".to_owned(), "counts".to_owned());
        let unit = |name| of_column(name, &header);
        assert_eq!(unit("x").as_deref(), Some("counts"));
        assert_eq!(unit("u_V").as_deref(), Some("V"));
        assert_eq!(unit("x_rad").as_deref(), Some("rad"));
        assert_eq!(unit("x_m").as_deref(), Some("m"));
        assert_eq!(unit("iq_A").as_deref(), Some("A"));
        assert_eq!(unit("angle [deg]").as_deref(), Some("deg"));
        assert_eq!(unit("drive (V)").as_deref(), Some("V"));
        assert_eq!(unit("vsupply_raw"), None);
        assert_eq!(unit("u"), None);
    }
}
