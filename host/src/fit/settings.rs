//! Every constant of the fit, with its unit and its reason.

/// Half-width of the local cubic that smooths the motion, s (docs/theory.md, section 5); at least [`MIN_HALF_SAMPLES`] samples.
pub(super) const HALF_WIDTH_S: f64 = 0.010;
/// Samples to either side of a local cubic at the least: nine points carry four coefficients and a residual.
pub(super) const MIN_HALF_SAMPLES: usize = 4;

/// Median intervals from which a longer one is a gap: a few lost rows are not one.
pub(super) const GAP_INTERVALS: f64 = 5.0;
/// Largest difference of an interval from a whole number of median ones, as a share of the median. A clock with a larger one
/// is not believed: its other stamps may be wrong too.
pub(super) const IRREGULAR: f64 = 0.3;
/// Interval over which the typical acceleration is taken, s: long enough that the noise does not count.
pub(super) const ACCELERATION_S: f64 = 0.1;
/// Share of the largest position below which residuals are the rounding of numbers.
pub(super) const ROUNDING: f64 = 1e-10;
/// Classes of speed in which a jittered clock's noise is looked at.
pub(super) const SPEED_CLASSES: usize = 24;
/// Share of the encoder step that the noise is at the least: an axis at rest between two steps shows none.
pub(super) const LEAST_NOISE: f64 = 0.05;

/// A segment counts for at least this many samples, however smooth its residual: misfit differs from one to the next.
pub(super) const LEAST_SAMPLES: f64 = 4.0;

/// Longest sub-step, s. Reversals within longer ones cost more than the data's noise: at 10 ms, b of a relay recording
/// comes out 3e-4 low, six of its standard errors.
pub(super) const STEP_S: f64 = 1e-3;

/// Step of the sensor's numerical slope, position units.
pub(super) const SENSOR_STEP: f64 = 1e-6;

/// Samples whose products are summed in one go: the sums stay in registers meanwhile.
pub(super) const TOGETHER: usize = 8;

/// Most free parameters: with the four numbers of a start they fill the longest dual number.
pub(super) const MOST_FREE: usize = 16;

/// Damping of the first step, and what a step that fails or succeeds multiplies it by. Beyond the largest a step is none.
pub(super) const DAMPING: f64 = 1e-3;
pub(super) const DAMPING_SINGULAR: f64 = 10.0;
pub(super) const DAMPING_WORSE: f64 = 8.0;
pub(super) const DAMPING_BETTER: f64 = 0.2;
pub(super) const DAMPING_RANGE: [f64; 2] = [1e-9, 1e6];
/// Damping of a step of one segment's start alone, within a step of all.
pub(super) const START_DAMPING: f64 = 1e-2;

/// Largest step of a strictly positive parameter, natural logarithm of the ratio: a factor of 4.5.
pub(super) const MOST_RATIO: f64 = 1.5;

/// Growth of a segment's mean square in one step that counts as a jump.
pub(super) const JUMP: f64 = 1.3;

/// Gain of a step, in nats and in nats per segment, that is far below the evidence that any decision asks for.
pub(super) const SMALL_GAIN: [f64; 2] = [0.1, 0.002];
/// Two steps in a row that gain less than this share of what all steps gained end the fit: the weights of the segments
/// follow the fit, so one small step may be a narrow valley's.
pub(super) const ENOUGH: f64 = 2e-4;

/// Iterations of a start on its own, the model held.
pub const SCORE_ITERATIONS: usize = 6;

/// Fits of fewer iterations are not softened; nor those whose median segment is below this multiple of the noise.
pub(super) const LEAST_TO_SOFTEN: usize = 5;
pub(super) const SOFTEN_ABOVE: f64 = 4.0;

/// Forces of inertia and viscous friction at typical acceleration and speed, and of Coulomb friction, in a fit, as multiples of the
/// largest drive, at the most. Where an effect that is not in the model moves the axis to and fro, all three would grow beyond
/// all bounds together: motion that no drive has to do with.
pub(super) const MOST_FORCE: f64 = 3.0;

/// Noise deviations by which a second body's position is expected to differ from what the motion before the segment says
/// (the standard deviation of a prior: without one, a body free at every start fits whatever else is missing); its
/// velocity, by a tenth of that per sample, the slope of the smoothing's local cubic.
pub(super) const MEMORY_DEVIATIONS: f64 = 10.0;
/// Nats that the start of a body within a gap may cost at the most: one that was lost among impacts may be anywhere.
pub(super) const LOST: f64 = 12.0;

/// A segment is started anew whose mean square is above this multiple of the median segment's, and of the floor: that of 400
/// samples of noise is within 1 ± 0.25.
pub(super) const STUCK: f64 = 1.5;
/// Of fewer segments than these the median says nothing.
pub(super) const FEW: usize = 4;
/// Start velocities tried, in standard deviations of the smoothed velocity about it.
pub(super) const VELOCITIES: [f64; 10] = [0.0, -0.5, 0.5, -1.0, 1.0, -1.5, 1.5, -2.5, 2.5, 4.0];
/// Then about the best of them, by these: a body that all but rests at the start leaves a narrow well.
pub(super) const FINER: [f64; 3] = [0.25, 0.12, 0.06];
/// Standard deviation of the slope of a local cubic over `n` points of half-width h, in σ/h: √(75/4n), n = 21.
pub(super) const SLOPE_DEVIATIONS: f64 = 0.945;
/// Steps of a new start on its own.
pub(super) const STEPS: usize = 3;
/// Share of its mean square that a start must lose to be taken in exchange.
pub(super) const WORTH: f64 = 0.8;

/// Grid over a gap: positions tried over the gap to either side, and velocities up to twice the segment's typical speed to either side.
pub(super) const WIDE: i32 = 4;
/// Then about the best, in steps of a third, so many times, so many to either side.
pub(super) const CLOSER: usize = 3;
pub(super) const NARROW: i32 = 2;
