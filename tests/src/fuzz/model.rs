//! Model and controller files: an error with the file's name, or a value that means what it writes and can be run.

use breakaway::control::design::Design;
use breakaway::model::Model;
use breakaway::simulate::axis::Axis;
use breakaway_core::control::{ControllerState, Setpoint};
use breakaway_core::plant::Base;

use super::experiment::few_samples;

/// Reads the bytes as a model, writes it, reads it again, and runs what is accepted.
pub fn model(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let model = match Model::parse("fuzz.toml", &text) {
        Ok(model) => model,
        Err(error) => {
            assert!(error.to_string().starts_with("fuzz.toml:"), "{error}");
            return false;
        }
    };
    Base::new(model.base.b, model.base.c, model.base.f1).unwrap();
    assert_eq!(Model::parse("again.toml", &model.to_toml()).unwrap(), model);
    let Ok(effects) = model.plant_effects() else { return true };
    assert!(model.effects.iter().all(|entry| entry.effect().is_some()));
    let run = Axis::new(model.base, &effects, model.units).run(&few_samples());
    if let Ok(run) = run {
        assert!(run.recording.x.iter().chain(&run.true_x).all(|value| value.is_finite()));
    }
    true
}

/// Reads the bytes as a controller, writes it, reads it again, and ticks what is accepted.
pub fn controller(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let design = match Design::parse("fuzz.toml", &text) {
        Ok(design) => design,
        Err(error) => {
            assert!(error.to_string().starts_with("fuzz.toml "), "{error}");
            return false;
        }
    };
    assert_eq!(Design::parse("again.toml", &design.to_toml()).unwrap(), design);
    let controller = design.controller::<f64>().unwrap();
    let mut state = ControllerState::start(&controller);
    for k in 0..50 {
        let step = Setpoint { x: 1.0, ..Setpoint::default() };
        // Gains may be so large that the drive is no number: then there is none.
        let Some(command) = controller.tick(&mut state, step, f64::from(k) * 0.01) else { break };
        assert!(command.u.abs() <= design.drive_limit, "{} past {}", command.u, design.drive_limit);
    }
    true
}
