//! Paper sections 2, 5 and 6, errata 24 to 26 and 34: units. Tolerances are half a unit of the last printed digit.

/// Table 1.
const FORCE_CONSTANT_N_A: f64 = 10.5;
const RESISTANCE_OHM: f64 = 1.5;
const SLIDE_KG: f64 = 0.59;
const BACK_EMF_V_S_M: f64 = 10.5;

/// Erratum 24: section 5 uses b = .1429. By eq. 6, b = m·R/Kf, Table 1 gives .0843; .1429 is R/Kf with m missing.
#[test]
fn erratum_24_b_lacks_the_mass() {
    let without_mass = RESISTANCE_OHM / FORCE_CONSTANT_N_A;
    assert!((without_mass - 0.1429).abs() < 5e-5, "{without_mass}");
    assert!((SLIDE_KG * without_mass - 0.0843).abs() < 5e-5);
}

/// Erratum 25: f1 = f2 = 10 beside a = −10.5 V·s/m cannot be volts as eq. 7 has it. They are newtons, 10·R/Kf = 1.429
/// V. The initial values agree digit for digit. In newtons 1 V is 1/.1429 = 6.9979 (Fig. 9), and 1.4 V is 9.7971 (Fig.
/// 10).
#[test]
fn erratum_25_friction_is_in_newtons() {
    assert!((1.0_f64 / 0.1429 - 6.9979).abs() < 5e-5);
    assert!((1.4_f64 / 0.1429 - 9.7971).abs() < 5e-5);
    assert!((10.0_f64 * RESISTANCE_OHM / FORCE_CONSTANT_N_A - 1.429).abs() < 5e-4);
}

/// Erratum 26: "length of travel 609.6 m" is 24 inches in mm, for the motor is an LS1-24. "Armature inductance 2.2 mh"
/// is mH. 2.2 H would make the electrical time constant 1.5 s. That is not "much smaller" than the mechanical b/Ke = 8
/// ms, but 180 times larger. With mH it is 1.5 ms, a fifth: small, but not negligible. An unmodelled pole of 1 ms costs
/// f1 −3.6 %.
#[test]
fn erratum_26_travel_is_mm_and_inductance_mh() {
    assert!((24.0_f64 * 25.4 - 609.6).abs() < 1e-9);
    let mechanical_s = SLIDE_KG * RESISTANCE_OHM / FORCE_CONSTANT_N_A / BACK_EMF_V_S_M;
    assert!((mechanical_s - 8.03e-3).abs() < 5e-6, "{mechanical_s}");
    let electrical_s = 2.2e-3 / RESISTANCE_OHM;
    assert!((mechanical_s / electrical_s - 5.47).abs() < 0.005, "{}", mechanical_s / electrical_s);
    assert!(2.2 / RESISTANCE_OHM / mechanical_s > 180.0);
}

/// Erratum 34: f2 = .00062 beside Kp = 1.9259e5 (µm/s per V). f2 is part of 1/Kp = c = Ke + f2 and cannot exceed it; in V/(µm/s) it is
/// 119 times 1/Kp. In V/(mm/s) it is 12 % of it, which is possible.
#[test]
fn erratum_34_f2_has_another_unit_than_kp() {
    let share = |kp: f64| 0.00062 * kp;
    assert!((share(1.9259e5) - 119.4).abs() < 0.05, "{}", share(1.9259e5));
    assert!((share(192.59) - 0.119).abs() < 5e-4, "{}", share(192.59));
}
