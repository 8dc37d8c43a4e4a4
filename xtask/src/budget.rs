//! `cargo xtask budget`: what the firmware costs, against what it may cost and what it did cost.

mod elf;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};

use crate::cross::{self, Toolchain};
use crate::emulator;
use crate::qemu;
use crate::rp2350;
use crate::run::{cargo, root};

/// The program that measures the ticks of the board's image.
pub const TICKS: &str = "ticks";
/// What was measured on purpose, and committed.
const RECORD: &str = "firmware/budget.toml";
/// A number may grow by this factor before it is a failure.
const RATCHET: f64 = 1.03;
/// Instructions are counted by QEMU: each takes 2¹⁰ ns of its time, so that SysTick resolves them.
const ICOUNT: &str = "shift=10,sleep=off";

/// What may not be exceeded, whatever was recorded (name, limit, unit). Ticks are those of the profile that is flashed.
/// The virtual board's image has none for flash, only the ratchet: its flash is emulated.
/// The Pico 2's program runs in RAM: with all of its statics a quarter of it, the rest is for the stack and for what comes.
const LIMITS: [(&str, u64, &str); 9] = [
    ("relay_tick_mean", 400, "instructions"),
    ("adaptive_tick_mean", 600, "instructions"),
    ("ram_bytes", 24 * 1024, "bytes"),
    // 30 % of half a period, which is the deadline: 8500 cycles.
    ("nucleo_any_cycles_worst", 2550, "cycles"),
    ("nucleo_ccm_bytes", 32 * 1024, "bytes"),
    ("nucleo_flash_bytes", 96 * 1024, "bytes"),
    ("nucleo_ram_bytes", 24 * 1024, "bytes"),
    ("pico2_flash_bytes", 128 * 1024, "bytes"),
    ("pico2_ram_bytes", 128 * 1024, "bytes"),
];

#[derive(Debug, Default, Serialize, Deserialize)]
struct Record {
    measured: BTreeMap<String, u64>,
}

/// Measures everything, and compares or records.
pub fn all(record: bool) -> Result<()> {
    let qemu = qemu::program()?;
    emulator::library()?;
    let ticks = cargo(["run", "--quiet", "--package", "breakaway-emulator", "--bin", TICKS]);
    measure(cross::install()?, Some(&qemu), Some(ticks), record)
}

/// The program that measures the board's ticks, as a build in the profile `dev` leaves it.
pub fn ticks() -> PathBuf {
    cross::target_folder().join("debug").join(format!("{TICKS}{}", std::env::consts::EXE_SUFFIX))
}

/// Measures, and compares or records. Without a QEMU only what the linker knows, and without `ticks` (which need a Unicorn)
/// nothing of the board's own ticks.
pub fn measure(toolchain: Toolchain, qemu: Option<&Path>, ticks: Option<Command>, record: bool) -> Result<()> {
    cross::build(toolchain, &cross::INTEGER_TICK)?;
    elf::integers_only(&cross::binary(&cross::INTEGER_TICK, "integer-tick"))?;
    cross::build(toolchain, &cross::BUDGET)?;
    cross::build(toolchain, &cross::IMAGE)?;
    let sizes = elf::sizes(&cross::binary(&cross::IMAGE, "mps2-an386"))?;
    let mut now = BTreeMap::from([("flash_bytes".to_owned(), sizes.flash)]);
    if let Some(qemu) = qemu {
        now.extend(counted(qemu, sizes.ram)?);
    }
    emulator::image(toolchain)?;
    if let Some(ticks) = ticks {
        now.extend(numbers(ticks)?);
    }
    let nucleo = elf::sizes(&cross::binary(&cross::NUCLEO, "nucleo-g474re"))?;
    now.insert("nucleo_flash_bytes".into(), nucleo.flash);
    now.insert("nucleo_ram_bytes".into(), nucleo.ram);
    now.insert("nucleo_ccm_bytes".into(), nucleo.ccm);
    let pico2 = elf::sizes(&rp2350::build(toolchain)?)?;
    now.insert("pico2_flash_bytes".into(), pico2.flash);
    now.insert("pico2_ram_bytes".into(), pico2.ram);
    let file = root().join(RECORD);
    if record {
        let text = toml::to_string(&Record { measured: now.clone() })?;
        let head = "# Written by `cargo xtask budget --record`; `cargo xtask budget` fails where a number grows by over 3 %.\n";
        std::fs::write(&file, format!("{head}{text}")).with_context(|| file.display().to_string())?;
    }
    let text = std::fs::read_to_string(&file).with_context(|| format!("{RECORD}: `cargo xtask budget --record`"))?;
    let recorded: Record = toml::from_str(&text).with_context(|| RECORD)?;
    let wrong = table(&now, &recorded.measured);
    if wrong.is_empty() { Ok(()) } else { bail!("{}", wrong.join("; ")) }
}

/// What the measuring image says of itself under QEMU, and the RAM of the board's image, whose statics are `statics` bytes.
fn counted(qemu: &Path, statics: u64) -> Result<BTreeMap<String, u64>> {
    let mut now = run(qemu, &cross::binary(&cross::BUDGET, "budget"))?;
    let parts = ["tick_bytes", "app_bytes", "channels_bytes", "sums_bytes"];
    let state: u64 = parts.iter().filter_map(|name| now.get(*name)).sum();
    // The virtual board keeps tick and application on its stack; a board with interrupts has them in statics.
    now.insert("ram_bytes".into(), statics + state);
    if let Some(stack) = now.get_mut("stack_bytes") {
        *stack = stack.saturating_sub(state);
    }
    Ok(now)
}

/// Prints every number; what is wrong with them.
fn table(now: &BTreeMap<String, u64>, recorded: &BTreeMap<String, u64>) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, value) in now {
        let limit = LIMITS.iter().find(|(limited, ..)| limited == name);
        let before = recorded.get(name);
        let of = limit.map_or(String::new(), |(_, limit, unit)| format!("  of {limit} {unit}"));
        println!("{name:<28} {value:>7}{of}");
        if let Some((_, limit, unit)) = limit.filter(|(_, limit, _)| value > limit) {
            wrong.push(format!("{name} = {value} is over its budget of {limit} {unit}"));
        }
        match before {
            Some(before) if *value as f64 > *before as f64 * RATCHET => wrong.push(format!(
                "{name} grew from {before} to {value}, by over 3 %: make it smaller, or record it on purpose \
                 (`cargo xtask budget --record`)"
            )),
            Some(_) => {}
            None => wrong.push(format!("{name} is not recorded: `cargo xtask budget --record`")),
        }
    }
    wrong
}

/// Runs a measuring image; its `name = number` lines.
pub fn run(qemu: &Path, image: &Path) -> Result<BTreeMap<String, u64>> {
    let mut qemu = Command::new(qemu);
    qemu.args(["-M", "mps2-an386", "-display", "none", "-monitor", "none", "-nodefaults", "-icount", ICOUNT]);
    qemu.args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(image);
    numbers(qemu)
}

/// The `name = number` lines that a program prints.
fn numbers(mut program: Command) -> Result<BTreeMap<String, u64>> {
    let name = program.get_program().display().to_string();
    let output = program.stdin(std::process::Stdio::null()).output().with_context(|| name.clone())?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("{name}: {}: {said}", output.status);
    }
    let numbers = said.lines().filter_map(|line| line.split_once(" = "));
    let numbers: BTreeMap<String, u64> =
        numbers.filter_map(|(name, value)| Some((name.to_owned(), value.trim().parse().ok()?))).collect();
    if numbers.is_empty() {
        bail!("{name} printed no numbers: {said}");
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(pairs: &[(&str, u64)]) -> BTreeMap<String, u64> {
        pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
    }

    #[test]
    fn growth_by_over_three_percent_and_a_passed_limit_are_failures() {
        let recorded = numbers(&[("relay_tick_mean", 390), ("stack_bytes", 1000)]);
        assert!(table(&numbers(&[("relay_tick_mean", 395), ("stack_bytes", 1030)]), &recorded).is_empty());
        assert_eq!(table(&numbers(&[("stack_bytes", 1031)]), &recorded).len(), 1);
        // 401 of 400, and within 3 % of what was recorded.
        assert_eq!(table(&numbers(&[("relay_tick_mean", 401)]), &recorded).len(), 1);
        assert_eq!(table(&numbers(&[("unheard_of", 1)]), &recorded).len(), 1);
    }
}
