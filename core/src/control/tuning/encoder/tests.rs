use super::*;
use crate::control::margins;
use proptest::prelude::*;
extern crate std;

/// The papers' plant.
const PLANT: [f64; 2] = [0.02685, 0.11];

fn counts(counts: f64, drive: f64) -> Resolution {
    Resolution { step: core::f64::consts::TAU / counts, drive }
}

/// A fine encoder leaves the gains as they are; a coarser one brings the observer, slower the coarser it is, down to 6·ωc.
#[test]
fn the_observer_comes_with_the_count() {
    let [b, c] = PLANT;
    let plain = tune(b, c, 30.0, 1e-4, 1).unwrap();
    let at = |n: f64| tune_behind(b, c, 30.0, 1e-4, 1, &counts(n, 3.0)).unwrap();
    assert_eq!(at(65_536.0), plain);
    assert_eq!(tune_behind(b, c, 30.0, 1e-4, 1, &Resolution { step: 0.0, drive: 3.0 }), Ok(plain));
    let crossover = core::f64::consts::TAU * 30.0;
    let mut last = 16.0 + 1e-9;
    for n in [12_000.0, 8000.0, 6000.0, 5200.0] {
        let gains = at(n);
        let ratio = gains.observer_rad_s / crossover;
        let drive = gains.drive_of_count(core::f64::consts::TAU / n, 1e-4);
        std::println!("{n}: observer at {ratio:.2} times the crossover, a count makes {drive:.3} V");
        assert!(ratio < last && ratio >= 6.0 && drive <= 3.0 && gains.filter_s == 0.0, "{n}: {gains:?} {drive}");
        // Where it is not the fastest, all of the bound is used.
        assert!(ratio > 15.99 || drive > 3.0 * (1.0 - 1e-6), "{n}: {drive}");
        last = ratio;
    }
    // 1024 counts at 30 Hz are too few for any.
    let coarse = at(1024.0);
    assert!((coarse.observer_rad_s / crossover - 6.0).abs() < 1e-6);
    assert!(coarse.drive_of_count(core::f64::consts::TAU / 1024.0, 1e-4) > 3.0);
}

/// The largest bandwidth for an encoder is borne by it and 1 % more is not; without an encoder it is the tick's.
#[test]
fn the_largest_bandwidth_for_an_encoder() {
    let [b, c] = PLANT;
    for (tick_s, n) in [(1e-4, 1024.0), (1e-4, 4096.0), (1e-4, 65_536.0), (1e-3, 1024.0), (2.5e-4, 4096.0)] {
        let encoder = counts(n, 3.0);
        let hz = encoder_bandwidth_hz(b, c, tick_s, 1, &encoder);
        let drive = |hz: f64| tune_behind(b, c, hz, tick_s, 1, &encoder).unwrap().drive_of_count(encoder.step, tick_s);
        std::println!("{tick_s} s, {n} counts: {hz:.1} Hz");
        assert!(drive(hz) <= 3.0 && drive(1.01 * hz) > 3.0, "{tick_s} {n}: {} {}", drive(hz), drive(1.01 * hz));
    }
    let none = Resolution { step: 0.0, drive: 3.0 };
    assert_eq!(encoder_bandwidth_hz(b, c, 1e-3, 1, &none), largest_bandwidth_hz(b, c, 1e-3, 1));
    assert_eq!(encoder_bandwidth_hz(-1.0, c, 1e-3, 1, &none), 0.0);
}

proptest! {
    /// With the observer too, there is a margin of 30° and of a factor of two. The check is independent: the sampled
    /// loop, simulated with twice the gain and the observer written out as two filters, decays from a unit error.
    #[test]
    fn observed_gains_are_stable_with_twice_the_gain(
        b in 1e-3..1.0_f64, ratio in 0.0..100.0_f64, hz in 0.5..60.0_f64, d in 0..3_u32, step in 1e-5..0.1_f64,
    ) {
        let c = b * ratio;
        let ts = 1e-3;
        let Ok(gains) = tune_behind(b, c, hz, ts, d, &Resolution { step, drive: 0.1 }) else { return Ok(()) };
        let found = margins(&gains, b, c, ts, d).unwrap();
        prop_assert!(found.phase_deg >= 30.0 && found.gain >= 2.0, "{:?}", found);
        let share = if gains.observer_rad_s > 0.0 { gains.observer_rad_s * ts / (1.0 + gains.observer_rad_s * ts) } else { 1.0 };
        let alpha = ts / (gains.filter_s + ts);
        let decay = libm::exp(-ratio * ts);
        let (phi1, phi2) = if ratio > 1e-6 {
            let phi1 = (1.0 - decay) / (ratio * ts);
            (phi1, (1.0 - phi1) / (ratio * ts))
        } else {
            (1.0, 0.5)
        };
        for factor in [1.0, 1.98] {
            let k = b * gains.kv * factor;
            let (mut x, mut v, mut integral, mut last, mut rates) = (1.0, 0.0, 0.0, -1.0, [0.0; 3]);
            let mut queue = [0.0; 4];
            let ticks = (400.0 / (hz * ts)) as usize;
            let mut tail = 0.0_f64;
            for i in 0..ticks {
                let e: f64 = -x;
                rates[0] += share * ((e - last) - rates[0]);
                rates[1] += share * (rates[0] - rates[1]);
                rates[2] += alpha * (rates[1] - rates[2]);
                last = e;
                integral += e;
                queue.rotate_right(1);
                queue[0] = k * (gains.lambda2 * e + gains.lambda1 * ts * integral + rates[2] / ts);
                let u = queue[d as usize];
                x += ts * phi1 * v + ts * ts * phi2 * u / b;
                v = decay * v + ts * phi1 * u / b;
                if i > ticks * 9 / 10 {
                    tail = tail.max(x.abs());
                }
            }
            prop_assert!(tail < 1e-3, "factor {}: {} {:?} {:?}", factor, tail, gains, found);
        }
    }
}
