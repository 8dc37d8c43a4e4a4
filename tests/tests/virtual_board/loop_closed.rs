//! The whole loop on the virtual board, for each effect that compensation should help. The effect has 0.3 V. That
//! lies between 6 % of the suite's strongest relay (4.75 V) and a quarter of its weakest sine (1.1 V). It is half of
//! the 0.57 V along the sine that is followed.
//!
//! The project's goals for the discovered model compensated are three. Its error is at most a half of the base
//! model's, a fifth of the PID's, and 1.3 times that with the true model. Where the truth itself does not reach the
//! first two, only the last one holds. The test then asserts that the truth does not reach them.
//!
//! Each takes a minute. Two of them are run with all tests, the others by `cargo xtask loops`.

use breakaway::command::run::papers_plant;
use serde_json::Value;

use crate::bench::{options, start};
use crate::closing::{Closed, Hidden, close, rms};
use crate::identify::breakaway;

const COGGING: Hidden = Hidden { name: "cogging", parameters: "A = 0.3\nn = 7.0\nphi = 0.6", sine: (1.0, 0.1) };
const STRIBECK: Hidden = Hidden { name: "stribeck", parameters: "s = 0.3\nvs = 0.5\np = 2.0", sine: (1.0, 0.1) };
/// 5 rad: the speed, and with it the force, is a tenth of that of the suite otherwise.
const ASYMMETRIC: Hidden = Hidden { name: "asymmetric_viscous", parameters: "d = 0.03", sine: (5.0, 0.1) };
const POSITION: Hidden =
    Hidden { name: "position_friction", parameters: "k = 0.6\nn = 3.0\nphi = 1.0", sine: (1.0, 0.1) };
const LOAD: Hidden = Hidden { name: "constant_load", parameters: "f0 = 0.25", sine: (1.0, 0.1) };

impl Closed {
    /// Half of the base, a fifth of the PID.
    fn worth_it(&self, error: f64) -> bool {
        error <= 0.5 * self.base && error <= 0.2 * self.pid
    }

    /// The goals, all three.
    fn reaches_the_goals(&self) {
        assert!(self.worth_it(self.whole), "{self:?}");
        self.is_near_the_truth();
    }

    /// The truth itself does not reach the first goal: what is asked for is what it does.
    fn is_as_good_as_the_truth(&self) {
        assert!(!self.worth_it(self.truth), "the truth reaches the goals, ask for them: {self:?}");
        assert!(self.whole <= 0.2 * self.pid, "{self:?}");
        self.is_near_the_truth();
    }

    /// Errors are against the encoder, whose rounding alone is 0.29 steps.
    fn is_near_the_truth(&self) {
        assert!(self.whole <= 1.3 * self.truth, "{self:?}");
    }

    /// The model was right: the drift watch had nothing to say of its run.
    fn is_believed_by_the_drift_watch(&self) {
        assert_eq!(self.tracked["runs"][2]["mismatches"], Value::Array(Vec::new()), "{self:?}");
    }
}

#[test]
fn cogging_that_was_discovered_is_compensated() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let closed = close(COGGING, folder.path());
    closed.reaches_the_goals();
    closed.is_believed_by_the_drift_watch();
    for name in ["pid.csv", "base.csv", "model.csv", "adaptive.csv", "error.svg"] {
        assert!(folder.path().join("tracked").join(name).is_file(), "{name}");
    }
    let page = std::fs::read_to_string(folder.path().join("track.html")).unwrap();
    assert!(page.contains("measured") && page.contains("whole model compensated"), "the report is another's");
}

#[test]
#[ignore = "a minute: cargo xtask loops"]
fn stribeck_friction_that_was_discovered_is_compensated() {
    needs_qemu!();
    close(STRIBECK, tempfile::tempdir().unwrap().path()).reaches_the_goals();
}

/// The integral reduces a force that changes as slowly as the speed to 0.6 encoder steps. With the truth compensated
/// 0.34 are left, of which rounding is 0.29. So this encoder cannot show a half.
#[test]
#[ignore = "a minute: cargo xtask loops"]
fn asymmetric_viscous_friction_that_was_discovered_is_compensated() {
    needs_qemu!();
    close(ASYMMETRIC, tempfile::tempdir().unwrap().path()).is_as_good_as_the_truth();
}

#[test]
fn position_friction_that_was_discovered_is_compensated() {
    needs_qemu!();
    close(POSITION, tempfile::tempdir().unwrap().path()).reaches_the_goals();
}

/// The integral of the PID carries a constant load: feed-forward is to be no worse.
#[test]
#[ignore = "a minute: cargo xtask loops"]
fn a_constant_load_is_no_worse_than_the_integral() {
    needs_qemu!();
    let closed = close(LOAD, tempfile::tempdir().unwrap().path());
    // The encoder's rounding, 0.29 steps in either, makes ratios of either of 5 %.
    assert!(closed.whole <= 1.05 * closed.base, "{closed:?}");
    closed.is_near_the_truth();
}

/// A reference that the board does not make itself, and one that leaves its travel, are refused before anything moves.
#[test]
fn what_the_board_cannot_follow_is_said_before_it_moves() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    papers_plant().write(&model).unwrap();
    let file = folder.path().join("reference.csv").display().to_string();
    let rows: String =
        (0..20).fold(String::new(), |rows, k| rows + &format!("{},{}\n", 0.1 * f64::from(k), 0.01 * f64::from(k)));
    std::fs::write(&file, format!("t,x\n{rows}")).unwrap();
    let board = start(&options(&papers_plant()));
    for (reference, part) in [
        (file.as_str(), "give it a sine"),
        ("trapezoid:50,1,10", "its travel limits leave 40.0000 rad either way"),
        ("sine:50,0.1", "its travel limits leave 40.0000 rad either way"),
        ("sine:1,900", "frequency must be above 0 and below half the tick rate"),
    ] {
        let model = model.display().to_string();
        let said =
            crate::identify::refused(&["track", "--model", &model, "--port", &board.port, "--reference", reference]);
        assert!(said.contains(part), "{reference}: {said}");
    }
}

/// An S-curve there and back, made by the board from the host's plan. Compensated, the error is the encoder's
/// rounding (0.29 steps) and less than another step. The plant is the model.
#[test]
fn an_s_curve_is_followed_there_and_back() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    papers_plant().write(&model).unwrap();
    let board = start(&options(&papers_plant()));
    let model = model.display().to_string();
    let reference = "s_curve:2,2,8,100,0.2";
    let tracked = breakaway(&["track", "--model", &model, "--port", &board.port, "--reference", reference]);
    let [pid, base] = ["pid", "base"].map(|name| rms(&tracked, name));
    let step = tracked["runs"][1]["rms_steps"].as_f64().unwrap();
    println!("{reference}: PID {pid:.2e}, compensated {base:.2e} rad, {step:.2} steps");
    assert!(step < 1.0 && base < 0.2 * pid, "{tracked}");
}

/// The demo tells the same story of another effect. Of the base model half of the Stribeck effect is left at least.
#[test]
fn the_demo_on_the_virtual_board_names_and_compensates_what_it_hid() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("demo");
    let told = breakaway(&["demo", "--virtual", "--seed", "1", "-o", &output.display().to_string()]);
    assert_eq!((&told["hidden"], &told["found"]), (&"stribeck".into(), &serde_json::json!(["stribeck"])), "{told}");
    assert!(rms(&told, "model") <= 0.5 * rms(&told, "base"), "{told}");
    for name in ["track.html", "discovery.html", "improved.toml", "controller.toml"] {
        assert!(output.join(name).is_file(), "{name}");
    }
}
