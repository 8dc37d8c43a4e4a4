use std::process::Command;

use breakaway_core::control::{Compensator, Setpoint};
use breakaway_core::plant::{Effect, Kind};

use super::*;
use crate::model::EffectEntry;

const BASE: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";

fn model(effects: &[(Kind, &[f64])]) -> Model {
    let mut model = Model::parse("axis.toml", BASE).unwrap();
    model.effects = effects.iter().map(|(kind, p)| EffectEntry::of(&Effect::new(*kind, p), &[])).collect();
    model
}

fn request(target: Target) -> Request {
    let motor = Motor { motor_constant: Some(0.05), resistance: Some(2.0), gear: Some(10.0), ..Motor::default() };
    Request { target, motor, name: "axis".into(), timestep_s: DEFAULT_TIMESTEP_S }
}

/// Every target writes every effect of the catalogue, alone, and says what became of it. What it does not keep stands at
/// the top of the file.
#[test]
fn every_effect_has_a_fate_in_every_target() {
    for target in Target::ALL {
        for &kind in Kind::ALL {
            let p: Vec<f64> =
                kind.definition().parameters.iter().map(|p| p.default.unwrap_or(0.2_f64.clamp(p.min, p.max))).collect();
            let exported = export(&model(&[(kind, &p)]), &request(target)).unwrap();
            let [.., row] = exported.rows.as_slice() else { panic!("no rows") };
            assert_eq!((exported.rows.len(), row.what.as_str()), (4, kind.name()), "{target}");
            let listed = exported.text.contains(&format!("LOST {} ", kind.name()));
            assert_eq!(listed, row.fate == Fate::Lost, "{target} {}", kind.name());
            assert!(!exported.text.contains("NaN") && !exported.text.contains("inf"), "{target} {}", kind.name());
            assert!(crate::file::FileKind::Export.is_of(exported.text.as_bytes()), "{target}");
        }
    }
}

/// By hand: 0.25 N·m/V at the load; inertia 0.02685·0.25 there, and a hundredth of that at the motor.
#[test]
fn both_sides_of_the_gear_are_in_si() {
    let exported = export(&model(&[]), &request(Target::Urdf)).unwrap();
    let sides = exported.si.unwrap();
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    close(sides.load.inertia, 0.0067125);
    close(sides.load.viscous, 0.0275);
    close(sides.load.coulomb, 0.125);
    close(sides.motor.inertia, 0.000067125);
    close(sides.motor.coulomb, 0.0125);
    assert!(exported.text.contains("damping=\"0.0275\" friction=\"0.125\""), "{}", exported.text);
}

/// A back-EMF above the model's damping is said, and the motor is a source of torque then. Kt = 2 N·m/A at 1 Ω brakes
/// with 4 N·m·s/rad, and the model with 0.22.
#[test]
fn constants_that_contradict_the_model_are_said() {
    let motor = Motor { motor_constant: Some(2.0), resistance: Some(1.0), ..Motor::default() };
    let exported = export(&model(&[]), &Request { motor, ..request(Target::Mjcf) }).unwrap();
    assert!(exported.remarks[0].contains("more than the 0.22"), "{:?}", exported.remarks);
    assert!(exported.text.contains("<general name=\"drive\""));
    let right =
        export(&model(&[]), &Request { motor: Motor { motor_constant: Some(0.05), ..motor }, ..request(Target::Mjcf) });
    let right = right.unwrap();
    assert!(right.remarks.is_empty() && right.text.contains("<dcmotor name=\"drive\""));
}

/// References and drives at which the C functions are compared: x, v, a, u.
fn points() -> Vec<[f64; 4]> {
    let wave = |k: usize, n: f64| (n * k as f64).sin();
    let mut all: Vec<[f64; 4]> =
        (0..400).map(|k| [3.0 * wave(k, 0.7), 2.0 * wave(k, 1.3), 30.0 * wave(k, 2.1), 2.5 * wave(k, 0.9)]).collect();
    // At rest, and slow.
    all.extend([[0.1, 0.0, 0.0, 0.0], [0.2, 0.0, 1.0, 0.01], [0.3, 0.002, 0.0, 0.2], [-0.4, -0.002, 0.0, -0.2]]);
    all
}

/// The exported C, compiled, gives what the compensator of the core gives. In float it does to 2e-5 V, the rounding of
/// numbers of some V. In Q16.16 it does to 4e-4 V: all inputs are rounded to 1.5e-5, and a position to an angle that is
/// 12 times as coarse. A speed over the Stribeck velocity is rounded too, and the friction level follows it.
#[test]
fn c_is_the_compensator() {
    let folder = tempfile::tempdir().unwrap();
    let effects: [&[(Kind, &[f64])]; 5] = [
        &[],
        &[
            (Kind::Stribeck, &[0.3, 0.5, 2.0]),
            (Kind::Cogging, &[0.2, 7.0, 0.5, 0.05, -1.0]),
            (Kind::ConstantLoad, &[-0.1]),
        ],
        &[(Kind::Stribeck, &[0.3, 0.5, 1.3]), (Kind::PositionFriction, &[0.4, 3.0, 0.2]), (Kind::LoadFriction, &[0.2])],
        &[(Kind::DeadZone, &[0.3]), (Kind::Spring, &[0.4, 0.2]), (Kind::QuadraticDrag, &[0.02])],
        &[(Kind::PwmDeadTime, &[0.2, 0.4, 0.03]), (Kind::AsymmetricViscous, &[0.02]), (Kind::GravityLoad, &[0.5, 0.1])],
    ];
    for (case, effects) in effects.into_iter().enumerate() {
        let model = model(effects);
        let exported = export(&model, &request(Target::C)).unwrap();
        assert!(exported.rows.iter().all(|row| row.fate == Fate::Kept), "{:?}", exported.rows);
        let found = compiled(folder.path(), case, &exported.text);
        let plant = model.plant_effects().unwrap();
        let compensator = Compensator::<f64>::new(&model.base, &plant).unwrap().on();
        for ([x, v, a, u], found) in points().into_iter().zip(found) {
            let forward = compensator.drive(Setpoint { x, v, a });
            let inverse = compensator.inverse(u, v);
            for (found, exact, most) in [
                (found[0], forward, 2e-5),
                (found[1], inverse, 2e-5),
                (found[2], forward, 4e-4),
                (found[3], inverse, 4e-4),
            ] {
                assert!((found - exact).abs() < most, "case {case} at {x} {v} {a} {u}: {found} {exact}");
            }
        }
    }
}

/// Compiles a header with every warning as an error, and runs its functions at the points.
fn compiled(folder: &std::path::Path, case: usize, header: &str) -> Vec<[f64; 4]> {
    std::fs::write(folder.join("axis.h"), header).unwrap();
    let rows: Vec<String> = points().iter().map(|[x, v, a, u]| format!("{{{x:?}, {v:?}, {a:?}, {u:?}}}")).collect();
    let main = format!(
        "#include \"axis.h\"\n#include <stdio.h>\nstatic const double rows[][4] = {{{}}};\n\
         static int32_t q(double value) {{ return (int32_t)(value * 65536.0 + (value < 0 ? -0.5 : 0.5)); }}\n\
         int main(void) {{\n  for (unsigned i = 0; i < sizeof rows / sizeof rows[0]; i++) {{\n    const double *r = rows[i];\n    \
         printf(\"%.9g %.9g %.9g %.9g\\n\", axis_feed_forward((float)r[0], (float)r[1], (float)r[2]), \
         axis_inverse((float)r[3], (float)r[1]), axis_feed_forward_q16(q(r[0]), q(r[1]), q(r[2])) / 65536.0, \
         axis_inverse_q16(q(r[3]), q(r[1])) / 65536.0);\n  }}\n  return 0;\n}}\n",
        rows.join(",\n")
    );
    let (source, program) = (folder.join("main.c"), folder.join(format!("main{case}")));
    std::fs::write(&source, main).unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-fsanitize=undefined", "-fno-sanitize-recover"]);
    let built = cc.arg("-o").arg(&program).arg(&source).output().expect("cc, which Rust links with");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let run = Command::new(&program).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = String::from_utf8(run.stdout).unwrap();
    let numbers = |line: &str| -> [f64; 4] {
        let all: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        all.try_into().unwrap()
    };
    let found: Vec<[f64; 4]> = text.lines().map(numbers).collect();
    assert_eq!(found.len(), points().len());
    found
}
