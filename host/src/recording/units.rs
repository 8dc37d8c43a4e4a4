//! Units of the columns, as far as a file tells them.

use serde::Serialize;

use super::header::Header;

/// Units of the drive and of the position, as the user calls them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
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
