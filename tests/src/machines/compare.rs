//! What several programs say of the same machines, side by side, by the same rule.

use std::fmt::Write as _;

use super::catalogue::MACHINES;
use super::rows::Row;
use super::score::Score;
use super::splits::Split;

/// A program and its rows.
#[derive(Clone, Debug)]
pub struct Program {
    /// Its name, for the head of its column.
    pub name: String,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// The table over all recordings of each machine, and the sums.
///
/// # Errors
/// A name in a row that no effect has.
pub fn table(programs: &[Program]) -> Result<String, String> {
    let all = Split::All.to_string();
    let heads: Vec<&str> = programs.iter().map(|program| program.name.as_str()).collect();
    let mut out = format!("| machine | truth | {} |\n|---|---{}|\n", heads.join(" | "), "|---".repeat(heads.len()));
    let mut scores: Vec<Vec<Score>> = vec![Vec::new(); programs.len()];
    for machine in MACHINES {
        let mut cells = Vec::new();
        for (program, scores) in programs.iter().zip(&mut scores) {
            let row = program.rows.iter().find(|row| row.machine == machine.name && row.split == all);
            let Some(row) = row else {
                cells.push("–".to_owned());
                continue;
            };
            let score = row.score(machine)?;
            let verdict = row.verdict.replace('_', " ");
            let names = if row.named.is_empty() { verdict } else { row.named.replace('~', " = ").replace('+', ", ") };
            cells.push(if score == Score::NotAsked { names } else { format!("{}: {names}", score.words()) });
            scores.push(score);
        }
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {} | {} | {} |", machine.name, machine.truth.words(), cells.join(" | "));
    }
    let sums = scores.iter().map(|scores| {
        let count = |of| scores.iter().filter(|score| **score == of).count();
        let silent = count(Score::Abstains) + count(Score::FalseNothing);
        format!("{} right, {} wrong, {silent} without the name", count(Score::Right), count(Score::Wrong))
    });
    let _ = writeln!(out, "| **sum** | | {} |", sums.collect::<Vec<_>>().join(" | "));
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of each program in one line, only those of the split `all`, and the sums.
    #[test]
    fn programs_stand_side_by_side() {
        let row = |machine: &str, split: &str, verdict: &str, named: &str| Row {
            machine: machine.into(),
            split: split.into(),
            verdict: verdict.into(),
            named: named.into(),
            ..Row::default()
        };
        let ours =
            vec![row("emps", "half 1", "explained", "dahl"), row("emps", "all", "explained", "asymmetric_viscous")];
        let theirs = vec![row("emps", "all", "explained", "stribeck"), row("hsm150", "all", "unknown", "")];
        let program = |name: &str, rows| Program { name: name.into(), rows };
        let text = table(&[program("Ours", ours), program("Theirs", theirs)]).unwrap();
        for line in [
            "| machine | truth | Ours | Theirs |",
            "with asymmetric_viscous; also cogging | right: asymmetric_viscous | **wrong**: stribeck |",
            "| hsm150 | constant_load; also asymmetric_viscous, cogging | – | abstains: unknown |",
            "| **sum** | | 1 right, 0 wrong, 0 without the name | 0 right, 1 wrong, 1 without the name |",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
    }
}
