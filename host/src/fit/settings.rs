//! Every constant of the fit, with its unit and its reason.

/// Half-width of the local cubic that smooths the motion, s (docs/theory.md, section 5). It is [`MIN_HALF_SAMPLES`]
/// samples at the least.
pub(super) const HALF_WIDTH_S: f64 = 0.010;
/// Fewest samples to either side of a local cubic. Nine points carry four coefficients and a residual.
pub(super) const MIN_HALF_SAMPLES: usize = 4;

/// Median intervals from which a longer one is a gap. A few lost rows are none.
pub(super) const GAP_INTERVALS: f64 = 5.0;
/// Largest difference of an interval from a whole number of median ones, as a share of the median. One larger
/// difference makes the clock irregular: its other stamps may be wrong too.
pub(super) const IRREGULAR: f64 = 0.3;
/// Interval over which the typical acceleration is taken, s. It is so long that the noise does not count.
pub(super) const ACCELERATION_S: f64 = 0.1;
/// Share of the largest position below which residuals are the rounding of numbers.
pub(super) const ROUNDING: f64 = 1e-10;
/// Classes of speed in which a jittered clock's noise is estimated.
pub(super) const SPEED_CLASSES: usize = 24;
/// Least noise, as a share of the encoder step. An axis at rest between two steps shows none.
pub(super) const LEAST_NOISE: f64 = 0.05;

/// Fewest effective samples of a segment. However smooth its residual, the misfit differs from one segment to the next.
pub(super) const LEAST_SAMPLES: f64 = 4.0;

/// Longest sub-step, s. Reversals within longer ones cost more than the data's noise. At 10 ms the b of a relay
/// recording is 3e-4 too low, six of its standard errors.
pub(super) const STEP_S: f64 = 1e-3;

/// Step of the sensor's numerical slope, position units.
pub(super) const SENSOR_STEP: f64 = 1e-6;

/// Samples whose products are summed in one go. The sums stay in registers meanwhile.
pub(super) const TOGETHER: usize = 8;

/// Most free parameters. With the four numbers of a start they fill the longest dual number.
pub(super) const MOST_FREE: usize = 16;

/// Damping of the first step.
pub(super) const DAMPING: f64 = 1e-3;
/// Factor of the damping where the equations are singular, where a step makes the cost worse, and where it makes it
/// better.
pub(super) const DAMPING_SINGULAR: f64 = 10.0;
pub(super) const DAMPING_WORSE: f64 = 8.0;
pub(super) const DAMPING_BETTER: f64 = 0.2;
/// Least damping, and the damping above which a fit ends.
pub(super) const DAMPING_RANGE: [f64; 2] = [1e-9, 1e6];
/// Damping of a step of one segment's start alone, within a step of all.
pub(super) const START_DAMPING: f64 = 1e-2;

/// Largest step of a strictly positive parameter, as the natural logarithm of the ratio: a factor of 4.5.
pub(super) const MOST_RATIO: f64 = 1.5;

/// Growth of a segment's mean square in one step that counts as a jump.
pub(super) const JUMP: f64 = 1.3;

/// Gain of a step below which it is small: nats, and nats for each segment. It is far below the evidence of any
/// decision.
pub(super) const SMALL_GAIN: [f64; 2] = [0.1, 0.002];
/// Share of the gain of all steps below which a step is small. Two small steps in a row end the fit. One may be a
/// narrow valley's, because the weights of the segments follow the fit.
pub(super) const ENOUGH: f64 = 2e-4;

/// Iterations of a start alone, with the model held.
pub const SCORE_ITERATIONS: usize = 6;

/// Fewest iterations of a fit that is softened.
pub(super) const LEAST_TO_SOFTEN: usize = 5;
/// Multiple of the noise that the median segment must reach for a fit to be softened.
pub(super) const SOFTEN_ABOVE: f64 = 4.0;

/// Largest forces of a fit, as multiples of the largest drive. They are that of inertia at the typical acceleration, of
/// viscous friction at the typical speed, and of Coulomb friction. A missing effect may move the axis to and fro, which
/// no drive does. All three would then grow together without bound.
pub(super) const MOST_FORCE: f64 = 3.0;

/// Standard deviation of the prior of a second body's position, in deviations of the noise. It is about the position
/// that the motion before the segment gives. The velocity's is a tenth of that per sample, the slope of the smoothing's
/// local cubic. Without a prior a body that is free at every start fits whatever else is missing.
pub(super) const MEMORY_DEVIATIONS: f64 = 10.0;
/// Most nats that the start of a body within a gap costs. A body that was lost among impacts may be anywhere.
pub(super) const LOST: f64 = 12.0;

/// Multiple of the median segment's mean square, and of the floor, above which a segment is started anew. The mean
/// square of 400 samples of noise is within 1 ± 0.25.
pub(super) const STUCK: f64 = 1.5;
/// Fewest segments for which the median says something.
pub(super) const FEW: usize = 4;
/// Start velocities that are tried about the smoothed velocity, in its standard deviations.
pub(super) const VELOCITIES: [f64; 10] = [0.0, -0.5, 0.5, -1.0, 1.0, -1.5, 1.5, -2.5, 2.5, 4.0];
/// Start velocities that are then tried about the best, in the same unit. A body that all but rests at its start leaves
/// a narrow well.
pub(super) const FINER: [f64; 3] = [0.25, 0.12, 0.06];
/// Standard deviation of the slope of a local cubic over `n` points of half-width h, in σ/h: √(75/4n), n = 21.
pub(super) const SLOPE_DEVIATIONS: f64 = 0.945;
/// Steps of a new start alone.
pub(super) const STEPS: usize = 3;
/// Share of the old mean square below which a new start is taken.
pub(super) const WORTH: f64 = 0.8;

/// Grid over a gap: points to either side of its middle, over the whole gap. The velocities reach twice the segment's
/// typical speed.
pub(super) const WIDE: i32 = 4;
/// Rounds of finer grids about the best point, each a third as wide in its step.
pub(super) const CLOSER: usize = 3;
/// Points of a finer grid to either side.
pub(super) const NARROW: i32 = 2;
