//! Sums of one block, for each type of sample.

use crate::scalar::SolverReal;
use crate::scalar::nco;

/// A sample that the streaming fit can sum: i32 counts (integer arithmetic only), f32 or f64.
pub trait Sample: Copy + core::fmt::Debug + sealed::Sealed {
    /// Sums of y·cos φ, y·sin φ and y over one block.
    type Sums: Copy + Default + core::fmt::Debug;
    /// The sum of y² over the record.
    type Power: Copy + Default + core::fmt::Debug;

    /// Adds `samples`, less `reference`, to the sums; the first has the phase `phase` and each advances by `word`.
    /// Returns the phase after the last, and false if an integer left its range.
    fn accumulate(
        samples: &[Self],
        reference: Self,
        phase: u32,
        word: u32,
        sums: &mut Self::Sums,
        power: &mut Self::Power,
    ) -> (u32, bool);
    /// [`Sample::accumulate`] of one sample, as a control loop takes them.
    #[inline]
    fn accumulate_one(
        self,
        reference: Self,
        phase: u32,
        word: u32,
        sums: &mut Self::Sums,
        power: &mut Self::Power,
    ) -> (u32, bool) {
        Self::accumulate(core::slice::from_ref(&self), reference, phase, word, sums, power)
    }
    /// Adds the sums of a neighbouring block; false if an integer left its range.
    fn merge(into: &mut Self::Sums, other: &Self::Sums) -> bool;
    /// Σ y·cos φ, Σ y·sin φ, Σ y.
    fn read<R: SolverReal>(sums: &Self::Sums) -> [R; 3];
    /// Σ y².
    fn read_power<R: SolverReal>(power: &Self::Power) -> R;
    /// The sample as a solver's number.
    fn to_real<R: SolverReal>(self) -> R;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for i32 {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// Samples summed in the inner loop before the compensated (float) or range-checked (integer) addition.
const RUN: usize = 64;
/// Q30, the scale of the oscillator's output.
const Q30: f64 = 1.0 / nco::ONE_Q30 as f64;

/// Sums of i32 counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct CountSums {
    /// Σ y·cos φ in Q10.
    cos_q10: i64,
    /// Σ y·sin φ in Q10.
    sin_q10: i64,
    /// Σ y.
    sum: i64,
}

/// Each product is rounded from Q30 to Q10: a thousandth of a count, far below the quantisation of the count itself,
/// and 2³² products of 2²⁰ counts fit an i64.
const PRODUCT_SHIFT: u32 = 20;

/// Counts times Q30, in Q10.
#[inline]
fn rounded_product(counts: i32, q30: i32) -> i64 {
    (i64::from(counts) * i64::from(q30) + (1 << (PRODUCT_SHIFT - 1))) >> PRODUCT_SHIFT
}

impl Sample for i32 {
    type Sums = CountSums;
    type Power = u128;

    fn accumulate(
        samples: &[Self],
        reference: Self,
        mut phase: u32,
        word: u32,
        sums: &mut CountSums,
        power: &mut u128,
    ) -> (u32, bool) {
        let mut in_range = true;
        for run in samples.chunks(RUN) {
            // 64 products of 2³¹·2¹⁰ are 2⁴⁷: no overflow inside a run.
            let (mut cos_sum, mut sin_sum, mut sum) = (0_i64, 0_i64, 0_i64);
            for y in run {
                let (y, overflow) = y.overflowing_sub(reference);
                in_range &= !overflow;
                let (sin, cos) = nco::sin_cos(phase);
                phase = phase.wrapping_add(word);
                cos_sum += rounded_product(y, cos);
                sin_sum += rounded_product(y, sin);
                sum += i64::from(y);
                *power = power.wrapping_add((i64::from(y) * i64::from(y)) as u128);
            }
            in_range &= Self::merge(sums, &CountSums { cos_q10: cos_sum, sin_q10: sin_sum, sum });
        }
        (phase, in_range)
    }
    #[inline]
    fn accumulate_one(
        self,
        reference: Self,
        phase: u32,
        word: u32,
        sums: &mut CountSums,
        power: &mut u128,
    ) -> (u32, bool) {
        let (y, overflow) = self.overflowing_sub(reference);
        let (sin, cos) = nco::sin_cos(phase);
        let (cos_q10, sin_q10) = (rounded_product(y, cos), rounded_product(y, sin));
        // 2⁶⁴ squares of 2⁶² fit: it never wraps.
        *power = power.wrapping_add((i64::from(y) * i64::from(y)) as u128);
        let in_range = Self::merge(sums, &CountSums { cos_q10, sin_q10, sum: i64::from(y) });
        (phase.wrapping_add(word), in_range && !overflow)
    }
    #[inline]
    fn merge(into: &mut CountSums, other: &CountSums) -> bool {
        let (cos_q10, a) = into.cos_q10.overflowing_add(other.cos_q10);
        let (sin_q10, b) = into.sin_q10.overflowing_add(other.sin_q10);
        let (sum, c) = into.sum.overflowing_add(other.sum);
        *into = CountSums { cos_q10, sin_q10, sum };
        !(a || b || c)
    }
    fn read<R: SolverReal>(sums: &CountSums) -> [R; 3] {
        let q10 = |sum: i64| R::from_i64(sum).scale(1.0 / 1024.0);
        [q10(sums.cos_q10), q10(sums.sin_q10), R::from_i64(sums.sum)]
    }
    fn read_power<R: SolverReal>(power: &u128) -> R {
        // In two parts of 62 bits: what is above 2¹²⁴ is 2⁶² times the square of the largest count.
        let part = |shift: u32| R::from_i64(((power >> shift) as i64) & (i64::MAX >> 1));
        part(62).scale(4_611_686_018_427_387_904.0) + part(0)
    }
    fn to_real<R: SolverReal>(self) -> R {
        R::from_i64(i64::from(self))
    }
}

/// A sum with the rounding error it has left behind (Knuth's two-sum), about twice the digits of `F`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Compensated<F> {
    sum: F,
    error: F,
}

macro_rules! float {
    ($type:ty) => {
        impl Compensated<$type> {
            #[inline]
            fn add(&mut self, x: $type) {
                let sum = self.sum + x;
                let back = sum - self.sum;
                self.error += (self.sum - (sum - back)) + (x - back);
                self.sum = sum;
            }
            fn merge(&mut self, other: &Self) {
                self.add(other.sum);
                self.error += other.error;
            }
            fn value(&self) -> f64 {
                f64::from(self.sum) + f64::from(self.error)
            }
        }

        impl Sample for $type {
            type Sums = [Compensated<$type>; 3];
            type Power = Compensated<$type>;

            fn accumulate(
                samples: &[Self],
                reference: Self,
                mut phase: u32,
                word: u32,
                sums: &mut Self::Sums,
                power: &mut Self::Power,
            ) -> (u32, bool) {
                for run in samples.chunks(RUN) {
                    let (mut cos_sum, mut sin_sum, mut sum, mut square) = (0.0, 0.0, 0.0, 0.0);
                    for y in run {
                        let y = y - reference;
                        let (sin, cos) = nco::sin_cos(phase);
                        phase = phase.wrapping_add(word);
                        // The factor 2³⁰ of the oscillator is taken out when the sums are read.
                        cos_sum += y * cos as $type;
                        sin_sum += y * sin as $type;
                        sum += y;
                        square += y * y;
                    }
                    let [c, s, d] = sums;
                    c.add(cos_sum);
                    s.add(sin_sum);
                    d.add(sum);
                    power.add(square);
                }
                (phase, true)
            }
            fn merge(into: &mut Self::Sums, other: &Self::Sums) -> bool {
                for (a, b) in into.iter_mut().zip(other) {
                    a.merge(b);
                }
                true
            }
            fn read<R: SolverReal>(sums: &Self::Sums) -> [R; 3] {
                let [c, s, d] = sums;
                [c.value() * Q30, s.value() * Q30, d.value()].map(R::from_f64)
            }
            fn read_power<R: SolverReal>(power: &Self::Power) -> R {
                R::from_f64(power.value())
            }
            fn to_real<R: SolverReal>(self) -> R {
                R::from_f64(f64::from(self))
            }
        }
    };
}

float!(f32);
float!(f64);

#[cfg(test)]
mod tests;
