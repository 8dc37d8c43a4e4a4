//! The developer's one entry: `cargo xtask test`, `setup`, `image`, `emulator`, `uf2`, `budget`, `web`, `fuzz`, `miri`,
//! `arrows`, `bench`, `blind`, `machines`, `mujoco`, `loops`, `soak`, `site`, `notices`. Tests by themselves are
//! `pico2-test`, `web-test`, `fleet-test`, `export-test`, `logs-test`, `python-test`.

mod ahead;
mod arrows;
mod bench;
mod budget;
mod check;
mod chromium;
mod cross;
mod debian;
mod emulator;
mod environment;
mod export;
mod fleet;
mod fuzz;
mod image;
mod lint;
mod logs;
mod loops;
mod miri;
mod notices;
mod own_features;
mod processor;
mod python;
mod qemu;
mod report;
mod rp2350;
mod run;
mod setup;
mod site;
mod soak;
mod web;
mod words;

use std::process::ExitCode;

use clap::Parser;

#[derive(Parser)]
#[command(bin_name = "cargo xtask", about = "The developer's one entry")]
enum Task {
    /// Format, lints, all host tests, doctests, and the builds for the microcontrollers. It ends with the ten slowest
    /// tests, what could not be run here, and `N passed, N failed`
    Test,
    /// Fetch what `test` needs beyond rustup's stable toolchain. rustfmt, clippy and the microcontrollers' targets
    /// come from rustup. Where they are missing, QEMU, Chromium and Python come from Debian's packages, unpacked under
    /// the target folder; root is not needed
    Setup,
    /// Build the virtual board's firmware, for `breakaway virtual-board`, and fetch QEMU if it is missing
    Image,
    /// Run the NUCLEO-G474RE's image on models of its registers, and fetch Unicorn, which executes it, if it is missing
    Emulator,
    /// Build the Pico 2's firmware as images/pico2.uf2 in the target folder, to be dropped on the board
    Uf2,
    /// Run the Pico 2's firmware on an emulated core; needs Python and PyPI
    Pico2Test,
    /// Measure the firmware: instructions per tick, flash, RAM, stack; no floats and no panic in the integer tick
    #[command(alias = "size")]
    Budget {
        /// Write what was measured to firmware/budget.toml, instead of comparing with it
        #[arg(long)]
        record: bool,
    },
    /// Build the page that identifies and discovers in a browser, as web/index.html in the target folder
    Web,
    /// Build the page for the browser, and try it in a headless Chromium
    WebTest,
    /// Search the inputs for one that breaks a promise, with libFuzzer; needs cargo-fuzz, and is no part of `test`
    Fuzz {
        /// Inputs: recording, log, model, controller, experiment, frame, command, flash; all of them where none is named
        targets: Vec<String>,
        /// Processor time for each, s
        #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..))]
        seconds: u64,
    },
    /// Draw which room uses which into docs/architecture.md
    Arrows,
    /// Run the core's tests under Miri: undefined behaviour, on 32 bits; needs nightly, and is no part of `test`
    Miri {
        /// Only tests whose names contain this
        filter: Option<String>,
    },
    /// Run the benches, in release
    Bench {
        /// Compare with what people would use instead, and write docs/benchmarks.md; needs Python and PyPI
        #[arg(long)]
        peers: bool,
        /// Run these parts alone; the others' tables are those of their last run
        #[arg(long, requires = "peers", value_delimiter = ',')]
        only: Vec<bench::peers::Part>,
        /// Time and memory from ten seconds to an hour and from 1 to 64 recordings, into docs/scale.md; needs Linux
        #[arg(long, conflicts_with = "peers")]
        scale: bool,
    },
    /// Discover blind cases: the hidden plant, scored against its sealed truth, in release
    Blind {
        /// Passed on: `--sizes 3,10 --seeds 1..5 --effects cogging,none --experiment suite --world unkind --verbose`
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Discover the real machines, scored against what is known of them, into docs/machines.csv and docs/machines.md
    Machines {
        /// Passed on: `--machines emps,laas --splits all,halves --anew`; `--splits quick` is a subset, `full` is everything
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Simulate machines with MuJoCo, discover and score them, into docs/mujoco.csv and docs/mujoco.md; needs Python and PyPI
    Mujoco {
        /// Seeds, such as 201..205, whose end is left out
        #[arg(long)]
        seeds: String,
        /// Scenarios of tests/mujoco/machines, with commas between [default: all]
        #[arg(long)]
        scenarios: Option<String>,
        /// Make the rows again, whether the file holds them or not
        #[arg(long)]
        anew: bool,
    },
    /// Close the loop on the virtual board for every effect of docs/control.md, and print its table
    Loops,
    /// Stream from the virtual board over a link with noise: nothing may be lost but the frames that were hit
    Soak {
        /// How long, in real time
        #[arg(long, default_value_t = 30.0)]
        minutes: f64,
        /// Of a million bytes so many are flipped, lost or have garbage before them, either way
        #[arg(long, value_name = "PPM", default_value_t = 100, value_parser = clap::value_parser!(u32).range(0..=100_000))]
        noise: u32,
    },
    /// Build the documentation as a site into target/site, with mdBook; its library is compiled the first time
    Site,
    /// Collect the licences of third-party code, for the archives into notices in the target folder and for the wheels into
    /// python. `web` writes those of its page
    Notices,
    /// Run and read exported models with MuJoCo and parsers from PyPI; needs Python
    ExportTest,
    /// Write a recording in every format of a log, and compare what `identify` says of each. The format's own package
    /// writes; needs Python, PyPI and the recordings, and is no part of `test`
    LogsTest,
    /// Build the Python package's wheel, install it in an environment of its own, and run its tests; needs Python and PyPI
    PythonTest,
    /// Run fleet/fleet.py on two workers and kill one of them; needs Python and PyPI, and is no part of `test`
    FleetTest,
}

fn main() -> ExitCode {
    let result = match Task::parse() {
        Task::Test => return check::all(),
        Task::Setup => setup::all(),
        Task::Emulator => emulator::all(),
        Task::Image => image::all(),
        Task::Uf2 => rp2350::all(),
        Task::Web => web::build(),
        Task::WebTest => web::test(),
        Task::Pico2Test => rp2350::test(),
        Task::Budget { record } => budget::all(record),
        Task::Fuzz { targets, seconds } => fuzz::all(&targets, seconds),
        Task::Arrows => arrows::draw(),
        Task::Miri { filter } => miri::run(filter.as_deref()),
        Task::Bench { scale: true, .. } => bench::scale(),
        Task::Bench { peers: false, .. } => bench::all(),
        Task::Bench { peers: true, only, .. } => bench::peers::run_parts(&only),
        Task::Blind { arguments } => bench::blind(&arguments),
        Task::Machines { arguments } => bench::machines(&arguments),
        Task::Mujoco { seeds, scenarios, anew } => bench::mujoco(&seeds, scenarios.as_deref(), anew),
        Task::Soak { minutes, noise } => cross::install().and_then(|toolchain| soak::all(toolchain, minutes, noise)),
        Task::Loops => cross::install().and_then(loops::all),
        Task::Site => site::build(),
        Task::Notices => notices::all(),
        Task::ExportTest => export::test(),
        Task::FleetTest => fleet::test(),
        Task::PythonTest => python::all(),
        Task::LogsTest => logs::test(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
#[path = "../../tests/tests/all/docs/commands.rs"]
mod commands;

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::Task;
    use super::commands::{Program, lines, pages};
    use super::run::root;

    /// Every `cargo xtask` line of the README and the pages; those of `breakaway` are tested in tests/tests/all/docs.rs.
    #[test]
    fn the_pages_lines_parse() {
        let mut seen = 0;
        for (page, text) in pages() {
            for line in lines(&page, &text).iter().filter(|line| line.program == Program::Xtask) {
                let words = ["xtask".to_owned()].into_iter().chain(line.words());
                if let Err(error) = Task::try_parse_from(words) {
                    panic!("{}: {error}", line.place);
                }
                seen += 1;
            }
        }
        assert!(seen >= 5, "only {seen} lines were found");
    }

    /// `cargo run` without a name, as the README has it: of the default members one names the program to run.
    #[test]
    fn cargo_run_without_a_name_runs_the_command() {
        let manifest = |folder: &str| -> toml::Table {
            toml::from_str(&std::fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap()).unwrap()
        };
        let members = manifest("")["workspace"]["default-members"].as_array().unwrap().clone();
        let packages = members.iter().map(|member| manifest(member.as_str().unwrap())["package"].clone());
        let named: Vec<_> = packages.filter_map(|package| Some(package.get("default-run")?.to_string())).collect();
        assert_eq!(named, ["\"breakaway\""]);
    }
}
