//! The suite on the virtual board, and an effect in its plant named from the recordings.

use breakaway::command::run::papers_plant;
use breakaway::model::Model;

use crate::bench::{options, start};
use crate::identify::breakaway;

/// A Stribeck effect of half the Coulomb friction, over an encoder of 1 mrad.
#[test]
fn the_suite_over_the_port_names_an_effect_of_the_plant() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plant.toml");
    papers_plant().write(&file).unwrap();
    let mut text = std::fs::read_to_string(&file).unwrap();
    text.push_str("\n[[effect]]\nname = \"stribeck\"\ns = 0.25\nvs = 0.3\np = 2.0\n");
    std::fs::write(&file, text).unwrap();
    let board = start(&options(&Model::read(&file).unwrap()));
    let session = folder.path().join("session");
    let done = breakaway(&["run", "suite", "--port", &board.port, "-o", &session.display().to_string()]);
    let recordings = done["recordings"].as_array().unwrap();
    let of = |role: &str| -> Vec<String> {
        let with = recordings.iter().filter(|recording| recording["role"] == role);
        with.map(|recording| recording["file"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!((of("fit").len(), of("score").len()), (5, 3), "{done}");
    assert!(recordings.iter().all(|recording| recording["missing"] == 0), "{done}");
    let (fit, score) = (of("fit"), of("score"));
    let mut arguments = vec!["discover"];
    arguments.extend(fit.iter().map(String::as_str));
    arguments.push("--holdout");
    arguments.extend(score.iter().map(String::as_str));
    let found = breakaway(&arguments);
    let names: Vec<&str> = found["effects"].as_array().unwrap().iter().map(|e| e["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["stribeck"], "{found}");
}
