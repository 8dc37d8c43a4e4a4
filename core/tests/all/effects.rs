//! Laws that hold for every effect of the catalogue.

use breakaway_core::plant::effect::{ActsIn, Held, Instant, Parameter, Role};
use breakaway_core::plant::{Base, Drive, Effect, Kind, Plant, State};

const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const H: f64 = 1e-3;

/// An effect has influence only through the hooks of the place where it says that it acts. The plant calls no others,
/// so one written for another place would have no effect, unnoticed. Exactly no influence is asked for, over motions
/// of both directions, at rest, and with a memory that has been moved.
#[test]
fn hooks_stand_where_the_effect_acts() {
    for &kind in Kind::ALL {
        let parameters: Vec<f64> = kind.definition().parameters.iter().map(|p| 0.3f64.clamp(p.min, p.max)).collect();
        let effect = Effect::new(kind, &parameters);
        let place = kind.acts_in();
        for (x, v, u) in [(0.4, 1.3, 0.9), (-2.0, -0.7, -1.1), (0.1, 0.0, 0.2), (3.0, 40.0, 5.0)] {
            let at = Instant { t: 2.5, x, v, u, over_s: H };
            let moved = [0.01, -0.02, 0.03];
            let mut memory = moved;
            let past = Held { u: &[0.3, -0.4, u], ts: H, from_s: 0.0 };
            if place != ActsIn::Drive {
                assert_eq!(effect.drive(&at, past, &mut memory, H), u, "{}", kind.name());
            }
            if place != ActsIn::Force {
                let forces = [effect.force(&at), effect.level(&BASE, &at), effect.breakaway()];
                assert_eq!(forces, [0.0; 3], "{}", kind.name());
            }
            if place != ActsIn::Mechanics {
                let (mut x_end, mut v_end) = (x, v);
                effect.impact(&mut x_end, &mut v_end, &mut memory, H);
                assert_eq!((x_end, v_end), (x, v), "{}", kind.name());
                let reactions = [effect.mechanics(&BASE, &at, &mut memory, H), effect.bristle(0.5, v, &mut memory, H)];
                assert_eq!(reactions, [0.0; 2], "{}", kind.name());
            }
            if place != ActsIn::Sensor {
                assert_eq!(effect.sensor(x), 0.0, "{}", kind.name());
            }
            if matches!(place, ActsIn::Sensor | ActsIn::Force) {
                assert_eq!(memory, moved, "{}", kind.name());
            }
        }
    }
}

/// What the catalogue says in words of an effect's compensation, its hook does: text and hook stand together or not at all.
#[test]
fn compensation_is_said_where_it_is_done() {
    for &kind in Kind::ALL {
        for value in [0.0, 0.3, -0.3] {
            let parameters: Vec<f64> =
                kind.definition().parameters.iter().map(|p| f64::clamp(value, p.min, p.max)).collect();
            let done = Effect::new(kind, &parameters).compensation(&BASE).is_some();
            assert_eq!(done, kind.definition().compensation.is_some(), "{}", kind.name());
        }
    }
}

/// The law of the backlash's impacts: momentum is kept, and of the closing speed the share e is left, opening. To rounding.
#[test]
fn an_impact_keeps_momentum_and_leaves_e_of_the_closing_speed() {
    for side in [1.0, -1.0] {
        for (gap, mu, e) in [(0.2, 0.4, 0.18), (0.2, 0.4, 0.0), (0.05, 0.7, 0.6)] {
            let backlash = Effect::new(Kind::Backlash, &[gap, mu, e]);
            // The motor, 2 units of speed faster than the load, ends the sub-step 0.2 ms past the face.
            let (w, closing, late) = (-0.5 * side, 2.0 * side, 2e-4);
            let (mut x, mut v) = (0.5 * gap * side + closing * late, w + closing);
            let mut memory = [-w * H, w, 0.0];
            backlash.impact(&mut x, &mut v, &mut memory, H);
            let momentum = (1.0 - mu) * v + mu * memory[1];
            assert!((momentum - (w + (1.0 - mu) * closing)).abs() < 1e-12, "{momentum}");
            assert!((memory[1] - v - e * closing).abs() < 1e-12, "{v} {memory:?}");
            // From the impact on they have moved apart for as long as it was late.
            let clearance = 0.5 * gap - (x - memory[0]) * side;
            assert!((clearance - e * closing.abs() * late).abs() < 1e-12, "{clearance}");
        }
    }
}

/// A load that is pushed moves as one with the motor. Under a constant drive both gain u/b, with the inertia of the
/// two together, and the motor is where one body would be. The impact that begins it is exact: to rounding.
#[test]
fn a_load_that_is_pushed_is_one_body_with_the_motor() {
    let base = Base { b: 0.03_f64, c: 0.0, f1: 0.0 };
    let effects = [Effect::new(Kind::Backlash, &[0.2, 0.4, 0.0])];
    let plant = Plant { base, effects: &effects };
    let mut state: State<f64> = plant.at_rest(0.0);
    state.memory[0][0] = -0.1;
    let u = [0.6; 200];
    for k in 0..200 {
        plant.advance(&mut state, Drive { u: &u[..=k], ts: H, t: k as f64 * H }, 1);
    }
    let (t, a) = (0.2, 0.6 / 0.03);
    assert!((state.v - a * t).abs() < 1e-9, "{}", state.v);
    assert!((state.x - 0.5 * a * t * t).abs() < 1e-9, "{}", state.x);
    assert!((state.memory[0][0] - (state.x - 0.1)).abs() < 1e-9);
}

/// The motion of 200 samples under a drive that passes every level of both signs.
fn driven(effects: &[Effect<f64>]) -> f64 {
    let plant = Plant { base: BASE, effects };
    let u: Vec<f64> = (0..200).map(|k| 2.0 * (0.05 * f64::from(k)).sin()).collect();
    let mut state = plant.at_rest(0.0);
    for k in 0..u.len() {
        plant.advance(&mut state, Drive { u: &u[..=k], ts: H, t: 10.0 + k as f64 * H }, 4);
    }
    state.x
}

/// The drive's path has an order of its own. The order in which two effects were found makes no difference, to the
/// bit, and neither is passed over. A delay reads the samples as they were recorded, so an effect before it would be
/// lost.
#[test]
fn two_effects_of_the_drive_act_both_in_whatever_order_they_stand() {
    let drive: Vec<Kind> = Kind::ALL.iter().copied().filter(|kind| kind.acts_in() == ActsIn::Drive).collect();
    assert_eq!(drive.len(), 6);
    let of = |kind: Kind, size: f64| {
        let small = |p: &Parameter| match p.role {
            Role::Delay | Role::TimeConstant => 0.01 * size,
            Role::BackEmf => 0.0,
            Role::Rate => 0.02 * size,
            _ if kind == Kind::Saturation => 1.2 / size,
            _ => 0.3 * size,
        };
        Effect::new(kind, &kind.definition().parameters.iter().map(small).collect::<Vec<_>>())
    };
    for &a in &drive {
        for &b in drive.iter().filter(|b| **b != a) {
            let both = driven(&[of(a, 1.0), of(b, 1.0)]);
            assert_eq!(both.to_bits(), driven(&[of(b, 1.0), of(a, 1.0)]).to_bits(), "{} {}", a.name(), b.name());
            assert_ne!(both, driven(&[of(a, 1.1), of(b, 1.0)]), "{} is lost beside {}", a.name(), b.name());
        }
    }
}

/// A delay and a lag have the same τ, shorter than a sample. They give the same velocity after an edge, and positions
/// that are ½·a·τ² apart. Nothing else separates them. A mean drive over the whole sample would lose it (and did). A
/// sub-step ends at the delayed edge, and the lag's drive moves the body by its moment too, so both are exact.
#[test]
fn a_delay_and_a_lag_within_a_sample_differ() {
    let base = Base { b: 0.02, c: 0.0, f1: 0.0 };
    let (tau, acceleration) = (0.33e-3, 50.0);
    let u = [1.0; 12];
    let end = |kind: Kind| {
        let effects = [Effect::new(kind, &[tau])];
        let plant = Plant { base, effects: &effects };
        let n = plant.sub_steps(H);
        let mut state = plant.at_rest(0.0);
        // The drive was 0 before.
        let held: Vec<f64> = std::iter::repeat_n(0.0, 4).chain(u).collect();
        for k in 4..held.len() {
            plant.advance(&mut state, Drive { u: &held[..=k], ts: H, t: k as f64 * H }, n);
        }
        (state.x, state.v)
    };
    let ((x_delay, v_delay), (x_lag, v_lag)) = (end(Kind::Delay), end(Kind::ElectricalLag));
    let t = 12.0 * H;
    assert!((v_delay - acceleration * (t - tau)).abs() < 1e-9 && (v_lag - v_delay).abs() < 1e-9);
    assert!((x_delay - 0.5 * acceleration * (t - tau).powi(2)).abs() < 1e-9 * acceleration * tau * tau);
    let apart = (x_lag - x_delay) / (0.5 * acceleration * tau * tau);
    assert!((apart - 1.0).abs() < 1e-9, "{apart}");
}

/// A body without friction under a step of the drive, with a lag of .2 to 100 samples. Its position is
/// a·(t²/2 − τ·t + τ²·(1 − e^(−t/τ))). From 10 samples on the moment of the drive is a series. Its next term is (h/τ)⁴/360,
/// which is 2e-8 of the step at h/τ = .05. That of 24 sub-steps adds up.
#[test]
fn a_lag_of_any_length_is_exact() {
    let (base, acceleration, t) = (Base { b: 0.02, c: 0.0, f1: 0.0 }, 50.0, 12.0 * H);
    for tau in [0.2, 1.0, 5.0, 9.9, 10.1, 30.0, 100.0].map(|samples| samples * H) {
        let effects = [Effect::new(Kind::ElectricalLag, &[tau])];
        let plant = Plant { base, effects: &effects };
        let mut state = plant.at_rest(0.0);
        for k in 0..12 {
            plant.advance(&mut state, Drive { u: &[1.0], ts: H, t: f64::from(k) * H }, 2);
        }
        let exact = acceleration * (0.5 * t * t - tau * t - tau * tau * (-t / tau).exp_m1());
        let bound = acceleration * 24.0 * (0.5 * H).powi(2) * 2e-8;
        assert!((state.x - exact).abs() < bound, "{tau}: {} {exact}", state.x);
    }
}

/// Whatever the delay and the sample period are, the plant comes to an end.
#[test]
fn a_delay_ends_on_any_input() {
    let numbers = [0.0, -1.0, 1e-300, 1e-3, 0.7, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    for (tau, ts) in numbers.iter().flat_map(|tau| numbers.iter().map(move |ts| (*tau, *ts))) {
        let effects = [Effect::new(Kind::Delay, &[tau])];
        let plant = Plant { base: BASE, effects: &effects };
        let mut state = plant.at_rest(0.0);
        for n in [0, 1, 8] {
            plant.advance(&mut state, Drive { u: &[0.5, 1.0], ts, t: 0.0 }, n);
        }
        plant.effect_force(&mut state, Drive { u: &[0.5, 1.0], ts, t: 0.0 }, 0.0, 1.0, 0.0);
    }
}

/// Ripples of several wave numbers add up, each by its own: to rounding. Along an imposed motion nothing else acts.
#[test]
fn ripples_of_several_wave_numbers_add_up() {
    let line = |n: f64, phi: f64| Effect::new(Kind::Cogging, &[0.1, n, phi]);
    let lines = [line(7.0, 0.5), line(28.0, -1.0), line(14.0, 2.0), line(12.0, 0.0)];
    let force = |effects: &[Effect<f64>], x: f64| {
        let plant = Plant { base: BASE, effects };
        let mut state = plant.at_rest(x);
        plant.effect_force(&mut state, Drive { u: &[0.4], ts: H, t: 0.0 }, x, 1.3, 0.0)
    };
    for x in (-30..30).map(|i| 0.11 * f64::from(i)) {
        let each: f64 = lines.iter().map(|line| force(&[*line], x)).sum();
        assert!((force(&lines, x) - each).abs() < 1e-14, "{x}");
    }
    let both = driven(&lines[..2]);
    assert!((0..2).all(|i| driven(&lines[i..=i]) != both));
}
