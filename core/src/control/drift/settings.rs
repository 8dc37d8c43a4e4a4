//! Settings of the drift watch, what they are for a motion, and why they are refused.

use crate::control::compensator::CompensatorError;
use crate::plant::Base;
use crate::says::says;
use crate::scalar::Real;

/// Settings of the watch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftSettings<F = f64> {
    /// ωo, rad/s; several times the motion's own frequencies, well below 1/Ts.
    pub bandwidth_rad_s: F,
    /// Speed below which the axis counts as resting, X/s; > 0.
    pub rest_speed: F,
    /// Time after a reversal until blocks are taken, s; a few 1/ωo.
    pub settle_s: F,
    /// Length of a block, s; at least four ticks.
    pub block_s: F,
    /// Blocks of either direction that teach mean and scale; at least 8.
    pub calibration: u32,
    /// k: what a block may be off, in units of the scale; > 0.
    pub slack: F,
    /// h: the alarm's level; > 0.
    pub threshold: F,
    /// Smallest scale, drive units: a residual that happened to be still in the calibrated stretch must not make the
    /// watch nervous.
    pub smallest_scale: F,
}

/// The motion that is watched, and the encoder it is watched with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<F = f64> {
    /// Largest speed, X/s.
    pub speed: F,
    /// Largest acceleration, X/s²; 0 where the motion has none that is finite.
    pub acceleration: F,
    /// Encoder step, X.
    pub encoder_step: F,
}

/// Share of f1 that is to be found.
const RISE: f64 = 0.3;
/// Scales that it is to be off in a block, if the strokes are long enough.
const SCALES: f64 = 8.0;
/// ωo of long strokes, rad/s: blocks of a tenth of a second, so that a motion that is slow is not watched slowly.
const SLOWEST_RAD_S: f64 = 30.0;
/// Steps of a tenth in which a block grows, at the most: to a thousand times its first length (a fixed point may stand still).
const MOST_STEPS: usize = 73;
/// Fewest blocks of either direction, and strokes of it, that teach.
const BLOCKS: u32 = 12;
const STROKES: f64 = 1.5;

impl<F: Real> DriftSettings<F> {
    /// Settings that find a rise of f1 by 30 % along a motion as soon as this encoder allows.
    ///
    /// A stroke lasts π·speed/acceleration (a sine's half period, a lower bound for profiles; a second if there is no
    /// acceleration). ωo is 60 per stroke and 30 rad/s at least. It is less where its trembling by ωo·Δ would pass a
    /// tenth of the speed. It is never above 0.1/Ts. In the shortest block 30 % of f1 is eight times the encoder's
    /// noise; a stroke holds at least two blocks. The slack is 1 and the alarm at 12. Calibration takes a stroke and a
    /// half, 12 blocks at least. The scale is that of half an encoder step of noise or 2 % of f1 at least.
    ///
    /// # Errors
    /// [`DriftError::Motion`]: no motion, or too slow or too short for encoder and tick.
    pub fn along(motion: &Motion<F>, base: &Base<F>, tick_s: F) -> Result<Self, DriftError> {
        let Motion { speed, acceleration, encoder_step } = *motion;
        let positive = |value: F| value.is_finite() && value > F::ZERO;
        if !(positive(speed) && positive(encoder_step) && positive(tick_s) && positive(base.b)) {
            return Err(DriftError::Motion);
        }
        let number = F::from_f64;
        let stroke_s =
            if positive(acceleration) { number(core::f64::consts::PI) * speed / acceleration } else { F::ONE };
        let bandwidth_rad_s = (number(60.0) / stroke_s)
            .max(number(SLOWEST_RAD_S))
            .min(speed.scale(0.1) / encoder_step)
            .max(number(20.0) / stroke_s)
            .min(number(0.1) / tick_s);
        let rest_speed = speed.scale(0.1).max(bandwidth_rad_s * encoder_step);
        let settle_s = number(4.0) / bandwidth_rad_s;
        // A sine is below the rest speed for less than that share of its stroke; a twentieth in hand.
        let usable_s = (stroke_s * (F::ONE - rest_speed / speed) - settle_s).scale(0.95);
        let noise = |block_s: F| noise(base, encoder_step, tick_s, block_s);
        let mut block_s = number(3.0) / bandwidth_rad_s;
        for _ in 0..MOST_STEPS {
            if block_s >= usable_s || noise(block_s) <= base.f1.scale(RISE / SCALES) {
                break;
            }
            block_s = block_s.scale(1.1);
        }
        // That fit into a stroke, each half a block after the one before.
        let blocks = ((usable_s + usable_s) / block_s - F::ONE).max(number(2.0)).to_u32();
        let hop = (usable_s / (F::from_u32(blocks + 1) * tick_s)).to_u32();
        if rest_speed >= speed.scale(0.5) || hop < 2 {
            return Err(DriftError::Motion);
        }
        let block_s = F::from_u32(hop) * (tick_s + tick_s);
        Ok(Self {
            bandwidth_rad_s,
            rest_speed,
            settle_s,
            // The ticks are counted by rounding down.
            block_s: block_s.scale(1.0 + 1e-4),
            calibration: F::from_u32(blocks).scale(STROKES).to_u32().max(BLOCKS),
            slack: F::ONE,
            threshold: number(12.0),
            smallest_scale: noise(block_s).max(base.f1.scale(0.02)),
        })
    }
}

/// What half an encoder step of noise makes of a block, drive units: ∫w″² is 720 and ∫w′² is 120/7 per block.
#[inline(never)]
fn noise<F: Real>(base: &Base<F>, encoder_step: F, tick_s: F, block_s: F) -> F {
    let per_s = F::ONE / block_s;
    let force = base.c.scale(4.14) + base.b.scale(26.83) * per_s;
    force * per_s * (tick_s * per_s).sqrt() * encoder_step.scale(0.5)
}

/// Why a watch is refused; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriftError {
    /// The model.
    Model(CompensatorError),
    /// The tick is not finite and positive.
    Tick,
    /// The motion is none, or too slow or too short for encoder and tick.
    Motion,
    /// ωo is not positive or above 1/(2·Ts).
    Bandwidth,
    /// The rest speed is not finite and positive.
    RestSpeed,
    /// A block or the time after a reversal is not positive, or a block shorter than four ticks.
    Block,
    /// Fewer than 8 blocks of calibration.
    Calibration,
    /// Slack or threshold is not finite and positive.
    Threshold,
    /// The smallest scale is not finite and positive.
    Scale,
}

says! { DriftError:
    Self::Model(error) => "{error}",
    Self::Tick => "the tick must be a finite number above 0",
    Self::Motion => "the motion is too slow or too short for the encoder and the tick",
    Self::Bandwidth => "the observer's bandwidth must be above 0, and at most half the tick rate",
    Self::RestSpeed => "the rest speed must be a finite number above 0",
    Self::Block => "a block must be four ticks or longer, and the time after a reversal above 0",
    Self::Calibration => "the calibration must have 8 blocks or more",
    Self::Threshold => "slack and threshold must be finite numbers above 0",
    Self::Scale => "the smallest scale must be a finite number above 0",
}
