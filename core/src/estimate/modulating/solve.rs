//! From the blocks of all experiments to (b, c, f1), their covariance, or the refusal.

use super::block::{Block, COLUMNS, Phase};
use crate::estimate::linear::{NormalEquations, Solution, SolveError};
use crate::plant::Base;

/// A parameter of the base model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Inertia b.
    Inertia,
    /// Viscous friction and back-EMF c.
    Damping,
    /// Coulomb friction f1.
    Coulomb,
    /// Constant load.
    Load,
}

/// Why the data do not determine the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Not one equation per parameter: the record is shorter than the windows need.
    TooShort,
    /// The axis rested in every window.
    NoMotion,
    /// Samples that are not finite, or too large to square, in every window.
    NotFinite,
    /// The velocity never changes its sign: Coulomb friction looks like a constant load.
    OneDirection,
    /// c and f1 cannot be separated: all motion has the same speed amplitude.
    SingleSpeed,
    /// This parameter's share of the drive is lost in the residual.
    Undetermined(Parameter),
}

impl Refusal {
    /// Which experiment would determine it.
    #[must_use]
    pub const fn advice(self) -> &'static str {
        match self {
            Self::TooShort => "record more: at least three cycles of each experiment, from standstill or later",
            Self::NoMotion => "no motion: raise h1 + h2 above the breakaway level, or check the drive and the encoder",
            Self::NotFinite => "the record holds values that are not finite or beyond 1e60: repair the record",
            Self::OneDirection => "f1 cannot be determined: the axis moves in one direction only; let it reverse",
            Self::SingleSpeed => {
                "c and f1 cannot be separated: all motion has the same speed; repeat with a different h2 and use both records"
            }
            Self::Undetermined(Parameter::Inertia) => {
                "b cannot be determined: no acceleration; use a faster experiment (a relay, a sine of higher frequency)"
            }
            Self::Undetermined(Parameter::Damping) => {
                "c cannot be determined: use a second experiment at a clearly higher speed (larger h2)"
            }
            Self::Undetermined(Parameter::Coulomb) => {
                "f1 cannot be determined: use a second experiment with a smaller drive (h2 nearer to f1)"
            }
            Self::Undetermined(Parameter::Load) => {
                "the load cannot be determined: let the axis move in both directions for more windows"
            }
        }
    }
}

/// The base model with what is known about its errors. Units as in [`Base`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseEstimate {
    /// Inertia.
    pub b: f64,
    /// Viscous friction and back-EMF.
    pub c: f64,
    /// Coulomb friction.
    pub f1: f64,
    /// Constant load in drive units, if a window of multiple 0 asked for it.
    pub load: Option<f64>,
    /// Standard errors of b, c, f1 and the load (0 if not asked for).
    pub standard_errors: [f64; 4],
    /// Covariance in the same order.
    pub covariance: [[f64; 4]; 4],
    /// Condition of the scaled normal matrix.
    pub condition: f64,
    /// Windows used, over all experiments and frequencies.
    pub windows: u32,
    /// Rms of the equation residual per window length, in drive units.
    pub residual: f64,
}

impl BaseEstimate {
    /// The parameters as a plant.
    ///
    /// # Errors
    /// Names a parameter that came out of range (e.g. a negative damping within its standard error).
    pub fn base(&self) -> Result<Base<f64>, crate::plant::PlantError> {
        Base::new(self.b, self.c, self.f1)
    }
}

const DRIVE: usize = COLUMNS - 1;
const SIGN: usize = 2;
/// Rounds of re-weighting and edge correction; each shrinks the change by more than a factor 10.
const ROUNDS: usize = 6;
/// Columns must differ by more than about 1 % in some direction: less is within what the sign's edges leave.
const MAX_CONDITION: f64 = 2e4;
/// A parameter must explain four times the residual power in its weakest direction.
const WEAKEST_OVER_RESIDUAL: f64 = 4.0;
/// Two standard errors of a parameter's share in the drive must stay below half of the drive.
const LARGEST_SHARE_ERROR: f64 = 0.25;

/// Solves the blocks of all experiments together.
///
/// Each block is weighted by its residual variance; the edges are corrected with the f1 found (see
/// [`super::Modulating::push`]); the covariance allows for the noise that half-overlapping windows share.
///
/// # Errors
/// [`Refusal`] names what the data cannot determine; its advice names the experiment that would.
pub fn estimate(experiments: &[&[Block]]) -> Result<BaseEstimate, Refusal> {
    let problem = Problem::checked(experiments)?;
    if problem.asks_for_load() { problem.solve::<4>() } else { problem.solve::<3>() }
}

/// As [`estimate`], for blocks without a window of multiple 0: where none asks for the load, the code that would find it
/// is not there either (4 KiB on a microcontroller).
///
/// # Errors
/// As [`estimate`]; and [`Refusal::Undetermined`] names the load where a block asks for it.
pub fn estimate_base(experiments: &[&[Block]]) -> Result<BaseEstimate, Refusal> {
    let problem = Problem::checked(experiments)?;
    if problem.asks_for_load() {
        return Err(Refusal::Undetermined(Parameter::Load));
    }
    problem.solve::<3>()
}
#[derive(Clone, Copy)]
struct Problem<'a> {
    experiments: &'a [&'a [Block]],
}

/// The equations of one phase of one block.
struct Part<'a> {
    phase: &'a Phase,
    rows: f64,
    length: f64,
    quadrature: bool,
}

/// What the weights of a round follow from.
#[derive(Clone, Copy)]
struct Round<const N: usize> {
    parameters: [f64; N],
    pooled: Option<f64>,
}

impl<const N: usize> Round<N> {
    /// 1/variance of the part's equations, the pooled variance counted as one more row.
    fn weight(&self, part: &Part<'_>) -> f64 {
        let Some(pooled) = self.pooled else {
            return 1.0;
        };
        let own = residual(&part.phase.gram, &self.parameters).max(0.0);
        (part.rows + 1.0) / (own + pooled).max(f64::MIN_POSITIVE)
    }
}

/// One round's weighted sums. `columns`ᵀ·`columns`, and instruments against columns, drive and instruments.
struct Sums<const N: usize> {
    gram: [[f64; N]; N],
    drive: [f64; N],
    square: f64,
    instrument: [[f64; N]; N],
    instrument_drive: [f64; N],
}

/// One round's result.
struct Outcome<const N: usize> {
    parameters: [f64; N],
    /// (ZᵀA)⁻¹.
    inverse: [[f64; N]; N],
    least_squares: Solution<f64, N>,
    sums: Sums<N>,
}

impl<'a> Problem<'a> {
    fn checked(experiments: &'a [&'a [Block]]) -> Result<Self, Refusal> {
        let problem = Problem { experiments };
        if problem.rows() == 0 {
            let (mut skipped, mut not_finite) = (false, false);
            for &blocks in experiments {
                for block in blocks {
                    skipped |= block.skipped > 0;
                    not_finite |= block.not_finite > 0;
                }
            }
            return Err(match (skipped, not_finite) {
                (true, _) => Refusal::NoMotion,
                (false, true) => Refusal::NotFinite,
                (false, false) => Refusal::TooShort,
            });
        }
        if problem.one_direction() {
            return Err(Refusal::OneDirection);
        }
        Ok(problem)
    }

    fn asks_for_load(self) -> bool {
        let mut asks = false;
        self.blocks(&mut |block| asks |= block.rows_per_window == 1);
        asks
    }

    /// Visits the blocks that have windows. One copy of the loop for all who visit, as in [`Self::parts`].
    #[inline(never)]
    fn blocks(self, visit: &mut dyn FnMut(&'a Block)) {
        for &blocks in self.experiments {
            for block in blocks {
                if block.windows > 0 {
                    visit(block);
                }
            }
        }
    }

    /// Visits the equations.
    #[inline(never)]
    fn parts(self, visit: &mut dyn FnMut(&Part<'a>)) {
        self.blocks(&mut |block| {
            let used = block.rows_per_window as usize;
            for (index, phase) in block.phases.iter().take(used).enumerate() {
                let rows = f64::from(block.windows);
                visit(&Part { phase, rows, length: block.length, quadrature: index == 1 });
            }
        });
    }

    fn rows(self) -> u32 {
        let mut rows: u32 = 0;
        self.blocks(&mut |block| rows = rows.saturating_add(block.rows()));
        rows
    }

    fn solve<const N: usize>(self) -> Result<BaseEstimate, Refusal> {
        let mut round = Round { parameters: [0.0; N], pooled: None };
        for _ in 1..ROUNDS {
            let parameters = self.once(&round)?.parameters;
            // The floor stands for the rounding of the sums, where the data fit exactly.
            let mut power = 0.0;
            self.parts(&mut |part| {
                power += residual(&part.phase.gram, &parameters).max(0.0) + 1e-15 * part.phase.gram[DRIVE][DRIVE];
            });
            round = Round { parameters, pooled: Some(power / f64::from(self.rows().max(1))) };
        }
        let outcome = self.once(&round)?;
        let estimate = self.report(&round, &outcome);
        self.judge(&outcome, &estimate)?;
        Ok(estimate)
    }

    fn once<const N: usize>(self, round: &Round<N>) -> Result<Outcome<N>, Refusal> {
        let columns: [Column; N] = columns(round.parameters[2]);
        let mut sums = Sums {
            gram: [[0.0; N]; N],
            drive: [0.0; N],
            square: 0.0,
            instrument: [[0.0; N]; N],
            instrument_drive: [0.0; N],
        };
        self.parts(&mut |part| {
            let weight = round.weight(part);
            for (i, column) in columns.iter().enumerate() {
                let instrument = !(part.quadrature && i == SIGN);
                for (j, other) in columns.iter().enumerate() {
                    let product = weight * bilinear(&part.phase.gram, column, other);
                    sums.gram[i][j] += product;
                    if instrument {
                        sums.instrument[i][j] += product;
                    }
                }
                let product = weight * bilinear(&part.phase.gram, column, &DRIVE_COLUMN);
                sums.drive[i] += product;
                if instrument {
                    sums.instrument_drive[i] += product;
                }
            }
            sums.square += weight * part.phase.gram[DRIVE][DRIVE];
        });
        // Least squares says whether the parameters can be told apart; the instruments give them without bias.
        let equations = NormalEquations::from_sums(sums.gram, sums.drive, sums.square, self.rows());
        let least_squares = match equations.solve(MAX_CONDITION) {
            Ok(solution) => solution,
            Err(SolveError::TooFewRows) => return Err(Refusal::TooShort),
            Err(SolveError::NotFinite) => return Err(Refusal::NotFinite),
            Err(SolveError::Undetermined { parameter }) => return Err(self.name(parameter)),
        };
        let inverse = invert(sums.instrument).ok_or_else(|| self.name(least_squares.weakest_parameter))?;
        let mut parameters = [0.0; N];
        for (parameter, line) in parameters.iter_mut().zip(&inverse) {
            *parameter = line.iter().zip(&sums.instrument_drive).map(|(a, b)| a * b).sum();
        }
        if !parameters.iter().all(|value| value.is_finite()) {
            return Err(self.name(least_squares.weakest_parameter));
        }
        Ok(Outcome { parameters, inverse, least_squares, sums })
    }

    fn judge<const N: usize>(self, outcome: &Outcome<N>, estimate: &BaseEstimate) -> Result<(), Refusal> {
        let sums = &outcome.sums;
        let fit = &outcome.least_squares;
        let spare = self.rows().saturating_sub(N as u32).max(1);
        let rest = fit.variance * f64::from(spare) / sums.square;
        if fit.weakest < WEAKEST_OVER_RESIDUAL * rest {
            return Err(self.name(fit.weakest_parameter));
        }
        for (index, gram) in sums.gram.iter().enumerate() {
            let share = estimate.covariance[index][index] * gram[index] / sums.square;
            if share.is_nan() || share >= LARGEST_SHARE_ERROR * LARGEST_SHARE_ERROR {
                return Err(self.name(index));
            }
        }
        Ok(())
    }

    /// Whether ∫φ·sgn v is nothing but rounding in all windows that reject a constant.
    fn one_direction(self) -> bool {
        let (mut sign, mut full) = (0.0, 0.0);
        self.blocks(&mut |block| {
            if block.rows_per_window == 2 {
                sign += block.phases[0].gram[SIGN][SIGN] + block.phases[1].gram[SIGN][SIGN];
                full += f64::from(block.rows()) * block.length * block.length;
            }
        });
        full > 0.0 && sign <= 1e-9 * full
    }

    /// The refusal for a column; c and f1 together have a plainer name.
    fn name(self, column: usize) -> Refusal {
        let (mut cross, mut speed, mut sign) = (0.0, 0.0, 0.0);
        self.parts(&mut |part| {
            cross += part.phase.gram[1][SIGN];
            speed += part.phase.gram[1][1];
            sign += part.phase.gram[SIGN][SIGN];
        });
        match column {
            0 => Refusal::Undetermined(Parameter::Inertia),
            1 | 2 if cross * cross > 0.9 * speed * sign => Refusal::SingleSpeed,
            1 => Refusal::Undetermined(Parameter::Damping),
            2 => Refusal::Undetermined(Parameter::Coulomb),
            _ => Refusal::Undetermined(Parameter::Load),
        }
    }

    fn report<const N: usize>(self, round: &Round<N>, outcome: &Outcome<N>) -> BaseEstimate {
        let parameters = outcome.parameters;
        let columns = columns::<N>(parameters[2]);
        let rows = f64::from(self.rows());
        let spare = (rows - N as f64).max(1.0);
        // Meat of the sandwich: Σ w²σ² (ZᵀZ + ρ(C + Cᵀ)), ρ the residuals' correlation from window to window.
        let mut meat = [[0.0; N]; N];
        let (mut power, mut lengths) = (0.0, 0.0);
        self.parts(&mut |part| {
            let weight = round.weight(part);
            let own = residual(&part.phase.gram, &parameters).max(0.0);
            let next = residual(&part.phase.lag, &parameters);
            let correlation = if own > 0.0 { (next / own).clamp(0.0, 0.5) } else { 0.0 };
            let factor = weight * weight * own / part.rows * (rows / spare);
            for (i, (line, left)) in meat.iter_mut().zip(&columns).enumerate() {
                for (j, (entry, right)) in line.iter_mut().zip(&columns).enumerate() {
                    if part.quadrature && (i == SIGN || j == SIGN) {
                        continue;
                    }
                    let lag = bilinear(&part.phase.lag, left, right) + bilinear(&part.phase.lag, right, left);
                    *entry += factor * (bilinear(&part.phase.gram, left, right) + correlation * lag);
                }
            }
            power += own;
            lengths += part.rows * part.length * part.length;
        });
        let mut windows: u32 = 0;
        self.blocks(&mut |block| windows = windows.saturating_add(block.windows));
        let covariance = sandwich(&outcome.inverse, &meat);
        BaseEstimate {
            b: parameters[0],
            c: parameters[1],
            f1: parameters[2],
            load: parameters.get(3).copied(),
            standard_errors: core::array::from_fn(|k| libm::sqrt(covariance[k][k].max(0.0))),
            covariance,
            condition: outcome.least_squares.condition,
            windows,
            residual: libm::sqrt(power / lengths.max(f64::MIN_POSITIVE)),
        }
    }
}

type Column = [f64; COLUMNS];

const DRIVE_COLUMN: Column = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// The parameters' columns as combinations of the recorded ones: the sign's carries the edge correction.
fn columns<const N: usize>(f1: f64) -> [Column; N] {
    let mut columns = [[0.0; COLUMNS]; N];
    for (k, column) in columns.iter_mut().enumerate() {
        column[k] = 1.0;
    }
    let f1 = f1.max(0.0);
    columns[SIGN][4] = f1;
    columns[SIGN][5] = f1 * f1 * f1;
    columns
}

fn bilinear(matrix: &[Column; COLUMNS], left: &Column, right: &Column) -> f64 {
    let mut sum = 0.0;
    for (line, &a) in matrix.iter().zip(left) {
        if a != 0.0 {
            sum += a * line.iter().zip(right).map(|(entry, b)| entry * b).sum::<f64>();
        }
    }
    sum
}

/// Σ r² (or Σ `r·r_next`) for given parameters.
fn residual<const N: usize>(matrix: &[Column; COLUMNS], parameters: &[f64; N]) -> f64 {
    let mut direction = DRIVE_COLUMN;
    for (column, parameter) in columns::<N>(parameters[2]).iter().zip(parameters) {
        for (entry, part) in direction.iter_mut().zip(column) {
            *entry -= parameter * part;
        }
    }
    bilinear(matrix, &direction, &direction)
}

/// Inverse by Gauss-Jordan elimination with row pivoting; `None` when a pivot vanishes.
fn invert<const N: usize>(mut a: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut inverse = [[0.0; N]; N];
    for (k, line) in inverse.iter_mut().enumerate() {
        line[k] = 1.0;
    }
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        a.swap(k, pivot);
        inverse.swap(k, pivot);
        let scale = 1.0 / a[k][k];
        if !scale.is_finite() {
            return None;
        }
        for j in 0..N {
            a[k][j] *= scale;
            inverse[k][j] *= scale;
        }
        for i in (0..N).filter(|&i| i != k) {
            let factor = a[i][k];
            for j in 0..N {
                a[i][j] -= factor * a[k][j];
                inverse[i][j] -= factor * inverse[k][j];
            }
        }
    }
    Some(inverse)
}

/// inverse·meat·inverseᵀ.
fn sandwich<const N: usize>(inverse: &[[f64; N]; N], meat: &[[f64; N]; N]) -> [[f64; 4]; 4] {
    let mut covariance = [[0.0; 4]; 4];
    for (line, left) in covariance.iter_mut().zip(inverse) {
        for (entry, right) in line.iter_mut().zip(inverse) {
            for (row, &a) in meat.iter().zip(left) {
                *entry += a * row.iter().zip(right).map(|(value, b)| value * b).sum::<f64>();
            }
        }
    }
    covariance
}
