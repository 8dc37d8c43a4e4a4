//! The blind matrix as Markdown: per size, per effect, confusion, kinds of experiment, clean records.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use breakaway_hidden::CATALOGUE;

use super::rows::Row;
use super::unkind;

/// The middle of the finite values, NaN of none.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

pub(super) fn percent(part: usize, whole: usize) -> String {
    format!("{part}/{whole} ({:.0} %)", 100.0 * part as f64 / whole.max(1) as f64)
}

pub(super) fn groups<'a, K: Ord>(rows: &[&'a Row], key: impl Fn(&Row) -> K) -> BTreeMap<K, Vec<&'a Row>> {
    let mut groups: BTreeMap<K, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        groups.entry(key(row)).or_default().push(row);
    }
    groups
}

/// How many are wrong, and how many of these list the truth as tied.
fn wrong(rows: &[&Row]) -> String {
    let count = |f: fn(&Row) -> bool| rows.iter().filter(|r| f(r)).count();
    match (count(Row::wrong), count(Row::wrong_but_tied)) {
        (wrong, 0) => wrong.to_string(),
        (wrong, tied) => format!("{wrong}, of which tied with the truth {tied}"),
    }
}

/// Right, wrong, nothing, explained, medians: a line of a table.
fn summary(rows: &[&Row]) -> String {
    let count = |f: &dyn Fn(&Row) -> bool| rows.iter().filter(|r| f(r)).count();
    format!(
        "{} | {} | {} | {} | {:.2} % | {:.2} | {:.3} | {:.1}",
        percent(count(&Row::right), rows.len()),
        wrong(rows),
        count(&|r| r.named.is_empty()),
        count(&|r| r.verdict == "explained"),
        100.0 * median(rows.iter().map(|r| r.parameter_error)),
        median(rows.iter().filter(|r| r.right()).map(|r| r.over_truth)),
        median(rows.iter().filter(|r| r.right()).map(|r| r.shrink)),
        rows.iter().map(|r| r.seconds).filter(|s| s.is_finite()).sum::<f64>() / rows.len().max(1) as f64
    )
}

const COLUMNS: &str = "cases | right | wrong | nothing named | explained | parameter, median error | held-out error over \
                       the truth's own, median | shrink, median | seconds";

fn head(out: &mut String, title: &str, first: &str) {
    let columns = COLUMNS.trim_start_matches("cases | ");
    let rule = "|---".repeat(columns.split('|').count() + 1);
    let _ = writeln!(out, "\n### {title}\n\n| {first} | {columns} |\n{rule}|");
}

/// The tables of the rows, as Markdown.
pub fn markdown(rows: &[Row]) -> String {
    let mut out = String::new();
    kind(&mut out, &rows.iter().filter(|row| row.is_kind()).collect::<Vec<_>>());
    unkind::markdown(&mut out, rows);
    out
}

/// The tables of the kind world.
fn kind(out: &mut String, rows: &[&Row]) {
    let known = |r: &Row| r.is_catalogued();
    let single: Vec<&Row> = rows.iter().copied().filter(|r| known(r) && r.hidden.len() == 1).collect();
    let suite: Vec<&Row> = single.iter().copied().filter(|r| r.experiment == "suite").collect();
    if !suite.is_empty() {
        head(out, "One hidden effect, the suite", "size");
        for (size, rows) in groups(&suite, |r| (10.0 * r.size_percent) as u64) {
            let _ = writeln!(out, "| {} % | {} |", size as f64 / 10.0, summary(&rows));
        }
        effects(out, &suite);
        confusion(out, &suite);
    }
    let other: Vec<&Row> = single.iter().copied().filter(|r| r.experiment != "suite").collect();
    if !other.is_empty() {
        head(out, "Fewer experiments", "experiment, size");
        for ((experiment, size), rows) in groups(&other, |r| (r.experiment.clone(), (10.0 * r.size_percent) as u64)) {
            let _ = writeln!(out, "| {experiment}, {} % | {} |", size as f64 / 10.0, summary(&rows));
        }
    }
    let two: Vec<&Row> = rows.iter().copied().filter(|r| known(r) && r.hidden.len() == 2).collect();
    pairs(out, &two);
    let clean: Vec<&Row> = rows.iter().copied().filter(|r| r.hidden.is_empty()).collect();
    if !clean.is_empty() {
        let named = clean.iter().filter(|r| !r.named.is_empty()).count();
        let _ =
            writeln!(out, "\n### Clean records\n\nA name where nothing is hidden: {}.", percent(named, clean.len()));
    }
    let outside: Vec<&Row> = rows.iter().copied().filter(|r| !r.hidden.is_empty() && !known(r)).collect();
    if !outside.is_empty() {
        let _ = writeln!(
            out,
            "\n### Effects outside the catalogue\n\n| hidden | cases | explained | partly explained | unknown | nothing missing |\n|---|---|---|---|---|---|"
        );
        for (hidden, rows) in groups(&outside, |r| r.hidden.join(" + ")) {
            let of = |verdict: &str| rows.iter().filter(|r| r.verdict == verdict).count();
            let _ = writeln!(
                out,
                "| {hidden} | {} | {} | {} | {} | {} |",
                rows.len(),
                of("explained"),
                of("partly_explained"),
                of("unknown"),
                of("nothing_missing")
            );
        }
    }
}

/// Right of all, per effect and size.
fn effects(out: &mut String, rows: &[&Row]) {
    let sizes: Vec<u64> = groups(rows, |r| (10.0 * r.size_percent) as u64).into_keys().collect();
    let titles: Vec<String> = sizes.iter().map(|s| format!("{} %", *s as f64 / 10.0)).collect();
    let _ = writeln!(
        out,
        "\n### Right of all, per effect\n\n| hidden | {} |\n|---{}|",
        titles.join(" | "),
        "|---".repeat(sizes.len())
    );
    for name in CATALOGUE {
        let cells: Vec<String> = sizes
            .iter()
            .map(|size| {
                let these: Vec<&&Row> =
                    rows.iter().filter(|r| r.hidden[0] == *name && (10.0 * r.size_percent) as u64 == *size).collect();
                format!("{}/{}", these.iter().filter(|r| r.right()).count(), these.len())
            })
            .collect();
        let _ = writeln!(out, "| {name} | {} |", cells.join(" | "));
    }
}

/// What was named where it was not right.
fn confusion(out: &mut String, rows: &[&Row]) {
    let _ =
        writeln!(out, "\n### What was said where it was not right\n\n| hidden | said | size and seed |\n|---|---|---|");
    let not: Vec<&Row> = rows.iter().copied().filter(|r| !r.right()).collect();
    let said = |r: &Row| {
        if r.named.is_empty() { format!("({})", r.verdict.replace('_', " ")) } else { r.named.join(" + ") }
    };
    for ((hidden, said), rows) in groups(&not, |r| (r.hidden.join(" + "), said(r))) {
        let where_: Vec<String> = rows.iter().map(|r| format!("{} %/{}", r.size_percent, r.seed)).collect();
        let _ = writeln!(out, "| {hidden} | {said} | {} |", where_.join(", "));
    }
}

fn pairs(out: &mut String, rows: &[&Row]) {
    if rows.is_empty() {
        return;
    }
    let wrong = rows.iter().filter(|r| r.wrong()).count();
    let both = rows.iter().filter(|r| r.hidden.iter().all(|h| r.named.contains(h))).count();
    let _ = writeln!(
        out,
        "\n### Two hidden effects\n\nBoth named: {}; a wrong one named: {}.",
        percent(both, rows.len()),
        percent(wrong, rows.len())
    );
    confusion(out, rows);
}
