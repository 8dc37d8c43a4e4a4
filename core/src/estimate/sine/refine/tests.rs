use super::*;

/// At a distance from the minimum at which the Gauss-Newton step is `step`; without noise.
fn point(step: f64) -> Point<f64, 1> {
    let mut normal = Normal::EMPTY;
    normal.add(&[1.0], 1.0);
    let factor = normal.factor().unwrap();
    Point { theta: [1.0], factor, shadow: [0.0], information: 100.0, descent: 100.0 * step, rss: 0.0 }
}

/// Where it looked, and what it found.
fn looked(low: f64, high: f64, start: f64, step: impl Fn(f64) -> f64) -> ([f64; ITERATIONS], usize, Option<f64>) {
    let (mut at, mut count) = ([start; ITERATIONS], 0);
    let found = refine(low, high, start, Resolution::of(start), 10.0, |omega| {
        at[count] = omega;
        count += 1;
        Some(point(step(omega)))
    });
    (at, count, found.map(|(omega, _)| omega))
}

/// A cost that is a parabola takes one step, and one more to see it.
#[test]
fn a_parabola_takes_one_step() {
    for start in [1.2, 1.8, 2.2, 2.9] {
        let (_, count, found) = looked(1.0, 3.0, start, |omega| 2.2 - omega);
        assert!((found.unwrap() - 2.2).abs() < 1e-15 && count <= 3, "{start}: {count}");
    }
}

/// Steps that leave the bracket are replaced by halves of it: nothing is looked at outside, and the minimum is found.
#[test]
fn it_never_looks_outside_its_bracket() {
    for start in [2.0, 2.35, 2.4] {
        let (at, count, found) = looked(2.0, 2.4, start, |omega| libm::atan(20.0 * (2.1 - omega)));
        assert!((found.unwrap() - 2.1).abs() < 1e-12, "{start}");
        assert!(at[..count].iter().all(|omega| (2.0..=2.4).contains(omega)), "{start}");
    }
    // A cost that falls all the way to an end has no minimum inside.
    assert_eq!(looked(2.0, 2.4, 2.2, |_| 1.0).2, None);
    assert_eq!(looked(2.0, 2.4, 2.2, |_| -1.0).2, None);
}
