//! The Python that has the programs, and what it is asked.

use std::path::{Path, PathBuf};
use std::process::Command;

use breakaway::model::Model;
use breakaway::models::held_out::Window;
use breakaway_core::plant::effect::Element;
use serde_json::json;

/// The folder of the scripts.
fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("mujoco")
}

/// Python in `mujoco-venv` of the target folder; `None`, with what to do, where it is not there.
pub fn found() -> Option<PathBuf> {
    let own = std::env::current_exe().unwrap();
    let python = own.ancestors().nth(3).map(|target| target.join("mujoco-venv/bin/python")).unwrap_or_default();
    if python.exists() {
        return Some(python);
    }
    assert!(std::env::var_os("CI").is_none(), "no {}", python.display());
    println!("NOT RUN: no {}; `cargo xtask export-test` makes it", python.display());
    None
}

/// What a script prints.
pub fn answer(python: &Path, script: &str, arguments: &[&str]) -> serde_json::Value {
    let mut command = Command::new(python);
    let output = command.arg("-B").arg(scripts().join(script)).args(arguments).output().unwrap();
    assert!(output.status.success(), "{script} {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Positions of the windows, simulated by MuJoCo.
pub fn simulate(python: &Path, mjcf: &str, model: &Model, windows: &[Window]) -> Vec<Vec<f64>> {
    let folder = tempfile::tempdir().unwrap();
    let (xml, list) = (folder.path().join("axis.xml"), folder.path().join("windows.json"));
    std::fs::write(&xml, mjcf).unwrap();
    let effects = model.plant_effects().unwrap();
    let memory = |window: &Window, wanted: fn(Element) -> bool| {
        let at = effects.iter().position(|effect| wanted(effect.element(&model.base)))?;
        window.memory.get(at).copied()
    };
    let windows: Vec<_> = windows
        .iter()
        .map(|window| {
            let bristle = memory(window, |element| matches!(element, Element::Bristles { .. })).map(|memory| memory[0]);
            let second = memory(window, |element| matches!(element, Element::SprungLoad { .. }));
            json!({
                "t": window.t, "u": window.u, "start": window.start, "bristle": bristle,
                "second": second.map(|memory| [memory[0], memory[1]]),
            })
        })
        .collect();
    std::fs::write(&list, serde_json::to_string(&windows).unwrap()).unwrap();
    let found = answer(python, "simulate.py", &[xml.to_str().unwrap(), list.to_str().unwrap()]);
    serde_json::from_value(found).unwrap()
}
