//! The least of a function of one number, by golden section.

/// Ratio of the golden section, (√5 − 1)/2.
const RATIO: f64 = 0.618_033_988_749_895;

/// The place within `low..high` at which `cost` is least, where it has one minimum there. Each step narrows the bracket
/// to .618 of it, and asks for one value; the first asks for two.
pub fn golden_section([mut low, mut high]: [f64; 2], steps: usize, mut cost: impl FnMut(f64) -> f64) -> f64 {
    let (mut a, mut b) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut of_a, mut of_b) = (cost(a), cost(b));
    for step in 1..=steps {
        let more = step < steps;
        if of_a < of_b {
            (high, b, of_b) = (b, a, of_a);
            a = high - RATIO * (high - low);
            of_a = if more { cost(a) } else { of_a };
        } else {
            (low, a, of_a) = (a, b, of_b);
            b = low + RATIO * (high - low);
            of_b = if more { cost(b) } else { of_b };
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::golden_section;

    /// After 20 steps the bracket has .618²⁰ = 6.6e-5 of its width, and the minimum is within half of that. 21 values are
    /// asked for.
    #[test]
    fn the_minimum_is_in_a_bracket_that_narrows() {
        let mut asked = 0;
        let found = golden_section([-1.0, 3.0], 20, |x| {
            asked += 1;
            (x - 0.7_f64).powi(2)
        });
        assert!((found - 0.7).abs() < 0.5 * 4.0 * 6.7e-5, "{found}");
        assert_eq!(asked, 21);
    }
}
