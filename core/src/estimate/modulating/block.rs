//! The normal equations of one window frequency of one experiment.

use crate::scalar::{DoubleWord, ExactSum, SolverReal};

/// Columns of a row: ∫φẍ, ∫φẋ, ∫φ·sgn v, ∫φ, the two edge corrections, and ∫φu.
pub const COLUMNS: usize = 7;

const SLOPE: usize = 1;

type Row<R> = [R; COLUMNS];
/// Sums of products of columns; their differences matter.
pub(super) type Matrix<R> = [[<R as SolverReal>::Sum; COLUMNS]; COLUMNS];

/// One phase of the windows' equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phase<R: SolverReal> {
    /// Σ of products of a window's columns.
    pub gram: Matrix<R>,
    /// Σ of products with the columns of the window before.
    pub lag: Matrix<R>,
    previous: Row<R>,
}

impl<R: SolverReal> Default for Phase<R> {
    fn default() -> Self {
        let nothing = [[R::Sum::default(); COLUMNS]; COLUMNS];
        Self { gram: nothing, lag: nothing, previous: [R::ZERO; COLUMNS] }
    }
}

impl<R: SolverReal> Phase<R> {
    fn add(&mut self, row: &Row<R>, linked: bool) {
        accumulate::<R>(&mut self.gram, row, row);
        if linked {
            accumulate::<R>(&mut self.lag, &self.previous, row);
        }
        self.previous = *row;
    }
}

/// Sums over the windows of one window frequency of one experiment.
///
/// Each complex equation is turned into the phase of its own ∫φẋ. The part in phase with the velocity (the power
/// balance) tells c and f1, the part in quadrature tells b. They are kept apart because their noise differs by an
/// order of magnitude. An error in the time of a reversal turns ∫φ·sgn v by an angle, and so lands in the quadrature
/// part.
///
/// The lag sums hold the products of successive windows: half-overlapping windows share their noise, and without these
/// the standard errors would be too small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block<R: SolverReal = f64> {
    /// In phase, and in quadrature.
    pub(super) phases: [Phase<R>; 2],
    pub(super) length: R,
    pub(super) windows: u32,
    pub(super) rows_per_window: u32,
    pub(super) skipped: u32,
    pub(super) not_finite: u32,
    linked: bool,
}

impl<R: SolverReal> Default for Block<R> {
    fn default() -> Self {
        Self {
            phases: [Phase::default(); 2],
            length: R::ZERO,
            windows: 0,
            rows_per_window: 2,
            skipped: 0,
            not_finite: 0,
            linked: false,
        }
    }
}

impl<R: SolverReal> Block<R> {
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

    pub(super) fn add(&mut self, rows: &[Row<R>; 2], real_only: bool, length: R) {
        // A bound on the size too, so that squares cannot overflow.
        if !rows.iter().flatten().all(|value| value.abs() < R::LARGEST_ROW) {
            self.not_finite = self.not_finite.saturating_add(1);
            self.linked = false;
            return;
        }
        self.rows_per_window = if real_only { 1 } else { 2 };
        self.length = length;
        let [re, im] = [rows[0][SLOPE], rows[1][SLOPE]];
        // Below the bound: the squares neither overflow nor, for anything that moves, vanish.
        let size = (re * re + im * im).sqrt();
        let (cos, sin) = if real_only || size <= R::ZERO { (R::ONE, R::ZERO) } else { (re / size, im / size) };
        let mut turned = [[R::ZERO; COLUMNS]; 2];
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

fn accumulate<R: SolverReal>(matrix: &mut Matrix<R>, left: &Row<R>, right: &Row<R>) {
    for (line, &a) in matrix.iter_mut().zip(left) {
        for (entry, &b) in line.iter_mut().zip(right) {
            *entry = entry.plus(R::Sum::product(a, b));
        }
    }
}

/// The same sums, every digit of them.
impl From<Block<f32>> for Block<f64> {
    fn from(block: Block<f32>) -> Self {
        let wide = |matrix: Matrix<f32>| matrix.map(|line| line.map(<f64 as From<DoubleWord>>::from));
        Self {
            phases: block.phases.map(|phase| Phase {
                gram: wide(phase.gram),
                lag: wide(phase.lag),
                previous: phase.previous.map(f64::from),
            }),
            length: f64::from(block.length),
            windows: block.windows,
            rows_per_window: block.rows_per_window,
            skipped: block.skipped,
            not_finite: block.not_finite,
            linked: block.linked,
        }
    }
}
