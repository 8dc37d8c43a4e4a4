//! The memo's method as printed: normal equations of eq. 4 without dc, and `fmin` over ω (appendices A and B).

/// α1 (of the sine) and α2 (of the cosine) of memo eq. 4, and RSS, at one ω. Samples are (time, value).
pub fn fixed(samples: &[(f64, f64)], omega: f64) -> (f64, f64, f64) {
    let (mut a11, mut a12, mut a22, mut b1, mut b2, mut power) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for &(t, y) in samples {
        let (sin, cos) = (omega * t).sin_cos();
        a11 += sin * sin;
        a12 += sin * cos;
        a22 += cos * cos;
        b1 += y * sin;
        b2 += y * cos;
        power += y * y;
    }
    let determinant = a11 * a22 - a12 * a12;
    let alpha1 = (a22 * b1 - a12 * b2) / determinant;
    let alpha2 = (a11 * b2 - a12 * b1) / determinant;
    (alpha1, alpha2, power - alpha1 * b1 - alpha2 * b2)
}

/// `fmin` of MATLAB 4 and 5: golden section and parabolas (Forsythe, Malcolm and Moler), to the tolerance that f64 can
/// resolve instead of the memo's 1e-30.
pub fn fmin(mut a: f64, mut b: f64, cost: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let mut best = a + GOLDEN * (b - a);
    let (mut second, mut third) = (best, best);
    let mut f_best = cost(best);
    let (mut f_second, mut f_third) = (f_best, f_best);
    let (mut step, mut before): (f64, f64) = (0.0, 0.0);
    for _ in 0..500 {
        let middle = 0.5 * (a + b);
        let tolerance = f64::EPSILON.sqrt() * best.abs();
        if (best - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
            break;
        }
        let mut golden = true;
        if before.abs() > tolerance {
            let r = (best - second) * (f_best - f_third);
            let q = (best - third) * (f_best - f_second);
            let p = (best - third) * q - (best - second) * r;
            let q = 2.0 * (q - r);
            let (p, q) = if q > 0.0 { (-p, q) } else { (p, -q) };
            let last = before;
            before = step;
            if p.abs() < (0.5 * q * last).abs() && p > q * (a - best) && p < q * (b - best) {
                step = p / q;
                golden = false;
                let u = best + step;
                if u - a < 2.0 * tolerance || b - u < 2.0 * tolerance {
                    step = tolerance.copysign(middle - best);
                }
            }
        }
        if golden {
            before = if best < middle { b - best } else { a - best };
            step = GOLDEN * before;
        }
        let u = best + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
        let f_u = cost(u);
        if f_u <= f_best {
            if u < best {
                b = best;
            } else {
                a = best;
            }
            (third, f_third) = (second, f_second);
            (second, f_second) = (best, f_best);
            (best, f_best) = (u, f_u);
        } else {
            if u < best {
                a = u;
            } else {
                b = u;
            }
            if f_u <= f_second || second == best {
                (third, f_third) = (second, f_second);
                (second, f_second) = (u, f_u);
            } else if f_u <= f_third || third == best || third == second {
                (third, f_third) = (u, f_u);
            }
        }
    }
    best
}

/// `fmin` finds the minimum of a function that has one only: a parabola, to the square root of f64's precision.
#[test]
fn fmin_works_where_there_is_one_minimum() {
    let found = fmin(0.0, 5.0, |x| (x - 1.75).powi(2) + 3.0);
    assert!((found - 1.75).abs() < 1e-7, "{found}");
}
