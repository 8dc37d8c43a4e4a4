use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

const INTERVAL_S: f64 = 0.002;

/// A linear axis of one or two bodies, in SI units.
#[derive(Clone, Copy)]
struct Axis {
    /// Inertia of the driven body, on which the sensor sits, and of the one behind the coupling; 0 for none.
    inertia: [f64; 2],
    /// Viscous friction of the driven body.
    friction: f64,
    /// Spring to the ground.
    spring: f64,
    /// Stiffness and damping of the coupling.
    coupling: [f64; 2],
}

impl Axis {
    const RIGID: Self = Self { inertia: [0.02, 0.0], friction: 0.1, spring: 0.0, coupling: [0.0, 0.0] };
    const COUPLED: Self = Self { inertia: [0.02, 0.03], friction: 0.02, spring: 0.0, coupling: [300.0, 0.1] };

    fn rates(&self, s: [f64; 4], drive: f64) -> [f64; 4] {
        let [x, v, x2, v2] = s;
        let between = self.coupling[0] * (x - x2) + self.coupling[1] * (v - v2);
        let force = drive - self.friction * v - self.spring * x - between;
        [v, force / self.inertia[0], v2, if self.inertia[1] > 0.0 { between / self.inertia[1] } else { 0.0 }]
    }

    /// 40 s of a random drive that is held, the positions `late` samples old, with a little noise.
    fn recording(&self, late: usize, seed: u64) -> Recording {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut state = [0.0; 4];
        let (mut u, mut x, mut drive) = (Vec::new(), Vec::new(), 0.0);
        for k in 0..20_000 {
            // Each value for 4 samples: power where an axis has its modes.
            if k % 4 == 0 {
                drive = random.random_range(-1.0..1.0);
            }
            u.push(drive);
            x.push(state[0] + 1e-7 * random.random_range(-1.0..1.0));
            // Runge and Kutta's method, of an error below 1e-9 at these modes.
            let step = INTERVAL_S / 8.0;
            for _ in 0..8 {
                let add = |by: [f64; 4], share: f64| std::array::from_fn(|i| state[i] + share * step * by[i]);
                let one = self.rates(state, drive);
                let two = self.rates(add(one, 0.5), drive);
                let three = self.rates(add(two, 0.5), drive);
                let four = self.rates(add(three, 1.0), drive);
                state =
                    std::array::from_fn(|i| state[i] + step / 6.0 * (one[i] + 2.0 * two[i] + 2.0 * three[i] + four[i]));
            }
        }
        // The position at a row is that of `late` samples before it.
        u.drain(..late);
        x.truncate(u.len());
        Recording { t: (0..u.len()).map(|k| k as f64 * INTERVAL_S).collect(), u, x, ..Recording::default() }
    }

    /// Position over drive.
    fn response(&self, frequency_hz: f64) -> Complex<f64> {
        let s = Complex::new(0.0, TAU * frequency_hz);
        let own = s * s * self.inertia[0] + s * self.friction + self.spring;
        if self.inertia[1] == 0.0 {
            return own.inv();
        }
        let link = s * self.coupling[1] + self.coupling[0];
        let load = s * s * self.inertia[1];
        (own + load * link / (load + link)).inv()
    }
}

/// A number and its standard error are off by at most `within`, as a share.
fn near(own: Estimate, truth: f64, within: f64) {
    let most = within * truth;
    assert!((own.value - truth).abs() < most && own.se > 0.0 && own.se < most, "{own:?}, truth {truth}");
}

/// The gain of an axis is that of its equation, to the error that is told and what the window smears (3 %).
#[test]
fn a_rigid_axis_has_the_response_of_its_equation_and_no_mode() {
    let found = FrequencyResponse::of(&[Axis::RIGID.recording(0, 1)], None).unwrap();
    assert!(found.segments >= SEGMENTS && found.coherent().count() > 100, "{} points", found.coherent().count());
    for point in found.coherent().filter(|point| point.frequency_hz < 50.0) {
        let off = (point.response / Axis::RIGID.response(point.frequency_hz) - 1.0).norm();
        assert!(off < 0.03 + 5.0 * point.gain_se / point.response.norm(), "{point:?}: {off}");
    }
    assert_eq!((found.resonances.len(), found.antiresonances.len()), (0, 0), "{found:?}");
    let delay = found.delay_s.unwrap();
    // A tenth of a sample.
    assert!(delay.value.abs() < 0.1 * INTERVAL_S, "{delay:?}");
}

/// ω0 = √(k/b) = 20 rad/s, ζ = c/(2√(kb)) = 0.125. The peak is 0.8 Hz wide, and frequencies are 0.17 Hz apart, so that the
/// window widens it by 2 %.
#[test]
fn a_spring_makes_one_resonance() {
    let axis = Axis { spring: 8.0, ..Axis::RIGID };
    let found = FrequencyResponse::of(&[axis.recording(0, 2)], Some(6.0)).unwrap();
    let [mode] = found.resonances[..] else { panic!("{:?}", found.resonances) };
    near(mode.frequency_hz, 20.0 / TAU, 0.02);
    near(mode.damping_ratio, 0.125, 0.05);
    assert!(!found.is_narrow(&mode));
    let coarse = FrequencyResponse::of(&[axis.recording(0, 2)], Some(2.0)).unwrap();
    assert!(coarse.is_narrow(&coarse.resonances[0]), "{:?}", coarse.resonances);
    assert!(found.antiresonances.is_empty(), "{:?}", found.antiresonances);
}

/// The driven body stands still at √(k/b2) = 100 rad/s; both swing against each other at √(k/b1 + k/b2) = 158 rad/s. The
/// damping ratios are d·ω/(2k), 0.017 and 0.026, and a hundredth of the second is the driven body's own friction.
#[test]
fn a_flexible_coupling_makes_an_antiresonance_and_a_resonance() {
    let found = FrequencyResponse::of(&[Axis::COUPLED.recording(0, 3)], Some(4.0)).unwrap();
    let ([low], [high]) = (&found.antiresonances[..], &found.resonances[..]) else { panic!("{found:?}") };
    near(low.frequency_hz, 100.0 / TAU, 0.005);
    near(high.frequency_hz, 25_000.0_f64.sqrt() / TAU, 0.005);
    // The window widens narrow peaks: by the frequencies' distance of 0.25 Hz against a width of 0.53 Hz.
    near(low.damping_ratio, 0.1 * 100.0 / 600.0, 0.35);
    near(high.damping_ratio, 0.1 * 25_000.0_f64.sqrt() / 600.0 + 0.0019, 0.35);
}

/// Six milliseconds, found beside the modes.
#[test]
fn a_delay_is_told_from_modes() {
    for axis in [Axis::RIGID, Axis::COUPLED] {
        let found = FrequencyResponse::of(&[axis.recording(3, 4)], None).unwrap();
        let delay = found.delay_s.unwrap();
        // A tenth of a sample.
        assert!((delay.value - 3.0 * INTERVAL_S).abs() < 0.1 * INTERVAL_S, "{delay:?}");
    }
}

/// Rows whose stamps are off by up to a fifth of the interval give the same resonance.
#[test]
fn a_clock_that_jitters_is_made_even() {
    let axis = Axis { spring: 8.0, ..Axis::RIGID };
    let mut recording = axis.recording(0, 5);
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let (t, x) = (recording.t.clone(), recording.x.clone());
    for k in 1..t.len() - 1 {
        let share = random.random_range(0.0..0.2);
        recording.t[k] = t[k] + share * INTERVAL_S;
        recording.x[k] = x[k] + share * (x[k + 1] - x[k]);
    }
    let found = FrequencyResponse::of(&[recording], None).unwrap();
    assert!(found.interpolated);
    let [mode] = found.resonances[..] else { panic!("{:?}", found.resonances) };
    near(mode.frequency_hz, 20.0 / TAU, 0.02);
}

/// A position that ignores the drive is coherent at no frequency; one in a hundred would be by chance, and not at 20 %.
#[test]
fn a_position_that_ignores_the_drive_has_no_response() {
    let mut recording = Axis::RIGID.recording(0, 7);
    recording.x = Axis::RIGID.recording(0, 8).x;
    let error = FrequencyResponse::of(&[recording], None).unwrap_err();
    assert!(matches!(error, ResponseError::Incoherent { segments } if segments >= SEGMENTS), "{error}");
}

#[test]
fn what_cannot_be_averaged_is_refused() {
    let recording = Axis::RIGID.recording(0, 9);
    let mut slow = recording.clone();
    for t in &mut slow.t {
        *t *= 2.0;
    }
    let error = FrequencyResponse::of(&[recording.clone(), slow], None).unwrap_err();
    assert!(matches!(error, ResponseError::Rates { .. }), "{error}");
    let error = FrequencyResponse::of(std::slice::from_ref(&recording), Some(50.0)).unwrap_err();
    assert!(matches!(error, ResponseError::Segment { most_s, .. } if most_s < 50.0), "{error}");
    let mut brief = recording;
    brief.t.truncate(30);
    brief.u.truncate(30);
    brief.x.truncate(30);
    let error = FrequencyResponse::of(&[brief], None).unwrap_err();
    assert_eq!(error, ResponseError::TooShort { samples: 29, needed: SHORTEST });
}

/// A phase goes on below −π where it passes it.
#[test]
fn the_phase_is_continued() {
    let found = FrequencyResponse::of(&[Axis::RIGID.recording(3, 10)], None).unwrap();
    let last = found.coherent().rfind(|point| point.frequency_hz < 50.0).unwrap();
    // −π of the inertia, a little less by the friction, and the delay of 6 ms.
    let expected = -PI - TAU * last.frequency_hz * 3.0 * INTERVAL_S;
    assert!((last.phase_rad - expected).abs() < 0.2, "{last:?}, expected {expected}");
}
