//! The page over all machines: which machine misses what, with links to the machines' reports.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::row::Row;
use crate::report::page::{Page, Section, table};
use crate::report::text::{escape, number, quantity};

/// The page; the machines' reports are in folders of their names beside it.
pub fn html(rows: &[Row]) -> String {
    let verdicts = ["explained", "partly_explained", "unknown", "nothing_missing"];
    let with = |verdict: &str| rows.iter().filter(|row| row.verdict.as_deref() == Some(verdict)).count();
    let failed = rows.iter().filter(|row| row.reason.is_some()).count();
    let mut facts: Vec<(String, String)> =
        verdicts.iter().map(|name| (name.replace('_', " "), with(name).to_string())).collect();
    facts.push(("failed".to_owned(), failed.to_string()));
    let seconds: f64 = rows.iter().filter_map(|row| row.seconds).sum();
    facts.push(("time of all discoveries".to_owned(), quantity(seconds, "s", 3)));
    let mut sections = vec![Section::new("Machines", machines(rows))];
    let effects = by_effect(rows);
    if !effects.is_empty() {
        sections.push(Section::new("Who misses what", effects));
    }
    let page = Page { title: "Breakaway fleet".into(), sentence: sentence(rows), facts, sections, ..Page::default() };
    page.html()
}

/// What is said of the whole fleet.
pub fn sentence(rows: &[Row]) -> String {
    let count = |test: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| test(row)).count();
    let named = count(&|row| !row.effects.is_empty());
    let open = count(&|row| row.verdict.as_deref() == Some("unknown"));
    let failed = count(&|row| row.reason.is_some());
    let mut text = format!("{named} of {} machines miss an effect that could be named", rows.len());
    if open > 0 {
        let _ = write!(text, ", {open} something that could not");
    }
    if failed > 0 {
        let _ = write!(text, "; {failed} could not be worked on");
    }
    text + "."
}

fn machines(rows: &[Row]) -> String {
    let columns = [
        ("machine", ""),
        ("verdict", ""),
        ("what is missing", "w"),
        ("error shrinks by", "n"),
        ("error over noise", "n"),
        ("time, s", "n"),
    ];
    let cells = |row: &Row| {
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| number(value, 3));
        let (name, what) = match &row.reason {
            Some(reason) => (escape(&row.machine), escape(reason)),
            None => (
                format!("<a href=\"{}/report.html\">{}</a>", in_address(&row.machine), escape(&row.machine)),
                escape(&row.missing()),
            ),
        };
        let verdict = row.verdict.as_deref().unwrap_or("failed").replace('_', " ");
        vec![name, escape(&verdict), what, number(row.shrink), number(row.noise_factor), number(row.seconds)]
    };
    let rows: Vec<(bool, Vec<String>)> = rows.iter().map(|row| (false, cells(row))).collect();
    let note = "<p class=\"note\">Shrink: held-out error of the base model over that of the improved one, 1 s ahead in open \
                loop. Over noise: what the improved model leaves, from fitted starts, over the position noise.</p>\n";
    table(&columns, &rows) + note
}

fn by_effect(rows: &[Row]) -> String {
    let mut machines = BTreeMap::<&str, Vec<&str>>::new();
    for row in rows {
        // A machine with several lines of cogging is one machine with cogging.
        for effect in row.effects.iter().map(String::as_str).collect::<BTreeSet<_>>() {
            machines.entry(effect).or_default().push(&row.machine);
        }
    }
    let mut list: Vec<_> = machines.into_iter().collect();
    // The most frequent first.
    list.sort_by_key(|(_, machines)| usize::MAX - machines.len());
    let cells = |(effect, machines): &(&str, Vec<&str>)| {
        vec![escape(&effect.replace('_', " ")), machines.len().to_string(), escape(&machines.join(", "))]
    };
    let rows: Vec<(bool, Vec<String>)> = list.iter().map(|row| (false, cells(row))).collect();
    if rows.is_empty() {
        return String::new();
    }
    table(&[("effect", ""), ("machines", "n"), ("which", "w")], &rows)
}

/// A folder's name as part of a relative address: what is not plain is percent-encoded.
fn in_address(name: &str) -> String {
    name.bytes().fold(String::new(), |mut out, byte| {
        if byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte) {
            out.push(byte.into());
        } else {
            // Writing to a String cannot fail.
            let _ = write!(out, "%{byte:02X}");
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One machine of two, though it has the effect twice.
    #[test]
    fn a_machine_counts_once_for_an_effect() {
        let row = |machine: &str, effects: &[&str]| Row {
            machine: machine.into(),
            verdict: Some("explained".into()),
            effects: effects.iter().map(|&effect| effect.into()).collect(),
            ..Row::default()
        };
        let table = by_effect(&[row("a", &["cogging", "cogging"]), row("b", &["stribeck"])]);
        assert!(table.contains("cogging") && !table.contains("a, a") && !table.contains(">2<"), "{table}");
    }

    #[test]
    fn a_link_survives_any_folder_name() {
        let done = Row { machine: "a b<#1>".into(), verdict: Some("explained".into()), ..Row::default() };
        let page = html(&[done, Row::failed("c", "no <recordings>")]);
        assert!(page.contains("href=\"a%20b%3C%231%3E/report.html\">a b&lt;#1&gt;</a>"));
        assert!(page.contains("no &lt;recordings&gt;") && !page.contains("href=\"c/"));
        assert!(page.contains("0 of 2 machines miss an effect that could be named; 1 could not be worked on."));
    }
}
