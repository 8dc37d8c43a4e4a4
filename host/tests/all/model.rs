//! Model files: each mistake with its line, and a round trip that changes nothing.

use breakaway::model::{BaseSe, EffectEntry, Model};
use breakaway::recording::Units;
use breakaway_core::plant::Base;
use insta::assert_snapshot;
use proptest::prelude::*;

const GOOD: &str = "\
# identified from run.csv
# 2 kHz, 10 s

[base]
b = 0.0031  # V·s²/rad
c = 1
f1 = 0.4

[base.se]
b = 1e-5

[units]
u = \"V\"
x = \"rad\"

[[effect]]
name = \"constant_load\"
f0 = -0.2
";

fn message(from: &str, to: &str) -> String {
    let text = GOOD.replacen(from, to, 1);
    assert_ne!(text, GOOD, "`{from}` is not in the file");
    Model::parse("m.toml", &text).unwrap_err().to_string()
}

#[test]
fn a_model_file_says_what_it_says() {
    let model = Model::parse("m.toml", GOOD).unwrap();
    assert_eq!(model.base, Base { b: 0.0031, c: 1.0, f1: 0.4 });
    assert_eq!(model.base_se, BaseSe { b: Some(1e-5), c: None, f1: None });
    assert_eq!(model.effects[0].parameters["f0"], -0.2);
    assert_eq!(model.provenance, ["identified from run.csv", "2 kHz, 10 s"]);
}

#[test]
fn unknown_names_are_answered_with_the_nearest_valid_one() {
    assert_snapshot!(message("f1 =", "F1 ="), @"m.toml:7: unknown key of [base] `F1`; did you mean `f1`?; valid: b, c, f1, se");
    assert_snapshot!(message("[units]", "[unit]"), @"m.toml:12: unknown key `unit`; did you mean `units`?; valid: base, units, effect");
    assert_snapshot!(message("x = \"rad\"", "position = 1"), @"m.toml:14: unknown key of [units] `position`; valid: u, x");
    assert_snapshot!(message("constant_load", "constant_laod"), @"m.toml:17: unknown effect `constant_laod`; did you mean `constant_load`?; valid: delay, electrical_lag, dead_zone, saturation, pwm_dead_time, gain_drift, constant_load, asymmetric_viscous, quadratic_drag, stribeck, stiction, load_friction, friction_drift, position_friction, cogging, gravity_load, spring, end_stop, time_periodic, inertia_step, dahl, lugre, backlash, flexible_coupling, encoder_eccentricity");
    assert_snapshot!(message("f0 =", "fo ="), @"m.toml:18: unknown parameter of constant_load `fo`; did you mean `f0`?; valid: name, se, f0");
    assert_snapshot!(message("b = 1e-5", "d = 1e-5"), @"m.toml:10: unknown key of [base.se] `d`; valid: b, c, f1");
}

#[test]
fn missing_and_wrong_values_are_named_with_their_line() {
    assert_snapshot!(message("c = 1\n", ""), @"m.toml:4: `c` is missing in [base]");
    assert_snapshot!(message("f0 = -0.2\n", ""), @"m.toml:16: `f0` is missing in [[effect]]");
    assert_snapshot!(message("name = \"constant_load\"\n", ""), @"m.toml:16: `name` is missing in [[effect]]");
    assert_snapshot!(message("b = 0.0031", "b = 0"), @"m.toml:5: `b` is 0; it must be a finite number above 0");
    assert_snapshot!(message("c = 1", "c = -1"), @"m.toml:6: `c` is -1; it must be a finite number, 0 or more");
    assert_snapshot!(message("f1 = 0.4", "f1 = nan"), @"m.toml:7: `f1` is nan; it must be a finite number");
    assert_snapshot!(message("f1 = 0.4", "f1 = \"0.4\""), @r#"m.toml:7: `f1` is "0.4"; it must be a finite number"#);
    assert_snapshot!(message("b = 1e-5", "b = -1e-5"), @"m.toml:10: `b` is -1e-5; it must be a finite number, 0 or more");
    assert_snapshot!(message("u = \"V\"", "u = 3"), @"m.toml:13: `u` is 3; it must be a text in quotes");
    assert_snapshot!(message("[[effect]]", "[effect]"), @"m.toml:16: `effect` is a table; it must be a list of tables, each under [[effect]]");
    assert_snapshot!(Model::parse("m.toml", "").unwrap_err(), @"m.toml:1: `base` is missing in the file");
    assert_snapshot!(message("c = 1", "c = = 1"), @"m.toml:6: not valid TOML: extra `=`, expected nothing");
    assert_snapshot!(Model::read("no/such.toml".as_ref()).unwrap_err(), @"no/such.toml: no such file; check the path");
}

#[test]
fn a_written_model_shows_units_and_provenance() {
    let mut model = Model::parse("m.toml", GOOD).unwrap();
    model.effects[0].se.insert("f0".to_owned(), 0.01);
    assert_snapshot!(model.to_toml(), @r#"
    # identified from run.csv
    # 2 kHz, 10 s

    [base]
    # b·x'' + c·x' + f1·sgn(x') = u
    b = 0.0031  # V·s²/rad
    c = 1.0  # V·s/rad
    f1 = 0.4  # V

    [base.se]
    # Standard errors, in the units above
    b = 1e-5

    [units]
    u = "V"
    x = "rad"

    [[effect]]
    name = "constant_load"
    f0 = -0.2  # V
    [effect.se]
    f0 = 0.01
    "#);
}

/// Ranges are those of the catalogue; a refinement may be left out, and is then written with its default.
#[test]
fn parameters_of_effects_are_held_to_their_ranges() {
    let stribeck = |rest: &str| {
        let text =
            GOOD.replace("name = \"constant_load\"\nf0 = -0.2\n", &format!("name = \"stribeck\"\ns = 0.2\n{rest}"));
        Model::parse("m.toml", &text).map(|model| model.to_toml()).map_err(|error| error.to_string())
    };
    assert_snapshot!(stribeck("vs = 0\n").unwrap_err(), @"m.toml:19: `vs` is 0; it must be from 1e-12 to 1000000000.0 (Stribeck velocity)");
    assert_snapshot!(stribeck("vs = 0.1\np = 5\n").unwrap_err(), @"m.toml:20: `p` is 5; it must be from 0.5 to 4.0 (exponent)");
    assert_snapshot!(stribeck("p = 2\n").unwrap_err(), @"m.toml:16: `vs` is missing in [[effect]]");
    let written = stribeck("vs = 0.1\n").unwrap();
    assert!(written.ends_with("s = 0.2  # V\nvs = 0.1  # rad/s\np = 2.0\n"), "{written}");
}

prop_compose! {
    fn models()(
        b in 1e-300..1e300_f64,
        c in 0.0..1e300_f64,
        f1 in 0.0..1e300_f64,
        se in proptest::option::of(0.0..1e300_f64),
        loads in proptest::collection::vec(-1e9..1e9_f64, 0..3),
        units in (".{0,6}", "[a-z\"\\\\#]{1,6}"),
        provenance in proptest::collection::vec("[a-zA-Z0-9:][a-zA-Z0-9 #]{0,20}[a-z]", 0..3),
    ) -> Model {
        Model {
            base: Base { b, c, f1 },
            base_se: BaseSe { b: se, c: None, f1: se },
            units: Units { u: units.0, x: units.1 },
            effects: loads.iter().map(|&f0| EffectEntry {
                name: "constant_load".to_owned(),
                parameters: [("f0".to_owned(), f0)].into(),
                se: se.map(|se| ("f0".to_owned(), se)).into_iter().collect(),
            }).collect(),
            provenance,
        }
    }
}

proptest! {
    /// Every number bit for bit, and every unit whatever characters it has.
    #[test]
    fn written_and_read_back_is_the_same(model in models()) {
        prop_assert_eq!(Model::parse("m.toml", &model.to_toml()).unwrap(), model);
    }

    #[test]
    fn no_text_makes_the_parser_panic(text in ".{0,200}", at in 0..GOOD.len(), insert in "[\\[\\]=\"#a-z0-9\n]{0,6}") {
        let _ = Model::parse("m.toml", &text);
        let at = (0..=at).rev().find(|&at| GOOD.is_char_boundary(at)).unwrap_or(0);
        let _ = Model::parse("m.toml", &[&GOOD[..at], &insert, &GOOD[at..]].concat());
    }
}

#[test]
fn a_model_is_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.toml");
    let model = Model::parse("m.toml", GOOD).unwrap();
    model.write(&path).unwrap();
    assert_eq!(Model::read(&path).unwrap(), model);
    let nowhere = model.write(&folder.path().join("no/such/m.toml")).unwrap_err();
    assert!(nowhere.to_string().contains("m.toml: cannot be written, and nothing was changed: "));
}
