use super::*;
use crate::identify::estimate::identify;
use crate::recording::Units;

/// 2 Ω, 0.05 V·s/rad and 2 mH on an axis of b = 0.02685 V·s²/rad, c = 0.11 V·s/rad of which 0.06 is friction, and f1 = 0.5 V.
const RESISTANCE: f64 = 2.0;
const BACK_EMF: f64 = 0.05;
const INDUCTANCE: f64 = 2e-3;
const B: f64 = 0.02685;
const VISCOUS: f64 = 0.06;
const COULOMB: f64 = 0.5;
/// Encoder step, rad; a code of the ADC, A; ticks per second.
const STEP: f64 = 1e-3;
const CODE: f64 = 1.6e-3;
const TICK_HZ: f64 = 2000.0;

/// A relay-like drive of ±`high` that reverses when the axis has turned by `turn`, for 10 s; simulated in 50 steps per tick.
fn recorded(high: f64, turn: f64, inductance: f64) -> Recording {
    let (mut x, mut v, mut i, mut u) = (0.0_f64, 0.0_f64, 0.0_f64, high);
    let mut recording =
        Recording { encoder_step: Some(STEP), units: Units { u: "V".into(), x: "rad".into() }, ..Recording::default() };
    let round = |value: f64, step: f64| (value / step).round() * step;
    for k in 0..20_000 {
        if x.abs() > turn {
            u = -high * x.signum();
        }
        recording.t.push(f64::from(k) / TICK_HZ);
        recording.u.push(u);
        recording.x.push(round(x, STEP));
        recording.current.push(round(i, CODE));
        let dt = 1.0 / TICK_HZ / 50.0;
        for _ in 0..50 {
            let end = (u - BACK_EMF * v) / RESISTANCE;
            let decay = if inductance > 0.0 { (-dt * RESISTANCE / inductance).exp() } else { 0.0 };
            i = end + (i - end) * decay;
            let driven = RESISTANCE * i - VISCOUS * v;
            let friction = if v == 0.0 { driven.clamp(-COULOMB, COULOMB) } else { COULOMB * v.signum() };
            let next = v + (driven - friction) / B * dt;
            v = if next * v < 0.0 { 0.0 } else { next };
            x += v * dt;
        }
    }
    recording
}

fn session(inductance: f64) -> [Recording; 2] {
    [recorded(2.5, 1.0, inductance), recorded(1.5, 0.6, inductance)]
}

/// Within half a percent (R, Ke) and three standard errors and half a percent. What is not noise is the trapezoid of a current that
/// turns in a few ticks. The inductance, from single ticks of reversals, is within 5 %.
#[test]
fn resistance_back_emf_and_inductance_are_recovered() {
    let found = winding(&session(INDUCTANCE)).unwrap();
    for (name, value, truth, share) in [
        ("R", found.resistance, RESISTANCE, 0.005),
        ("Ke", found.back_emf, BACK_EMF, 0.005),
        ("L", found.inductance.unwrap(), INDUCTANCE, 0.05),
    ] {
        println!(
            "{name}: {:+.3} %, {:.1} standard errors",
            100.0 * (value.value / truth - 1.0),
            (value.value - truth) / value.se
        );
        let allowed = share * truth + 3.0 * value.se;
        assert!((value.value - truth).abs() < allowed && 3.0 * value.se < 0.05 * truth, "{name}: {value:?}");
    }
}

/// An inductance that is not there does not show.
#[test]
fn no_inductance_shows_where_there_is_none() {
    let found = winding(&session(0.0)).unwrap();
    assert!(found.inductance.is_none_or(|inductance| inductance.value < 0.05 * INDUCTANCE), "{found:?}");
    assert!((found.resistance.value / RESISTANCE - 1.0).abs() < 0.005, "{found:?}");
}

/// Ends "c is their sum": c by the estimators, less Ke by the current, is the friction to 3 %.
#[test]
fn c_is_parted_into_back_emf_and_viscous_friction() {
    let session = session(INDUCTANCE);
    let identified = identify(&session).unwrap();
    let found = identified.winding.unwrap();
    let viscous = mechanical(identified.best.c, found.back_emf);
    println!("c {:?}, Ke {:?}, viscous {viscous:?}", identified.best.c, found.back_emf);
    assert!((viscous.value / VISCOUS - 1.0).abs() < 0.03, "{viscous:?}");
    assert!(viscous.se >= identified.best.c.se);
    let remarks: Vec<String> = identified.remarks.iter().map(ToString::to_string).collect();
    assert!(
        remarks[0].starts_with("c is the back-EMF ") && !remarks.iter().any(|remark| remark.contains("together")),
        "{remarks:?}"
    );
}

/// Without a current, with a drive that is none, or at rest there is nothing to be told.
#[test]
fn without_a_current_or_a_voltage_there_is_no_winding() {
    let recording = recorded(2.5, 1.0, INDUCTANCE);
    let without = Recording { current: Vec::new(), ..recording.clone() };
    let amperes = Recording { units: Units { u: "A".into(), x: "rad".into() }, ..recording.clone() };
    let still = Recording { x: vec![0.0; recording.x.len()], ..recording.clone() };
    assert!(winding(&[recording.clone()]).is_some());
    assert!(winding(&[]).is_none());
    for other in [without, amperes, still] {
        assert!(winding(&[recording.clone(), other.clone()]).is_none() || other.x[9] == 0.0);
        assert!(winding(&[other]).is_none());
    }
}
