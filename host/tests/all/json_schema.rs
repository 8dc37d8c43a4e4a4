//! Documents of `--json` against `host/schema` (docs/formats.md, section "JSON results").

use std::fs;
use std::path::{Path, PathBuf};

use breakaway::command::schema::schemas;
use serde_json::Value;

use super::support::{breakaway, json};

const MODEL: &str = "base = { b = 0.02685, c = 0.11, f1 = 0.5 }\nunits = { u = \"V\", x = \"rad\" }\n";
const RELAY: &str = "name = \"relay\"\nduration_s = 2.0\nexcitation = { kind = \"relay\", h1 = 2.0, h2 = 1.5 }\n";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("schema")
}

/// The committed schemas are those of the types. `BREAKAWAY_BLESS=1` writes them.
#[test]
fn schemas_are_those_of_the_types() {
    let bless = std::env::var_os("BREAKAWAY_BLESS").is_some();
    let mut names = Vec::new();
    for (name, schema) in schemas() {
        let path = folder().join(format!("{name}.json"));
        let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        if bless {
            fs::write(&path, &text).unwrap();
        }
        let committed = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(committed, text, "{name}: BREAKAWAY_BLESS=1 writes the schema anew");
        names.push(format!("{name}.json"));
    }
    for entry in fs::read_dir(folder()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(names.contains(&name), "{name} is no document's schema");
    }
}

pub fn valid(name: &str, document: &Value) {
    let text = fs::read_to_string(folder().join(format!("{name}.json"))).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap();
    let errors: Vec<String> = validator.iter_errors(document).map(|e| format!("{} {e}", e.instance_path)).collect();
    assert!(errors.is_empty(), "{name}: {errors:?}\n{document}");
}

/// What the commands print is valid; a document without its version, or with text for a number, is not.
#[test]
fn documents_are_valid() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    fs::write(place.join("model.toml"), MODEL).unwrap();
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    for (name, line) in [
        ("simulate", "simulate --model model.toml --experiment relay.toml -o rec.csv"),
        ("run", "run relay.toml --model model.toml -o session"),
        ("sinefit", "sinefit rec.csv"),
        ("identify", "identify rec.csv"),
        ("bode", "bode rec.csv"),
        ("discover", "discover rec.csv"),
        ("tune", "tune model.toml"),
        ("track", "track --model model.toml --reference sine:1,0.2"),
        ("effects", "effects"),
        ("completions", "completions bash"),
        ("man", "man"),
        ("look", "look rec.csv"),
        ("export", "export model.toml --to c"),
        ("models-list", "models list"),
        ("models-show", "models show emps"),
        ("models-compare", "models compare ak80 xl330"),
    ] {
        let document = json(place, &line.split(' ').collect::<Vec<_>>());
        valid(name, &document);
    }
    let failed = breakaway(place, &["identify", "none.csv", "--json"]);
    let error: Value = serde_json::from_slice(&failed.stdout).unwrap();
    valid("error", &error);
    let text = fs::read_to_string(folder().join("error.json")).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap();
    for (field, value) in [("/schema_version", Value::Null), ("/error/message", 1.into())] {
        let mut wrong = error.clone();
        *wrong.pointer_mut(field).unwrap() = value;
        assert!(!validator.is_valid(&wrong), "{field}");
    }
}
