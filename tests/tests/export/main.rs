//! What is exported, run and read by the programs that it is for: MuJoCo and parsers from PyPI, in `target/mujoco-venv`
//! (`cargo xtask export-test` makes it).

mod cases;
mod page;
mod python;
mod read;

use breakaway::export::{self, Fate, Motor, Request, Target};
use breakaway::models::held_out::{Window, rmse};

use cases::Case;

/// Time step of the simulations, s. MuJoCo's friction is as stiff as its step allows: at 1 ms it errs by 4e-3 of a motion
/// of 0.6 rad over 3 s, at 0.1 ms by 2.4e-4.
const STEP_S: f64 = 5e-5;
/// What the error may be over ours where nothing is lost: the 10 %.
const MOST: f64 = 1.1;

/// Both errors of a case.
struct Compared {
    name: &'static str,
    what: String,
    unit: String,
    windows: usize,
    ours: f64,
    theirs: f64,
    lost: Vec<String>,
    approximated: Vec<String>,
}

fn compared(python: &std::path::Path, case: &Case) -> Compared {
    let request = Request { target: Target::Mjcf, motor: case.motor, name: case.name.to_owned(), timestep_s: STEP_S };
    let exported = export::export(&case.model, &request).unwrap();
    let simulated = python::simulate(python, &exported.text, &case.model, &case.windows);
    let index = |window: &Window| case.windows.iter().position(|other| std::ptr::eq(other, window)).unwrap();
    let names = |fate| exported.rows_of(fate).map(|row| row.what.clone()).collect();
    Compared {
        name: case.name,
        what: case.what.clone(),
        unit: case.model.units.x.clone(),
        windows: case.windows.len(),
        ours: rmse(&case.windows, |window| &window.simulated),
        theirs: rmse(&case.windows, |window| &simulated[index(window)]),
        lost: names(Fate::Lost),
        approximated: names(Fate::Approximated),
    }
}

/// MuJoCo simulates what is held out with the exported model: within 10 % of our own error where nothing is lost or
/// approximated. The table of docs/export.md has the same rows; `BREAKAWAY_BLESS=1` writes it.
#[test]
fn mujoco_simulates_as_we_do() {
    let Some(python) = python::found() else { return };
    let (mut cases, complete) = (cases::simulated(), breakaway_tests::measured_data());
    if let Some(data) = &complete {
        cases.extend(cases::real(data));
    }
    let rows: Vec<Compared> = cases.iter().map(|case| compared(&python, case)).collect();
    for row in &rows {
        println!("{}", page::line(row));
    }
    for row in rows.iter().filter(|row| row.lost.is_empty() && row.approximated.is_empty()) {
        assert!(row.theirs < MOST * row.ours, "{}: {:e}, ours {:e}", row.name, row.theirs, row.ours);
    }
    if complete.is_some() {
        page::check(&rows);
    }
}

/// The motor's constants do not change the motion. With a winding, part of the damping is MuJoCo's back-EMF.
#[test]
fn a_winding_moves_alike() {
    let Some(python) = python::found() else { return };
    let mut case = cases::simulated().swap_remove(0);
    case.motor = Motor { motor_constant: Some(0.02), resistance: Some(2.0), gear: Some(5.0), ..Motor::default() };
    let row = compared(&python, &case);
    assert!(row.theirs < MOST * row.ours, "{:e}, ours {:e}", row.theirs, row.ours);
}
