//! The linear columns of the model at one frequency.

/// What is fitted beside the fundamental. The default has the offset only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
// Each is a column that is there or not, in any combination.
#[allow(clippy::struct_excessive_bools)]
pub struct SineModel {
    /// A constant. Without it (the memo's listing) a dc of 0.3A biases A by 20 % at one cycle, 7.6 % at two.
    pub offset: bool,
    /// A constant slope. It hurts below 2 cycles, where it looks like the sine.
    pub drift: bool,
    /// The third harmonic (4 % in a relay's limit cycle).
    pub third: bool,
    /// The fifth harmonic.
    pub fifth: bool,
}

impl Default for SineModel {
    fn default() -> Self {
        Self { offset: true, drift: false, third: false, fifth: false }
    }
}

impl SineModel {
    /// Number of linear columns, 2..=8.
    pub(super) fn columns(self) -> usize {
        2 + usize::from(self.offset)
            + usize::from(self.drift)
            + 2 * usize::from(self.third)
            + 2 * usize::from(self.fifth)
    }
    /// The highest harmonic in the model.
    pub(super) fn highest(self) -> f64 {
        if self.fifth {
            5.0
        } else if self.third {
            3.0
        } else {
            1.0
        }
    }
    /// Index of the offset's column.
    pub(super) fn offset_index(self) -> Option<usize> {
        self.offset.then_some(2)
    }
    /// Index of the drift's column.
    pub(super) fn drift_index(self) -> Option<usize> {
        self.drift.then_some(2 + usize::from(self.offset))
    }
    /// Index of the sine column of the third harmonic; its cosine follows.
    pub(super) fn third_index(self) -> Option<usize> {
        self.third.then_some(2 + usize::from(self.offset) + usize::from(self.drift))
    }
    /// Index of the sine column of the fifth harmonic; its cosine follows.
    pub(super) fn fifth_index(self) -> Option<usize> {
        self.fifth.then_some(2 + usize::from(self.offset) + usize::from(self.drift) + 2 * usize::from(self.third))
    }

    /// The row of columns `[sin, cos, 1, τ, sin 3, cos 3, sin 5, cos 5]` (those asked for) at dimensionless time `tau`.
    #[inline]
    pub(super) fn row<const N: usize>(self, sin: f64, cos: f64, tau: f64) -> [f64; N] {
        let mut row = [0.0; N];
        let mut cells = row.iter_mut();
        let mut put = |value: f64| {
            if let Some(cell) = cells.next() {
                *cell = value;
            }
        };
        put(sin);
        put(cos);
        if self.offset {
            put(1.0);
        }
        if self.drift {
            put(tau);
        }
        let (s2, c2) = (sin * sin, cos * cos);
        if self.third {
            put(sin * (3.0 - 4.0 * s2));
            put(cos * (4.0 * c2 - 3.0));
        }
        if self.fifth {
            put(sin * (5.0 + s2 * (16.0 * s2 - 20.0)));
            put(cos * (5.0 + c2 * (16.0 * c2 - 20.0)));
        }
        row
    }

    /// d(row·theta)/dΩ at dimensionless time `tau`: `τ·Σ h·(p_h·cos hΩτ − q_h·sin hΩτ)`.
    #[inline]
    pub(super) fn slope<const N: usize>(self, row: &[f64; N], theta: &[f64; N], tau: f64) -> f64 {
        let at = |v: &[f64; N], i: usize| v.get(i).copied().unwrap_or(0.0);
        let pair = |i: usize| at(theta, i) * at(row, i + 1) - at(theta, i + 1) * at(row, i);
        let mut sum = pair(0);
        if let Some(i) = self.third_index() {
            sum += 3.0 * pair(i);
        }
        if let Some(i) = self.fifth_index() {
            sum += 5.0 * pair(i);
        }
        tau * sum
    }
}
