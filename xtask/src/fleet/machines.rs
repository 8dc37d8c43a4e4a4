//! The machines of the fleet's test: simulated, small, a few seconds of discovery each.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::Result;

use crate::run::run;

/// The machine that has no recording.
pub const BROKEN: &str = "broken";
/// The machine that misses nothing.
pub const FREE: &str = "free";
/// Loads of the others, V.
const LOADS: [f64; 6] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3];

/// Two relays of 4 s at 4 ms: they settle base and load.
fn relay(name: &str, h1: f64, h2: f64) -> String {
    format!(
        "name = \"{name}\"\ntick_s = 0.004\nduration_s = 4.0\n[excitation]\nkind = \"relay\"\nh1 = {h1:?}\nh2 = {h2:?}\n\
         [sensor]\nencoder_step = 1e-3\n"
    )
}

/// Makes them in `folder/machines`; their names, sorted.
pub fn make(folder: &Path, breakaway: &Path) -> Result<Vec<String>> {
    let machines = folder.join("machines");
    fs::write(folder.join("high.toml"), relay("high", 2.0, 1.5))?;
    fs::write(folder.join("low.toml"), relay("low", 1.0, 0.9))?;
    let base = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";
    let mut names = Vec::new();
    for (index, load) in [0.0].into_iter().chain(LOADS).enumerate() {
        let name = if load == 0.0 { FREE.to_owned() } else { format!("loaded_{index}") };
        let effect =
            if load == 0.0 { String::new() } else { format!("[[effect]]\nname = \"constant_load\"\nf0 = {load:?}\n") };
        fs::write(folder.join("plant.toml"), format!("{base}{effect}"))?;
        for experiment in ["high.toml", "low.toml"] {
            let mut command = Command::new(breakaway);
            command.current_dir(folder).args(["run", experiment, "--model", "plant.toml", "-o"]);
            run(command.arg(machines.join(&name).join("fit")))?;
        }
        names.push(name);
    }
    fs::create_dir_all(machines.join(BROKEN))?;
    fs::write(machines.join(BROKEN).join("nonsense.csv"), "t,u,x\n0,1,nonsense\n")?;
    names.push(BROKEN.to_owned());
    names.sort();
    Ok(names)
}
