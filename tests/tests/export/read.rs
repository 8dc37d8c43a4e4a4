//! The other targets, as their programs read them.

use breakaway::export::{Motor, Request, Target, export};
use breakaway::model::{EffectEntry, Model};
use breakaway_core::plant::{Effect, Kind};

use super::python;

const AXIS: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";

/// The axis with an effect, 0.25 N·m/V at the load.
fn exported(target: Target, effect: Option<Kind>) -> String {
    let mut model = Model::parse("axis.toml", AXIS).unwrap();
    model.effects = effect
        .map(|kind| {
            let value = |p: &breakaway_core::plant::effect::Parameter| p.default.unwrap_or(0.2_f64.clamp(p.min, p.max));
            let p: Vec<f64> = kind.definition().parameters.iter().map(value).collect();
            EffectEntry::of(&Effect::new(kind, &p), &[])
        })
        .into_iter()
        .collect();
    let motor = Motor { drive_gain: Some(0.25), ..Motor::default() };
    let request = Request { target, motor, name: "axis".into(), timestep_s: 1e-3 };
    export(&model, &request).unwrap().text
}

fn read(python: &std::path::Path, target: Target, text: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("axis.txt");
    let ending = if target == Target::Urdf { path.with_extension("urdf") } else { path };
    std::fs::write(&ending, text).unwrap();
    python::answer(python, "read.py", &[target.name(), ending.to_str().unwrap()])
}

/// By hand: b·0.25 = 0.0067125 kg·m², c·0.25 = 0.0275 N·m·s/rad, f1·0.25 = 0.125 N·m.
#[test]
fn urdf_sdf_and_isaac_lab_have_the_base() {
    let Some(python) = python::found() else { return };
    let close = |found: &serde_json::Value, value: f64| {
        assert!((found.as_f64().unwrap() / value - 1.0).abs() < 1e-6, "{found} {value}");
    };
    let urdf = read(&python, Target::Urdf, &exported(Target::Urdf, None));
    close(&urdf["inertia"], 0.0067125);
    close(&urdf["damping"], 0.0275);
    close(&urdf["friction"], 0.125);
    let sdf = read(&python, Target::Sdf, &exported(Target::Sdf, Some(Kind::FlexibleCoupling)));
    close(&sdf["damping"], 0.0275);
    close(&sdf["friction"], 0.125);
    let isaac = read(&python, Target::IsaacLab, &exported(Target::IsaacLab, Some(Kind::Stiction)));
    close(&isaac["armature"], 0.0067125);
    close(&isaac["viscous_friction"], 0.0275);
    close(&isaac["dynamic_friction"], 0.125);
    // The level at rest: 0.2 V more.
    close(&isaac["friction"], 0.175);
}

/// The grammar of Modelica takes the model of every effect, with an equation for the drive, the axis and its bristles.
#[test]
fn modelica_is_in_its_grammar() {
    let Some(python) = python::found() else { return };
    for effect in [None].into_iter().chain(Kind::ALL.iter().copied().map(Some)) {
        let text = exported(Target::Modelica, effect);
        let found = read(&python, Target::Modelica, &text);
        assert!(found["equations"].as_u64().unwrap() >= 6, "{effect:?}: {found}\n{text}");
    }
}
