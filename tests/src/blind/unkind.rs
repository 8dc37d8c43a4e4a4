//! The rows of unkind worlds as Markdown: per size, per number of effects, per item of the world, and what was said.

use std::fmt::Write as _;

use super::rows::Row;
use super::rules::has;
use super::table::{groups, median, percent};

/// What may be in a world, as the hidden plant writes it; the others are in every one.
const ITEMS: [&str; 4] = ["held", "delay", "sag", "closed"];
const COLUMNS: &str = "cases | right lead name | a wrong name | verdict right | nothing named | given up | seconds, median | worst | of the processor, median | worst";

fn of(rows: &[&Row], what: impl Fn(&Row) -> bool) -> String {
    percent(rows.iter().filter(|row| what(row)).count(), rows.len())
}

/// A line of a table.
fn line(out: &mut String, title: &str, rows: &[&Row]) {
    if rows.is_empty() {
        return;
    }
    let tied = match rows.iter().filter(|row| row.wrong_but_tied()).count() {
        0 => String::new(),
        tied => format!(", tied with the truth {tied}"),
    };
    let seconds = |of: fn(&Row) -> f64| {
        let all: Vec<f64> = rows.iter().map(|row| of(row)).filter(|s| s.is_finite()).collect();
        let worst = all.iter().copied().fold(0.0, f64::max);
        if all.is_empty() { "– | –".to_owned() } else { format!("{:.1} | {worst:.1}", median(all.into_iter())) }
    };
    let _ = writeln!(
        out,
        "| {title} | {} | {} | {}{tied} | {} | {} | {} | {} | {} |",
        rows.len(),
        of(rows, Row::lead_right),
        of(rows, Row::wrong),
        of(rows, Row::verdict_right),
        rows.iter().filter(|row| row.named.is_empty()).count(),
        rows.iter().filter(|row| row.verdict == "given_up").count(),
        seconds(|row| row.seconds),
        seconds(|row| row.processor_s),
    );
}

fn head(out: &mut String, title: &str, first: &str) {
    let rule = "|---".repeat(COLUMNS.split('|').count() + 1);
    let _ = writeln!(out, "\n### {title}\n\n| {first} | {COLUMNS} |\n{rule}|");
}

/// The tables of each unkind setting among the rows.
pub fn markdown(out: &mut String, rows: &[Row]) {
    let unkind: Vec<&Row> = rows.iter().filter(|row| !row.is_kind()).collect();
    for (world, rows) in groups(&unkind, |row| row.world.clone()) {
        let rows: Vec<&Row> = rows;
        let known: Vec<&Row> = rows.iter().copied().filter(|row| row.is_catalogued()).collect();
        let size = |row: &Row| (10.0 * row.size_percent) as u64;
        if !known.is_empty() {
            head(out, &format!("World {world}: effects of the catalogue"), "size");
            for (size, rows) in groups(&known, size) {
                line(out, &format!("{} %", size as f64 / 10.0), &rows);
            }
            head(out, &format!("World {world}: by what is hidden, and by what the world has"), "of these");
            for (count, rows) in groups(&known, |row| row.hidden.len()) {
                line(out, ["no effect", "one effect", "two effects", "three effects"][count.min(3)], &rows);
            }
            for item in ITEMS {
                line(out, item, &known.iter().copied().filter(|row| has(row, item)).collect::<Vec<_>>());
            }
            said(out, &world, &known);
        }
        let clean: Vec<&Row> = rows.iter().copied().filter(|row| row.hidden.is_empty()).collect();
        if !clean.is_empty() {
            let _ = writeln!(
                out,
                "\n### World {world}: clean records\n\nVerdict right: {}; a wrong name: {}; without an answer: {}; {:.1} s of the processor at the median.",
                of(&clean, Row::verdict_right),
                of(&clean, Row::wrong),
                of(&clean, Row::without_answer),
                median(clean.iter().map(|row| row.processor_s))
            );
            said(out, &world, &clean);
        }
        let outside: Vec<&Row> =
            rows.iter().copied().filter(|row| !row.hidden.is_empty() && !row.is_catalogued()).collect();
        if !outside.is_empty() {
            let _ = writeln!(
                out,
                "\n### World {world}: effects outside the catalogue\n\nCalled explained: {}; unknown or partly explained: {}.",
                of(&outside, |row| row.verdict == "explained"),
                of(&outside, Row::verdict_right)
            );
        }
    }
}

/// What was said where lead or verdict is not right.
fn said(out: &mut String, world: &str, rows: &[&Row]) {
    let good = |row: &Row| row.verdict_right() && !row.wrong() && (row.hidden.is_empty() || row.lead_right());
    let not: Vec<&Row> = rows.iter().copied().filter(|row| !good(row)).collect();
    if not.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "\n### World {world}: what was said where it was not right\n\n| hidden | said | size, seed, world |\n|---|---|---|"
    );
    for row in not {
        let or = |names: &[String], nothing: &str| {
            if names.is_empty() { nothing.to_owned() } else { names.join(" + ") }
        };
        let verdict = row.verdict.replace('_', " ");
        let said = if row.named.is_empty() { verdict } else { format!("{} ({verdict})", row.named.join(" + ")) };
        let _ = writeln!(
            out,
            "| {} | {said} | {} %/{}: {} |",
            or(&row.hidden, "(nothing)"),
            row.size_percent,
            row.seed,
            row.drawn
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted by hand: of two rows at 10 % one has a right lead, of two clean ones one verdict is right.
    #[test]
    fn tables_count_what_the_rows_say() {
        let row = |hidden: &str, verdict: &str, named: &str, seconds: f64| {
            let line = format!(
                "suite,{hidden},10,1,{verdict},{named},,0.1,0.1,1,1,1,{seconds},unkind,torque=0.1%@9Hz held=3.0ms,,{}",
                2.0 * seconds
            );
            Row::parse(&line).unwrap()
        };
        let rows = [
            row("cogging", "explained", "cogging", 4.0),
            row("spring", "partly_explained", "dahl", 8.0),
            row("", "nothing_missing", "", 1.0),
            row("", "unknown", "", 1.0),
            row("force_well", "unknown", "", 1.0),
        ];
        let mut out = String::new();
        markdown(&mut out, &rows);
        for line in [
            "| 10 % | 2 | 1/2 (50 %) | 1/2 (50 %) | 1/2 (50 %) | 0 | 0 | 8.0 | 8.0 | 16.0 | 16.0 |",
            "| held | 2 | 1/2 (50 %) | 1/2 (50 %) | 1/2 (50 %) | 0 | 0 | 8.0 | 8.0 | 16.0 | 16.0 |",
            "| spring | dahl (partly explained) | 10 %/1: torque=0.1%@9Hz held=3.0ms |",
            "Verdict right: 1/2 (50 %); a wrong name: 0/2 (0 %); without an answer: 0/2 (0 %); 2.0 s of the processor at the median.",
            "Called explained: 0/1 (0 %); unknown or partly explained: 1/1 (100 %).",
        ] {
            assert!(out.contains(line), "{line}\n{out}");
        }
        assert!(!out.contains("| cogging |"));
    }
}
