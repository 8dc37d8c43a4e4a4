//! f32 and f64 on libm.

use super::Real;

macro_rules! float {
    ($type:ty, $sqrt:ident, $sin:ident, $cos:ident, $exp:ident, $ln:ident, $atan2:ident) => {
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
                if self > 0.0 { libm::$sqrt(self) } else { 0.0 }
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
            fn ln(self) -> Self {
                if self > 0.0 { libm::$ln(self) } else { <$type>::MIN }
            }
            fn atan2(self, x: Self) -> Self {
                libm::$atan2(self, x)
            }
        }
    };
}

float!(f32, sqrtf, sinf, cosf, expf, logf, atan2f);
float!(f64, sqrt, sin, cos, exp, log, atan2);
