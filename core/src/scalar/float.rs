//! f32 and f64 on libm.

use super::Real;
#[cfg(target_os = "none")]
use super::root::sqrt as short_sqrt;
#[cfg(not(target_os = "none"))]
use libm::sqrtf as short_sqrt;
use libm::{exp, sqrt};

/// e^x, −80 < x ≤ 0: e^x = 2^k·e^r, |r| ≤ ln2/2.
fn short_exp(x: f32) -> f32 {
    let t = x * core::f32::consts::LOG2_E;
    let k = (t - 0.5) as i32;
    let r = (t - k as f32) * core::f32::consts::LN_2;
    let series =
        1.0 + r * (1.0 + r * (0.5 + r * (0.166_666_67 + r * (0.041_666_67 + r * (0.008_333_333 + r * 0.001_388_889)))));
    // k ≥ −116, so 2^k is a normal number. Positive input is not used.
    series * f32::from_bits(((k.clamp(-126, 127) + 127) as u32) << 23)
}

macro_rules! float {
    ($type:ty, $sqrt:ident, $sin:ident, $cos:ident, $exp:ident, $ln:ident, $atan2:ident, $exp_negative:ident) => {
        impl Real for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            fn from_f64(value: f64) -> Self {
                value as Self
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn from_u32(value: u32) -> Self {
                value as Self
            }
            fn to_u32(self) -> u32 {
                self as u32
            }
            fn is_finite(self) -> bool {
                <$type>::is_finite(self)
            }
            fn abs(self) -> Self {
                <$type>::abs(self)
            }
            fn sqrt(self) -> Self {
                if self > 0.0 { $sqrt(self) } else { 0.0 }
            }
            fn sin(self) -> Self {
                libm::$sin(self)
            }
            fn cos(self) -> Self {
                libm::$cos(self)
            }
            fn exp(self) -> Self {
                libm::$exp(self)
            }
            fn exp_negative(self) -> Self {
                if self > -80.0 { $exp_negative(self) } else { 0.0 }
            }
            fn ln(self) -> Self {
                if self > 0.0 { libm::$ln(self) } else { <$type>::MIN }
            }
            fn atan2(self, x: Self) -> Self {
                libm::$atan2(self, x)
            }
        }
    };
}

float!(f32, short_sqrt, sinf, cosf, expf, logf, atan2f, short_exp);
float!(f64, sqrt, sin, cos, exp, log, atan2, exp);
