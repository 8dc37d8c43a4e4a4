//! What a recording says between its rows. The position runs in straight lines, and the drive is held from each row to
//! the next.

/// The position at an instant, by a straight line between two rows. Outside of the rows it is that of the first or the last.
pub(crate) fn position(t: &[f64], x: &[f64], at: f64) -> f64 {
    let k = t.partition_point(|t| *t <= at).saturating_sub(1).min(t.len().saturating_sub(2));
    let share = ((at - t[k]) / (t[k + 1] - t[k])).clamp(0.0, 1.0);
    x[k] + share * (x[k + 1] - x[k])
}

/// The integral of a quantity that is held from each row to the next.
pub(crate) struct Integral<'a, F> {
    t: &'a [f64],
    value: F,
    /// From the first row to each row.
    sums: Vec<f64>,
}

impl<'a, F: Fn(usize) -> f64> Integral<'a, F> {
    /// Of a quantity by the number of its row, and of the rows' instants, s.
    pub(crate) fn new(t: &'a [f64], value: F) -> Self {
        let mut sums = Vec::with_capacity(t.len());
        let mut sum = 0.0;
        for k in 0..t.len() {
            sums.push(sum);
            if k + 1 < t.len() {
                sum += value(k) * (t[k + 1] - t[k]);
            }
        }
        Self { t, value, sums }
    }

    /// Over the time between two instants, s. Outside of the rows the quantity is that of the first or the last row.
    pub(crate) fn over(&self, from: f64, to: f64) -> f64 {
        self.up_to(to) - self.up_to(from)
    }

    fn up_to(&self, at: f64) -> f64 {
        let k = self.t.partition_point(|t| *t <= at).saturating_sub(1);
        self.sums[k] + (self.value)(k) * (at - self.t[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: [f64; 4] = [0.0, 1.0, 3.0, 4.0];

    /// Half of the first interval and half of the second, which is twice as long; beyond the rows the ends go on.
    #[test]
    fn a_held_quantity_is_summed_over_any_time() {
        let integral = Integral::new(&T, |k| [2.0, -1.0, 4.0, 8.0][k]);
        assert_eq!(integral.over(0.5, 2.0), 0.5 * 2.0 - 1.0);
        assert_eq!(integral.over(-1.0, 0.0), 2.0);
        assert_eq!(integral.over(3.5, 4.5), 6.0);
    }

    #[test]
    fn a_position_lies_on_the_line_of_its_rows() {
        let x = [0.0, 2.0, 0.0, 5.0];
        let found = [-1.0, 0.5, 1.0, 2.5, 4.0, 9.0].map(|at| position(&T, &x, at));
        assert_eq!(found, [0.0, 1.0, 2.0, 0.5, 5.0, 5.0]);
    }
}
