//! A limit cycle by the event-exact simulator, by scipy's `solve_ivp` with events and by the crate `differential-equations`
//! with events: `simulate FOLDER PYTHON` writes `simulate.md`.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, anyhow, bail};
use breakaway::simulate::limit_cycle::{ExactCycle, exact_cycle};
use breakaway_bench::timed;
use breakaway_core::plant::Base;
use differential_equations::prelude::*;

/// The papers' plant (docs/theory.md, section 1).
const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const RELAYS: [(f64, f64); 2] = [(2.0, 1.5), (1.0, 0.7)];
const REPEATS: usize = 2;

/// Motion between two events: position, velocity, integral of the position.
struct Motion {
    force: f64,
    /// At rest, held by friction (h1 − h2 = f1 in the first of the runs).
    held: bool,
}

impl ODE<f64, [f64; 3]> for Motion {
    fn diff(&self, _t: f64, y: &[f64; 3], dydt: &mut [f64; 3]) {
        *dydt = if self.held { [0.0, 0.0, y[0]] } else { [y[1], (self.force - BASE.c * y[1]) / BASE.b, y[0]] };
    }
}

/// The first of three armed components to cross zero: their margins are above 0 before, and the smallest crosses first.
struct Crossing {
    directions: [f64; 3],
    held: bool,
}

impl Crossing {
    fn margins(&self, y: &[f64; 3]) -> [f64; 3] {
        // Reversal, position, integral of the position.
        let reversal = if self.held { f64::INFINITY } else { -self.directions[0] * y[1] };
        [reversal, -self.directions[1] * y[0], -self.directions[2] * y[2]]
    }
}

/// Ends the integration at the crossing, bisected on the crate's own interpolation. (Its `Event`, version 0.7.0, ends
/// at the start of the step in which these events are. Of several events in one step it reports the one that was
/// added first.)
impl Solout<f64, [f64; 3]> for Crossing {
    fn solout<I>(
        &mut self,
        t_curr: f64,
        t_prev: f64,
        y_curr: &[f64; 3],
        _y_prev: &[f64; 3],
        interpolator: &mut I,
        solution: &mut Solution<f64, [f64; 3]>,
    ) -> ControlFlag<f64, [f64; 3]>
    where
        I: Interpolation<f64, [f64; 3]> + ?Sized,
    {
        let least = |y: &[f64; 3]| self.margins(y).into_iter().fold(f64::INFINITY, f64::min);
        if least(y_curr) >= 0.0 || t_curr <= t_prev {
            return ControlFlag::Continue;
        }
        let (mut before, mut after, mut state) = (t_prev, t_curr, *y_curr);
        while after - before > 1e-14 * after.abs() {
            let middle = 0.5 * (before + after);
            if middle <= before || middle >= after {
                break;
            }
            let Ok(y) = interpolator.interpolate(middle) else { break };
            if least(&y) < 0.0 {
                (after, state) = (middle, y);
            } else {
                before = middle;
            }
        }
        solution.push(after, state);
        ControlFlag::Terminate
    }
}

/// Period and peak after `cycles` cycles, by an explicit Runge–Kutta method (as in `limit_cycle.py`).
fn stepped(h1: f64, h2: f64, cycles: usize, tolerance: f64) -> Result<[f64; 2]> {
    let (mut t, mut y) = (0.0, [-0.3, 0.0, 0.0]);
    let (mut sign_e, mut sign_i, mut direction) = (1.0, 1.0, 1.0);
    let (mut switched, mut extremes) = (Vec::new(), Vec::new());
    let mut events = 0;
    while switched.len() < cycles {
        events += 1;
        if events > 100 * cycles {
            bail!("{events} events up to {t} s: state {y:?}, relays {sign_e}, {sign_i}, direction {direction}");
        }
        let drive = h1 * sign_e + h2 * sign_i;
        let held = y[1] == 0.0 && drive.abs() <= BASE.f1;
        if y[1] == 0.0 {
            direction = drive.signum();
        }
        let motion = Motion { force: drive - BASE.f1 * direction, held };
        let crossing = Crossing { directions: [-direction, sign_e, sign_i], held };
        // A short first step leaves the zero at which the last event was.
        let method = ExplicitRungeKutta::dopri5().rtol(tolerance).atol(1e-3 * tolerance).h0(1e-7);
        let solution = IVP::ode(&motion, t, t + 10.0, y)
            .method(method)
            .solout(Crossing { ..crossing })
            .solve()
            .map_err(|error| anyhow!("{error:?}"))?;
        let (&end, &last) = solution.last().map_err(|error| anyhow!("{error}"))?;
        let margins = crossing.margins(&last);
        let fired = (0..3).min_by(|&i, &j| margins[i].total_cmp(&margins[j])).unwrap_or(0);
        if end <= t || margins[fired].abs() > 1e-6 {
            bail!("no event: at {end} s the margins are {margins:?}");
        }
        (t, y) = (end, last);
        match fired {
            0 => {
                y[1] = 0.0;
                extremes.push(y[0]);
            }
            1 => {
                y[0] = 0.0;
                sign_e = -sign_e;
            }
            _ => {
                y[2] = 0.0;
                sign_i = -sign_i;
                if sign_i > 0.0 {
                    switched.push(t);
                }
            }
        }
    }
    let [.., before, last] = switched[..] else { bail!("fewer than two cycles") };
    let [.., low, high] = extremes[..] else { bail!("fewer than two reversals") };
    Ok([last - before, 0.5 * (high - low).abs()])
}

/// Seconds, period and peak by `host/benches/limit_cycle.py`.
fn scipy(python: &str, h1: f64, h2: f64, cycles: usize) -> Result<[f64; 3]> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../host/benches/limit_cycle.py");
    let words = [script, &h1.to_string(), &h2.to_string(), &cycles.to_string(), &REPEATS.to_string()];
    let output = Command::new(python).args(words).output().with_context(|| python.to_owned())?;
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().map_err(|_| anyhow!("{script}: {}", String::from_utf8_lossy(&output.stderr)))
}

/// The last words of the script.
fn reason(error: &anyhow::Error) -> String {
    let text = error.to_string();
    let line = text.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default();
    line.rsplit(": ").next().unwrap_or_default().to_owned()
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, python] = arguments.as_slice() else { bail!("simulate FOLDER PYTHON") };
    let mut text = String::from(
        "| relays | simulator | time | time over ours | period off by | peak off by |\n|---|---|---|---|---|---|\n",
    );
    for (h1, h2) in RELAYS {
        let (exact, ours) = timed(200, || exact_cycle(BASE, 0.0, h1, h2));
        let exact: ExactCycle = exact.map_err(|reason| anyhow!("{reason}"))?;
        let mut row = |name: &str, seconds: f64, period: f64, peak: f64| {
            writeln!(
                text,
                "| ({h1}, {h2}), {} cycles | {name} | {:.3} ms | {:.1} | {:.0e} | {:.0e} |",
                exact.cycles,
                1e3 * seconds,
                seconds / ours,
                (period / exact.period_s - 1.0).abs(),
                (peak / exact.peak - 1.0).abs()
            )
        };
        row("Breakaway, event-exact", ours, exact.period_s, exact.peak)?;
        for tolerance in [1e-8, 1e-11] {
            let (found, seconds) = timed(REPEATS, || stepped(h1, h2, exact.cycles, tolerance));
            let [period, peak] = found?;
            row(&format!("`differential-equations`, dopri5, rtol {tolerance:.0e}"), seconds, period, peak)?;
        }
        match scipy(python, h1, h2, exact.cycles) {
            Ok([seconds, period, peak]) => row("scipy `solve_ivp`, RK45, rtol 1e-8", seconds, period, peak)?,
            // The script says so where an event fires again where it just did.
            Err(error) => {
                eprintln!("({h1}, {h2}): {error:#}");
                writeln!(
                    text,
                    "| ({h1}, {h2}) | scipy `solve_ivp`, RK45, rtol 1e-8 | ended early: {} | | | |",
                    reason(&error)
                )?;
            }
        }
    }
    println!("{text}");
    fs::write(PathBuf::from(folder).join("simulate.md"), text)?;
    Ok(())
}
