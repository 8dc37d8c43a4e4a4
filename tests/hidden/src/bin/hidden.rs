//! Writes one blind case: `hidden --seed 7 --effects cogging,delay --size 10 -o records --sealed truth`.

use breakaway_hidden::{Case, Experiment, Setting, write_session};
use std::{error::Error, path::PathBuf, process::ExitCode};

const USAGE: &str = "usage: hidden [--seed N] [--effects NAME,NAME | none] [--size PERCENT] \
[--experiment suite|relay|multisine|track|slow_sine|closed] [--world kind|unkind|unkind:ITEM,ITEM] -o DIR --sealed DIR";

fn run() -> Result<(), Box<dyn Error>> {
    let mut case = Case::suite(0, &[], 10.0)?;
    let (mut records, mut sealed, mut setting) = (None, None, Setting::Kind);
    let mut arguments = std::env::args().skip(1);
    while let Some(option) = arguments.next() {
        let value = arguments.next().ok_or(USAGE)?;
        match option.as_str() {
            "--seed" => case.seed = value.parse()?,
            "--size" => case.size_percent = value.parse()?,
            "--effects" => {
                let names: Vec<&str> = value.split(',').collect();
                case = Case::new(case.seed, &names, case.size_percent, case.experiment)?;
            }
            "--experiment" => case.experiment = Experiment::named(&value).ok_or(USAGE)?,
            "--world" => setting = Setting::named(&value)?,
            "-o" => records = Some(PathBuf::from(value)),
            "--sealed" => sealed = Some(PathBuf::from(value)),
            _ => return Err(USAGE.into()),
        }
    }
    let world = setting.draw(case.seed);
    let (session, truth) = case.within(world).generate_with_truth();
    write_session(&session, &truth, &records.ok_or(USAGE)?, &sealed.ok_or(USAGE)?)?;
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
