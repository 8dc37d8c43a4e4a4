//! Square root of an f32 in integers: on a microcontroller a fraction of the flash that libm's takes with its table of 256 bytes.
//! Both round correctly, so that they agree to the bit.

/// √x to the nearest, x ≥ 0; infinity is its own root.
///
/// One bit of the root after the other, as on paper (FreeBSD's `e_sqrtf.c`).
#[inline(never)]
pub(super) fn sqrt(x: f32) -> f32 {
    if !x.is_finite() {
        return x;
    }
    let bits = x.to_bits();
    let fraction = bits & 0x007f_ffff;
    // x = mantissa·2^(exponent − 23), 2²³ ≤ mantissa < 2²⁴; a subnormal one has its leading bit further right.
    let (exponent, mantissa) = match (bits >> 23) as i32 {
        0 => {
            let shift = fraction.leading_zeros().min(31) - 8;
            (-126 - shift as i32, fraction << shift)
        }
        biased => (biased - 127, fraction | 0x0080_0000),
    };
    // An even exponent is halved exactly; the other half goes to the mantissa.
    let mut rest = mantissa << (1 + (exponent & 1));
    let (mut root, mut twice) = (0_u32, 0_u32);
    // 24 bits, and one to round by.
    for place in (0..25).rev() {
        let bit = 1 << place;
        let tried = twice + bit;
        if tried <= rest {
            twice = tried + bit;
            rest -= tried;
            root += bit;
        }
        rest <<= 1;
    }
    // Never half-way: a root with 25 bits has a square of 49 or 50.
    if rest != 0 {
        root += root & 1;
    }
    if mantissa == 0 {
        0.0
    } else {
        f32::from_bits(((root >> 1) + 0x3f00_0000).wrapping_add_signed((exponent >> 1) << 23))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every exponent with mantissas of all kinds, subnormal numbers among them: to the bit what libm says.
    #[test]
    fn it_is_libms_root_to_the_bit() {
        // In Miri each takes a millisecond.
        let (samples, step) = if cfg!(miri) { (500, 128) } else { (2_000_000, 1) };
        let mut state = 1_u32;
        for _ in 0..samples {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let x = f32::from_bits(state >> 1);
            if !x.is_nan() {
                assert_eq!(sqrt(x).to_bits(), libm::sqrtf(x).to_bits(), "√{x}");
            }
        }
        for bits in (0..300).chain(0x007f_ff00..0x0080_0100).chain(0x7f7f_ff00..=0x7f80_0000).step_by(step) {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x).to_bits(), libm::sqrtf(x).to_bits(), "√{x}");
        }
        // Squares, whose root is exact.
        for root in (1..4096_u16).step_by(step) {
            assert_eq!(sqrt(f32::from(root) * f32::from(root)), f32::from(root));
        }
    }
}
