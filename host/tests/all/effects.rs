//! The catalogue as documentation: in step with its definitions, and its names and symbols usable in model files.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use breakaway::command::effects::page;
use breakaway::model::{EffectEntry, Model, known_effects};
use breakaway_core::plant::{Effect, Kind};

/// `BREAKAWAY_BLESS=1 cargo test` writes the page anew.
#[test]
fn the_page_of_effects_is_in_step_with_the_definitions() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    if std::env::var_os("BREAKAWAY_BLESS").is_some() {
        fs::write(&path, page()).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap_or_default();
    assert!(found == page(), "docs/effects.md is not what the definitions say; run BREAKAWAY_BLESS=1 cargo test");
}

#[test]
fn names_and_symbols_can_be_keys_of_a_model_file() {
    let names: BTreeSet<&str> = known_effects().map(|known| known.name).collect();
    assert_eq!(names.len(), Kind::ALL.len());
    for known in known_effects() {
        let symbols: BTreeSet<&str> = known.parameters.iter().map(|p| p.symbol).collect();
        assert_eq!(symbols.len(), known.parameters.len(), "{}", known.name);
        assert!(!symbols.contains("name") && !symbols.contains("se"), "{}", known.name);
        assert!(known.confused_with.iter().all(|other| names.contains(other)), "{}", known.name);
        assert!(symbols.iter().all(|s| s.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')), "{}", known.name);
    }
}

/// A value in the middle of each parameter's range, through an entry, a file, and back to the plant's effect.
#[test]
fn every_effect_survives_a_model_file() {
    for &kind in Kind::ALL {
        let middle: Vec<f64> =
            kind.definition().parameters.iter().map(|p| p.min.max(-2.0).midpoint(p.max.min(3.0))).collect();
        let effect = Effect::new(kind, &middle);
        let text = "[base]\nb = 1\nc = 1\nf1 = 1\n[units]\nu = \"V\"\nx = \"rad\"\n";
        let mut model = Model::parse("m.toml", text).unwrap();
        model.effects.push(EffectEntry::of(&effect, &[Some(0.5)]));
        let again = Model::parse("m.toml", &model.to_toml()).unwrap();
        assert_eq!(again, model, "{}", kind.name());
        assert_eq!(again.plant_effects().unwrap(), [effect], "{}", kind.name());
    }
}

/// A phase of many turns is valid in a model file, whatever range the catalogue prints: it is read and written as it is.
#[test]
fn a_phase_of_many_turns_is_read() {
    let text = "[base]\nb = 1\nc = 1\nf1 = 1\n[[effect]]\nname = \"cogging\"\nA = -0.1\nn = 7\nphi = 300.0\n";
    let model = Model::parse("m.toml", text).unwrap();
    let [effect] = model.plant_effects().unwrap()[..] else { panic!("{model:?}") };
    assert_eq!(effect.p[..3], [-0.1, 7.0, 300.0]);
    assert_eq!(Model::parse("m.toml", &model.to_toml()).unwrap(), model);
}

/// Ripples of several wave numbers are several entries of one name; a file keeps each with its own numbers, in its order.
#[test]
fn an_effect_that_repeats_has_an_entry_for_each_line() {
    let line = |n: f64| Effect::new(Kind::Cogging, &[0.01 * n, n, 0.5]);
    let lines = [line(7.0), line(28.0), line(12.0)];
    let mut model = Model::parse("m.toml", "[base]\nb = 1\nc = 1\nf1 = 1\n").unwrap();
    model.effects = lines.iter().map(|line| EffectEntry::of(line, &[Some(1e-3)])).collect();
    let again = Model::parse("m.toml", &model.to_toml()).unwrap();
    assert_eq!(again, model);
    assert_eq!(again.plant_effects().unwrap(), lines);
}
