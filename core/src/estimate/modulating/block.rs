//! The normal equations of one window frequency of one experiment.

/// Columns of a row: ∫φẍ, ∫φẋ, ∫φ·sgn v, ∫φ, the two edge corrections, and ∫φu.
pub const COLUMNS: usize = 7;

const SLOPE: usize = 1;

type Row = [f64; COLUMNS];
type Matrix = [Row; COLUMNS];

/// One phase of the windows' equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phase {
    /// Σ of products of a window's columns.
    pub gram: Matrix,
    /// Σ of products with the columns of the window before.
    pub lag: Matrix,
    previous: Row,
}

impl Phase {
    const EMPTY: Self =
        Self { gram: [[0.0; COLUMNS]; COLUMNS], lag: [[0.0; COLUMNS]; COLUMNS], previous: [0.0; COLUMNS] };

    fn add(&mut self, row: &Row, linked: bool) {
        accumulate(&mut self.gram, row, row);
        if linked {
            accumulate(&mut self.lag, &self.previous, row);
        }
        self.previous = *row;
    }
}

/// Sums over the windows of one window frequency of one experiment.
///
/// Each complex equation is turned into the phase of its own ∫φẋ. The part in phase with the velocity (the power
/// balance) tells c and f1, the part in quadrature tells b. They are kept apart because their noise differs by an order
/// of magnitude: an error in the time of a reversal turns ∫φ·sgn v by an angle, and so lands in the quadrature part.
///
/// The lag sums hold the products of successive windows: half-overlapping windows share their noise, and without these
/// the standard errors would be too small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// In phase, and in quadrature.
    pub(super) phases: [Phase; 2],
    pub(super) length: f64,
    pub(super) windows: u32,
    pub(super) rows_per_window: u32,
    pub(super) skipped: u32,
    pub(super) not_finite: u32,
    linked: bool,
}

impl Default for Block {
    fn default() -> Self {
        Self {
            phases: [Phase::EMPTY; 2],
            length: 0.0,
            windows: 0,
            rows_per_window: 2,
            skipped: 0,
            not_finite: 0,
            linked: false,
        }
    }
}

impl Block {
    /// Windows used.
    #[must_use]
    pub const fn windows(&self) -> u32 {
        self.windows
    }

    /// Windows left out because the axis rested in them.
    #[must_use]
    pub const fn skipped(&self) -> u32 {
        self.skipped
    }

    /// Windows left out because a sample was not finite.
    #[must_use]
    pub const fn not_finite(&self) -> u32 {
        self.not_finite
    }

    pub(super) const fn skip(&mut self) {
        self.skipped = self.skipped.saturating_add(1);
        self.linked = false;
    }

    pub(super) fn add(&mut self, rows: &[Row; 2], real_only: bool, length: f64) {
        // A bound on the size too, so that squares cannot overflow.
        if !rows.iter().flatten().all(|value| value.abs() < 1e120) {
            self.not_finite = self.not_finite.saturating_add(1);
            self.linked = false;
            return;
        }
        self.rows_per_window = if real_only { 1 } else { 2 };
        self.length = length;
        let [re, im] = [rows[0][SLOPE], rows[1][SLOPE]];
        // Below 1e120: the squares neither overflow nor, for anything that moves, vanish.
        let size = libm::sqrt(re * re + im * im);
        let (cos, sin) = if real_only || size <= 0.0 { (1.0, 0.0) } else { (re / size, im / size) };
        let mut turned = [[0.0; COLUMNS]; 2];
        for (k, (&re, &im)) in rows[0].iter().zip(&rows[1]).enumerate() {
            turned[0][k] = re * cos + im * sin;
            turned[1][k] = im * cos - re * sin;
        }
        for (phase, row) in self.phases.iter_mut().zip(&turned) {
            phase.add(row, self.linked);
        }
        self.linked = true;
        self.windows = self.windows.saturating_add(1);
    }

    pub(super) fn rows(&self) -> u32 {
        self.windows.saturating_mul(self.rows_per_window)
    }
}

fn accumulate(matrix: &mut Matrix, left: &Row, right: &Row) {
    for (line, &a) in matrix.iter_mut().zip(left) {
        for (entry, &b) in line.iter_mut().zip(right) {
            *entry += a * b;
        }
    }
}
