//! docs/mujoco.md: the sums per scenario, and what was said where it was not right.

use std::fmt::Write as _;

use super::row::Row;
use crate::machines::score::Score;

/// Scores in the order of the table.
const SCORES: [Score; 4] = [Score::Right, Score::Wrong, Score::Abstains, Score::FalseNothing];

const HEAD: &str = "# Machines of MuJoCo

A second world beside the [blind tests](blind.md), whose dynamics are not ours: MuJoCo moves the bodies, joints, limits, springs and fluids. Written on {date}; the rows are of commit {commits} and in [mujoco.csv](mujoco.csv). The last command was

    {command}

It goes on where it was stopped; `--anew` makes the rows again. `tests/mujoco/machines` draws each machine by its scenario and seed. What is missing makes 4 to 25 % of the largest drive, and a random torque .05 to 1 % of it. The rate is 250 Hz to 2 kHz, with jitter in half of the sessions. The encoder has 2048 to 65 536 counts. A session has four recordings of 10 s to 18 s, with drives such as people use: chirps, steps, staircases, multisines, or a controller that follows moves. The tool gets the recordings, and holds out the last third of each.

A session is scored [as the real machines are](machines.md). Of two missing effects one must lead, and nothing false may be named; the last column counts those without a name. Seeds 201 and 202 were looked at while the effect `end_stop` was made. Of seeds 203 and 204 only the sessions with stops were, before their rows were made. Where the catalogue has no name for what is missing, *unknown* and *partly explained* without a false name are right.
";

/// The table and the list.
///
/// # Errors
/// A name in a row that no effect has.
pub fn tables(rows: &[Row]) -> Result<String, String> {
    let scores = rows.iter().map(Row::score).collect::<Result<Vec<_>, _>>()?;
    let scored: Vec<(&Row, Score)> = rows.iter().zip(scores).collect();
    let mut out = String::from(
        "| scenario | missing | sessions | right | wrong | abstains | false nothing | effects without a name |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut scenarios: Vec<&str> = rows.iter().map(|row| row.scenario.as_str()).collect();
    scenarios.sort_unstable();
    scenarios.dedup();
    for scenario in scenarios {
        let own: Vec<_> = scored.iter().copied().filter(|(row, _)| row.scenario == scenario).collect();
        let Some((first, _)) = own.first() else { continue };
        let _ = writeln!(out, "| {scenario} | {} | {} |", missing(first), counted(&own)?);
    }
    let _ = writeln!(out, "| **total** | | {} |", counted(&scored)?);
    out.push_str("\n## What was said where it was not right\n\n| session | missing | size | said | score |\n|---|---|---|---|---|\n");
    for (row, score) in scored.iter().filter(|(_, score)| *score != Score::Right) {
        let names = row.named.replace('~', " = ").replace('+', ", ");
        let (said, size) = (row.verdict.replace('_', " "), row.size_percent);
        let said = if names.is_empty() { said } else { format!("{names} ({said})") };
        let _ = writeln!(
            out,
            "| {}-{} | {} | {size} % | {said} | {} |",
            row.scenario,
            row.seed,
            missing(row),
            score.words()
        );
    }
    Ok(out)
}

/// What is missing, in words.
fn missing(row: &Row) -> String {
    match (row.lead.as_str(), row.outside) {
        ("", true) => "outside the catalogue".to_owned(),
        ("", false) => "nothing".to_owned(),
        (lead, _) => lead.replace('~', " or ").replace('+', ", "),
    }
}

fn counted(scored: &[(&Row, Score)]) -> Result<String, String> {
    let of = |wanted: &Score| scored.iter().filter(|(_, score)| score == wanted).count().to_string();
    let unnamed = scored.iter().map(|(row, _)| Ok(row.unnamed()?.len())).sum::<Result<usize, String>>()?;
    Ok(format!("{} | {} | {unnamed}", scored.len(), SCORES.iter().map(of).collect::<Vec<_>>().join(" | ")))
}

/// The page, with its day and the command that made its newest rows.
///
/// # Errors
/// As [`tables`].
pub fn page(rows: &[Row], date: &str, command: &str) -> Result<String, String> {
    let mut commits: Vec<&str> = rows.iter().map(|row| row.commit.as_str()).collect();
    commits.sort_unstable();
    commits.dedup();
    let head = HEAD.replace("{date}", date).replace("{command}", command).replace("{commits}", &commits.join(", "));
    Ok(format!("{head}\n{}", tables(rows)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted by hand.
    #[test]
    fn the_table_counts_what_the_rows_say() {
        let row = |scenario: &str, seed, lead: &str, verdict: &str, named: &str| Row {
            scenario: scenario.into(),
            seed,
            lead: lead.into(),
            verdict: verdict.into(),
            named: named.into(),
            size_percent: 9.5,
            ..Row::default()
        };
        let rows = [
            row("Gravity", 1, "gravity_load", "explained", "gravity_load"),
            row("Gravity", 2, "gravity_load", "explained", "dahl~lugre"),
            row("Plain", 1, "", "nothing_missing", ""),
        ];
        let page = page(&rows, "2026-01-01", "cargo xtask mujoco").unwrap();
        for line in [
            "| Gravity | gravity_load | 2 | 1 | 1 | 0 | 0 | 1 |",
            "| Plain | nothing | 1 | 1 | 0 | 0 | 0 | 0 |",
            "| **total** | | 3 | 2 | 1 | 0 | 0 | 1 |",
            "| Gravity-2 | gravity_load | 9.5 % | dahl = lugre (explained) | **wrong** |",
        ] {
            assert!(page.contains(line), "{line}\n{page}");
        }
    }
}
