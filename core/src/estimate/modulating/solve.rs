//! From the blocks of all experiments to (b, c, f1), their covariance, or the refusal.

use super::block::{Block, Phase};
use super::forms::{Column, DRIVE, SIGN, bilinear, columns, drive_column, invert, residual, residual_form, sandwich};
use crate::estimate::linear::{NormalEquations, Solution, SolveError};
use crate::plant::Base;
use crate::says::says;
use crate::scalar::{ExactSum, SolverReal};

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

says! { Refusal:
    Self::TooShort => "the record is shorter than the windows need",
    Self::NoMotion => "the axis rests in every window",
    Self::NotFinite => "numbers too large to be summed, in every window",
    Self::OneDirection => "the axis moves in one direction only: Coulomb friction cannot be told from a constant load",
    Self::SingleSpeed => "c and f1 cannot be separated: all motion has the same speed",
    Self::Undetermined(parameter) => "{parameter:?} cannot be told from what is left over",
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

/// The base model with what is known about its errors, in f64 or f32. Units as in [`Base`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseEstimate<R = f64> {
    /// Inertia.
    pub b: R,
    /// Viscous friction and back-EMF.
    pub c: R,
    /// Coulomb friction.
    pub f1: R,
    /// Constant load in drive units, if a window of multiple 0 asked for it.
    pub load: Option<R>,
    /// Standard errors of b, c, f1 and the load (0 if not asked for).
    pub standard_errors: [R; 4],
    /// Covariance in the same order.
    pub covariance: [[R; 4]; 4],
    /// Condition of the scaled normal matrix.
    pub condition: R,
    /// Windows used, over all experiments and frequencies.
    pub windows: u32,
    /// Rms of the equation residual per window length, in drive units.
    pub residual: R,
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

/// A share of the drive's power that is rounding.
const FLOOR: f64 = 1e-15;
/// Rounds of iterative refinement: each gains as many digits as the condition leaves of the type's.
const REFINEMENTS: usize = 3;
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
/// Each block is weighted by its residual variance. The edges are corrected with the f1 found (see
/// [`super::Modulating::push`]); the covariance allows for the noise that half-overlapping windows share.
///
/// # Errors
/// [`Refusal`] names what the data cannot determine; its advice names the experiment that would.
pub fn estimate<R: SolverReal>(experiments: &[&[Block<R>]]) -> Result<BaseEstimate<R>, Refusal> {
    let problem = Problem::checked(experiments)?;
    if problem.asks_for_load() { problem.solve::<4>() } else { problem.solve::<3>() }
}

/// As [`estimate`], for blocks without a window of multiple 0. Where no call needs the load, its code is not linked
/// either (4 KiB on a microcontroller).
///
/// # Errors
/// As [`estimate`]; and [`Refusal::Undetermined`] names the load where a block asks for it.
pub fn estimate_base<R: SolverReal>(experiments: &[&[Block<R>]]) -> Result<BaseEstimate<R>, Refusal> {
    let problem = Problem::checked(experiments)?;
    if problem.asks_for_load() {
        return Err(Refusal::Undetermined(Parameter::Load));
    }
    problem.solve::<3>()
}

#[derive(Clone, Copy)]
struct Problem<'a, R: SolverReal> {
    experiments: &'a [&'a [Block<R>]],
}

/// The equations of one phase of one block.
struct Part<'a, R: SolverReal> {
    phase: &'a Phase<R>,
    rows: R,
    length: R,
    quadrature: bool,
}

/// What the weights of a round follow from.
#[derive(Clone, Copy)]
struct Round<R, const N: usize> {
    parameters: [R; N],
    pooled: Option<R>,
}

impl<R: SolverReal, const N: usize> Round<R, N> {
    /// Pooled variance over the variance of the part's equations, the pooled one counted as one more row.
    fn weight(&self, part: &Part<'_, R>) -> R {
        let Some(pooled) = self.pooled else {
            return R::ONE;
        };
        let pooled = pooled.max(R::MIN_POSITIVE);
        (part.rows + R::ONE) * (pooled / (residual(&part.phase.gram, &self.parameters) + pooled))
    }
}

/// One round's weighted sums. `columns`ᵀ·`columns`, and instruments against columns, drive and instruments.
struct Sums<R: SolverReal, const N: usize> {
    gram: [[R::Sum; N]; N],
    drive: [R::Sum; N],
    square: R::Sum,
    instrument: [[R::Sum; N]; N],
    instrument_drive: [R::Sum; N],
}

/// One round's result.
struct Outcome<R: SolverReal, const N: usize> {
    parameters: [R; N],
    /// (ZᵀA)⁻¹.
    inverse: [[R; N]; N],
    least_squares: Solution<R, N>,
    /// Diagonal of the columns' Gram matrix, and the drive's.
    gram: [R; N],
    square: R,
}

impl<'a, R: SolverReal> Problem<'a, R> {
    fn checked(experiments: &'a [&'a [Block<R>]]) -> Result<Self, Refusal> {
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
    fn blocks(self, visit: &mut dyn FnMut(&'a Block<R>)) {
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
    fn parts(self, visit: &mut dyn FnMut(&Part<'a, R>)) {
        self.blocks(&mut |block| {
            let used = block.rows_per_window as usize;
            for (index, phase) in block.phases.iter().take(used).enumerate() {
                let rows = number(block.windows);
                visit(&Part { phase, rows, length: block.length, quadrature: index == 1 });
            }
        });
    }

    fn rows(self) -> u32 {
        let mut rows: u32 = 0;
        self.blocks(&mut |block| rows = rows.saturating_add(block.rows()));
        rows
    }

    fn solve<const N: usize>(self) -> Result<BaseEstimate<R>, Refusal> {
        let mut round = Round { parameters: [R::ZERO; N], pooled: None };
        for _ in 1..ROUNDS {
            let parameters = self.once(&round)?.parameters;
            // The floor stands for the rounding of the sums, where the data fit exactly.
            let mut power = R::ZERO;
            self.parts(&mut |part| {
                let drive = part.phase.gram[DRIVE][DRIVE].rounded();
                power += residual(&part.phase.gram, &parameters) + drive.scale(FLOOR);
            });
            round = Round { parameters, pooled: Some(power / number(self.rows().max(1))) };
        }
        let outcome = self.once(&round)?;
        let estimate = self.report(&round, &outcome);
        self.judge(&outcome, &estimate)?;
        Ok(estimate)
    }

    fn sums<const N: usize>(self, round: &Round<R, N>) -> Sums<R, N> {
        let columns: [Column<R>; N] = columns(round.parameters[2]);
        let (matrix, vector) = ([[R::Sum::default(); N]; N], [R::Sum::default(); N]);
        let mut sums: Sums<R, N> = Sums {
            gram: matrix,
            drive: vector,
            square: R::Sum::default(),
            instrument: matrix,
            instrument_drive: vector,
        };
        self.parts(&mut |part| {
            let weight = round.weight(part);
            let weighted =
                |left: &Column<R>, right: &Column<R>| bilinear::<R>(&part.phase.gram, left, right).times(weight);
            for (i, column) in columns.iter().enumerate() {
                let instrument = !(part.quadrature && i == SIGN);
                let add = |all: &mut R::Sum, instruments: &mut R::Sum, other: &Column<R>| {
                    let product = weighted(column, other);
                    *all = all.plus(product);
                    if instrument {
                        *instruments = instruments.plus(product);
                    }
                };
                for (j, other) in columns.iter().enumerate() {
                    add(&mut sums.gram[i][j], &mut sums.instrument[i][j], other);
                }
                add(&mut sums.drive[i], &mut sums.instrument_drive[i], &drive_column());
            }
            sums.square = sums.square.plus(weighted(&drive_column(), &drive_column()));
        });
        sums
    }

    fn once<const N: usize>(self, round: &Round<R, N>) -> Result<Outcome<R, N>, Refusal> {
        let sums = self.sums(round);
        let rounded = |matrix: &[[R::Sum; N]; N]| matrix.map(|line| line.map(R::Sum::rounded));
        let (gram, square) = (rounded(&sums.gram), sums.square.rounded());
        // Least squares says whether the parameters can be told apart; the instruments give them without bias.
        let equations = NormalEquations::from_sums(gram, sums.drive.map(R::Sum::rounded), square, self.rows());
        let least_squares = match equations.solve(R::from_f64(MAX_CONDITION)) {
            Ok(solution) => solution,
            Err(SolveError::TooFewRows) => return Err(Refusal::TooShort),
            Err(SolveError::NotFinite) => return Err(Refusal::NotFinite),
            Err(SolveError::Undetermined { parameter }) => return Err(self.name(parameter)),
        };
        let inverse = invert(rounded(&sums.instrument)).ok_or_else(|| self.name(least_squares.weakest_parameter))?;
        // What the inverse's rounding leaves is solved for again (iterative refinement): the sums' digits count.
        let mut parameters = [R::ZERO; N];
        for _ in 0..REFINEMENTS {
            let mut rest = [R::ZERO; N];
            for ((rest, line), &drive) in rest.iter_mut().zip(&sums.instrument).zip(&sums.instrument_drive) {
                let mut sum = drive;
                for (entry, &parameter) in line.iter().zip(&parameters) {
                    sum = sum.plus(entry.times(-parameter));
                }
                *rest = sum.rounded();
            }
            for (parameter, line) in parameters.iter_mut().zip(&inverse) {
                for (&entry, &rest) in line.iter().zip(&rest) {
                    *parameter += entry * rest;
                }
            }
        }
        if !parameters.iter().all(|value| value.is_finite()) {
            return Err(self.name(least_squares.weakest_parameter));
        }
        Ok(Outcome { parameters, inverse, least_squares, gram: core::array::from_fn(|k| gram[k][k]), square })
    }

    fn judge<const N: usize>(self, outcome: &Outcome<R, N>, estimate: &BaseEstimate<R>) -> Result<(), Refusal> {
        let fit = &outcome.least_squares;
        let spare = self.rows().saturating_sub(N as u32).max(1);
        let rest = fit.variance * number(spare) / outcome.square;
        if fit.weakest < rest.scale(WEAKEST_OVER_RESIDUAL) {
            return Err(self.name(fit.weakest_parameter));
        }
        for (index, &gram) in outcome.gram.iter().enumerate() {
            let share = estimate.covariance[index][index] * (gram / outcome.square);
            // Written so that NaN is refused too.
            let small = share < R::from_f64(LARGEST_SHARE_ERROR * LARGEST_SHARE_ERROR);
            if !small {
                return Err(self.name(index));
            }
        }
        Ok(())
    }

    /// Whether ∫φ·sgn v is nothing but rounding in all windows that reject a constant.
    fn one_direction(self) -> bool {
        let (mut sign, mut full) = (R::ZERO, R::ZERO);
        self.blocks(&mut |block| {
            if block.rows_per_window == 2 {
                sign += block.phases[0].gram[SIGN][SIGN].rounded() + block.phases[1].gram[SIGN][SIGN].rounded();
                full += number::<R>(block.rows()) * block.length * block.length;
            }
        });
        full > R::ZERO && sign <= full.scale(1e-9)
    }

    /// The refusal for a column; c and f1 together have a plainer name.
    fn name(self, column: usize) -> Refusal {
        let (mut cross, mut speed, mut sign) = (R::ZERO, R::ZERO, R::ZERO);
        self.parts(&mut |part| {
            cross += part.phase.gram[1][SIGN].rounded();
            speed += part.phase.gram[1][1].rounded();
            sign += part.phase.gram[SIGN][SIGN].rounded();
        });
        match column {
            0 => Refusal::Undetermined(Parameter::Inertia),
            1 | 2 if cross * cross > (speed * sign).scale(0.9) => Refusal::SingleSpeed,
            1 => Refusal::Undetermined(Parameter::Damping),
            2 => Refusal::Undetermined(Parameter::Coulomb),
            _ => Refusal::Undetermined(Parameter::Load),
        }
    }

    fn report<const N: usize>(self, round: &Round<R, N>, outcome: &Outcome<R, N>) -> BaseEstimate<R> {
        let parameters = outcome.parameters;
        let columns = columns::<R, N>(parameters[2]);
        let rows = number::<R>(self.rows());
        let spare = (rows - number(N as u32)).max(R::ONE);
        // Meat of the sandwich: Σ w²σ² (ZᵀZ + ρ(C + Cᵀ)), ρ the residuals' correlation from window to window.
        let mut meat = [[R::ZERO; N]; N];
        let (mut power, mut lengths) = (R::ZERO, R::ZERO);
        self.parts(&mut |part| {
            let weight = round.weight(part);
            let own = residual(&part.phase.gram, &parameters);
            let next = residual_form(&part.phase.lag, &parameters);
            let correlation = if own > R::ZERO { (next / own).max(R::ZERO).min(R::from_f64(0.5)) } else { R::ZERO };
            let factor = weight * weight * own / part.rows * (rows / spare);
            for (i, (line, left)) in meat.iter_mut().zip(&columns).enumerate() {
                for (j, (entry, right)) in line.iter_mut().zip(&columns).enumerate() {
                    if part.quadrature && (i == SIGN || j == SIGN) {
                        continue;
                    }
                    let form = |matrix, left, right| bilinear::<R>(matrix, left, right).rounded();
                    let lag = form(&part.phase.lag, left, right) + form(&part.phase.lag, right, left);
                    *entry += factor * (form(&part.phase.gram, left, right) + correlation * lag);
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
            standard_errors: core::array::from_fn(|k| covariance[k][k].sqrt()),
            covariance,
            condition: outcome.least_squares.condition,
            windows,
            residual: (power / lengths.max(R::MIN_POSITIVE)).sqrt(),
        }
    }
}

fn number<R: SolverReal>(count: u32) -> R {
    R::from_i64(i64::from(count))
}
