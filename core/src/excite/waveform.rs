//! Periodic waveforms in integers: open-loop drives and moving references of the tick, without an FPU.
//!
//! A waveform is a [`Shape`] read at a phase in units of 2⁻³² turn, which advances by a constant step per tick and wraps
//! by itself. Multisines and anything else periodic are a [`Shape::Table`].

use serde::{Deserialize, Serialize};

use crate::scalar::Real;
use crate::scalar::nco::sin_cos;

/// Points of a [`Shape::Table`]'s period; read with linear interpolation, so the 64th harmonic still has 8 of them.
pub const TABLE_POINTS: usize = 512;
/// One, in the output of [`Shape::at`]: Q15.
pub const ONE_Q15: i32 = 1 << 15;
/// Bits of the phase below a point of the table.
const FRACTION_BITS: u32 = 23;

/// The points of a period, Q15.
pub type Table = [i16; TABLE_POINTS];

/// One period of a waveform between −1 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shape {
    /// 0.
    #[default]
    Still,
    /// `sin`, from 0 upwards.
    Sine,
    /// From 0 up to 1, down to −1 and back to 0.
    Triangle,
    /// From 0 up to 1 in the first half turn, from 0 down to −1 in the second.
    Ramp,
    /// The table's points.
    Table,
}

impl Shape {
    /// The value at `phase` (units of 2⁻³² turn), Q15 in ±[`ONE_Q15`].
    #[must_use]
    pub fn at(self, phase: u32, table: &Table) -> i32 {
        match self {
            Self::Still => 0,
            Self::Sine => (sin_cos(phase).0 + (1 << 14)) >> 15,
            Self::Triangle => {
                // A quarter turn later the fold is at the half turn: |2·phase − 1|.
                let folded = (phase.wrapping_add(1 << 30) as i32).unsigned_abs();
                ONE_Q15 - (((1u32 << 31) - folded) >> 15) as i32
            }
            Self::Ramp => {
                let rise = ((phase & 0x7fff_ffff) >> 16) as i32;
                if phase >> 31 == 0 { rise } else { -rise }
            }
            Self::Table => {
                let index = (phase >> FRACTION_BITS) as usize % TABLE_POINTS;
                let (here, next) = (i32::from(table[index]), i32::from(table[(index + 1) % TABLE_POINTS]));
                // 15 bits of the fraction: the product of two 16-bit numbers and the difference fit an i32.
                let fraction = ((phase >> (FRACTION_BITS - 14)) & 0x3fff) as i32;
                here + (((next - here) * fraction) >> 14)
            }
        }
    }

    /// `amplitude` times the value at `phase`, rounded to nearest.
    #[must_use]
    pub fn scaled(self, amplitude: i32, phase: u32, table: &Table) -> i32 {
        let product = i64::from(amplitude) * i64::from(self.at(phase, table));
        // |at| ≤ 2¹⁵, so the quotient is no larger than the amplitude; only −(i32::MIN) does not fit.
        ((product + (1 << 14)) >> 15).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    }
}

/// Phase advance per tick, in units of 2⁻³² turn, of a period of `period_ticks` (≥ 2); `None` outside the range of the
/// phase accumulator. For the host: it is not called in the tick.
#[must_use]
pub fn phase_step<F: Real>(period_ticks: F) -> Option<u32> {
    let step = F::from_f64(4_294_967_296.0) / period_ticks + F::from_f64(0.5);
    // Written so that NaN is refused too.
    (step >= F::ONE && step <= F::from_f64(2_147_483_648.75)).then_some(step.to_u32())
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUARTER: u32 = 1 << 30;

    #[test]
    fn shapes_start_at_zero_and_reach_one() {
        let table = [0; TABLE_POINTS];
        for (shape, quarters) in [
            (Shape::Still, [0, 0, 0, 0]),
            (Shape::Sine, [0, ONE_Q15, 0, -ONE_Q15]),
            (Shape::Triangle, [0, ONE_Q15, 0, -ONE_Q15]),
            (Shape::Ramp, [0, ONE_Q15 / 2, 0, -ONE_Q15 / 2]),
        ] {
            for (i, expected) in quarters.into_iter().enumerate() {
                assert_eq!(shape.at(QUARTER * i as u32, &table), expected, "{shape:?} after {i} quarters");
            }
        }
        assert_eq!(Shape::Ramp.at((1 << 31) - 1, &table), ONE_Q15 - 1);
        assert_eq!(Shape::Ramp.at(u32::MAX, &table), 1 - ONE_Q15);
    }

    #[test]
    fn a_table_is_met_at_its_points_and_straight_between_them() {
        let mut table = [0; TABLE_POINTS];
        (table[3], table[4], table[TABLE_POINTS - 1]) = (-32768, 32767, 100);
        let point = 1u32 << FRACTION_BITS;
        assert_eq!(Shape::Table.at(3 * point, &table), -32768);
        assert_eq!(Shape::Table.at(4 * point, &table), 32767);
        // Half of the way from −32768 to 32767, rounded down.
        assert_eq!(Shape::Table.at(3 * point + point / 2, &table), -1);
        // The last point leads back to the first.
        assert_eq!(Shape::Table.at(0u32.wrapping_sub(point / 2), &table), 50);
    }

    #[test]
    fn extreme_amplitudes_do_not_wrap() {
        let table = [i16::MIN; TABLE_POINTS];
        assert_eq!(Shape::Table.scaled(i32::MIN, 0, &table), i32::MAX);
        assert_eq!(Shape::Table.scaled(i32::MAX, 0, &table), -i32::MAX);
        assert_eq!(Shape::Sine.scaled(1000, QUARTER, &table), 1000);
    }

    #[test]
    fn a_period_becomes_a_step() {
        // 10 s at 10 kHz: 2³²/10⁵ = 42949.67.
        assert_eq!(phase_step(1e5), Some(42_950));
        assert_eq!(phase_step(2.0), Some(1 << 31));
        assert_eq!(phase_step(1.9), None);
        assert_eq!(phase_step(1e11), None);
        assert_eq!(phase_step(f64::NAN), None);
        // In f32 as well, to its digits.
        assert_eq!(
            (phase_step(1e5_f32), phase_step(2.0_f32), phase_step(1.9_f32)),
            (Some(42_950), Some(1 << 31), None)
        );
    }
}
