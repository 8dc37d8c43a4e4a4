//! Numbers, units and escapes for a reader.

/// Text safe inside HTML and SVG elements and attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // XML 1.0 has no place for these.
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A hyphen in front of a number as the minus sign it means.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}

/// `10ⁿ`.
pub fn power_of_ten(n: i32) -> String {
    let digits = n.to_string();
    let raised = digits.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => char::from_u32(0x2070 + c.to_digit(10).unwrap_or(0)).unwrap_or(c),
    });
    format!("10{}", raised.collect::<String>())
}

/// The decimal exponent of |value|; 0 for zero and what is not finite.
fn exponent(value: f64) -> i32 {
    if value == 0.0 || !value.is_finite() { 0 } else { value.abs().log10().floor() as i32 }
}

/// A number with so many significant digits, a dash if it is not finite.
pub fn number(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    // Rounded first, so that 9.99 becomes 10 and not 10.0.
    let rounded: f64 = format!("{value:.*e}", (digits - 1).max(0) as usize).parse().unwrap_or(value);
    let e = exponent(rounded);
    if (-4..6).contains(&e) || rounded == 0.0 {
        minus(&format!("{rounded:.*}", (digits - 1 - e).max(0) as usize))
    } else {
        let mantissa = rounded / 10f64.powi(e);
        minus(&format!("{mantissa:.*}·{}", (digits - 1).max(0) as usize, power_of_ten(e)))
    }
}

/// Value and standard error, rounded to two digits of the error; "held" where the error is not a positive number.
pub fn with_error(value: f64, se: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if !se.is_finite() || se <= 0.0 {
        return format!("{} (held)", number(value, 5));
    }
    let e = exponent(value.abs().max(se));
    let scaled = !(-3..6).contains(&e);
    let factor = if scaled { 10f64.powi(e) } else { 1.0 };
    let decimals = (1 - exponent(se / factor)).clamp(0, 12) as usize;
    let text = minus(&format!("{:.decimals$} ± {:.decimals$}", value / factor, se / factor));
    if scaled { format!("({text})·{}", power_of_ten(e)) } else { text }
}

/// The two ends of a range, to a thousandth of its width.
pub fn range([low, high]: [f64; 2]) -> String {
    let decimals = (3 - exponent(high - low)).clamp(0, 12) as usize;
    let scale = 10f64.powi(decimals as i32);
    // Minus zero plus zero is zero: what rounds to nothing has no sign.
    let end = |value: f64| minus(&format!("{:.decimals$}", (value * scale).round() / scale + 0.0));
    format!("{} to {}", end(low), end(high))
}

/// Units that take a prefix.
const PLAIN: [&str; 10] = ["rad", "m", "V", "A", "N", "Nm", "s", "Hz", "rad/s", "m/s"];
const PREFIXES: [(i32, &str); 7] = [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (0, ""), (3, "k"), (6, "M")];

/// The exponent (a multiple of three) in which numbers up to `largest` read best, and the unit in it.
pub fn scaled_unit(largest: f64, unit: &str) -> (i32, String) {
    let e = exponent(largest);
    if (-1..4).contains(&e) || largest == 0.0 {
        return (0, unit.to_owned());
    }
    let third = e.div_euclid(3) * 3;
    let prefix = PREFIXES.iter().find(|(p, _)| *p == third).filter(|_| PLAIN.contains(&unit));
    match prefix {
        Some((_, prefix)) => (third, format!("{prefix}{unit}")),
        None if unit.is_empty() => (third, power_of_ten(third)),
        None => (third, format!("{} {unit}", power_of_ten(third))),
    }
}

/// A quantity in the prefix that suits it: `0.0044 m` becomes `4.4 mm`.
pub fn quantity(value: f64, unit: &str, digits: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let e = exponent(value);
    let third = if (0..3).contains(&e) { 0 } else { e.div_euclid(3) * 3 };
    let prefix = PREFIXES.iter().find(|(p, _)| *p == third).filter(|_| PLAIN.contains(&unit));
    match prefix {
        Some((_, prefix)) => format!("{} {prefix}{unit}", number(value / 10f64.powi(third), digits)),
        None => format!("{} {unit}", number(value, digits)).trim_end().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_written_by_hand() {
        assert_eq!(number(-0.026_86, 3), "−0.0269");
        assert_eq!(number(9.996, 3), "10.0");
        assert_eq!(number(1.5e-7, 2), "1.5·10⁻⁷");
        assert_eq!(number(f64::NAN, 3), "–");
        assert_eq!(with_error(0.026_853_7, 0.000_021), "0.026854 ± 0.000021");
        assert_eq!(with_error(-1.234e-5, 1.2e-7), "(−1.234 ± 0.012)·10⁻⁵");
        assert_eq!(with_error(2.0, f64::NAN), "2.0000 (held)");
        assert_eq!(quantity(0.0044, "m", 2), "4.4 mm");
        assert_eq!(quantity(3.6e-4, "rad", 2), "360 µrad");
        assert_eq!(quantity(12.0, "counts", 2), "12 counts");
        assert_eq!(scaled_unit(0.004, "rad"), (-3, "mrad".to_owned()));
        assert_eq!(scaled_unit(0.004, "x"), (-3, "10⁻³ x".to_owned()));
        assert_eq!(range([-2e-5, 0.2464]), "0.0000 to 0.2464");
        assert_eq!(range([-44.0, 115.0]), "−44.0 to 115.0");
        assert_eq!(escape("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot; ");
    }
}
