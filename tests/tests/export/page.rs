//! The table of docs/export.md.

use std::path::Path;

use super::Compared;

const START: &str = "<!-- written by the test -->\n";
const END: &str = "<!-- end of what is written -->\n";
const HEAD: &str = "| case | what | windows | our error | MuJoCo's | ratio | lost | approximated |\n|---|---|---|---|---|---|---|---|\n";

/// A row of the table.
pub fn line(row: &Compared) -> String {
    let list = |names: &[String]| if names.is_empty() { "–".to_owned() } else { names.join(", ") };
    format!(
        "| {} | {} | {} | {:.3e} {} | {:.3e} {} | {:.3} | {} | {} |",
        row.name,
        row.what,
        row.windows,
        row.ours,
        row.unit,
        row.theirs,
        row.unit,
        row.theirs / row.ours,
        list(&row.lost),
        list(&row.approximated)
    )
}

/// The page has these rows: cases, what is lost, and the ratios to 0.05.
pub fn check(rows: &[Compared]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/export.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(START).unwrap();
    let (table, after) = rest.split_once(END).unwrap();
    let lines: Vec<String> = rows.iter().map(line).collect();
    if std::env::var_os("BREAKAWAY_BLESS").is_some() {
        let table = format!("\n{HEAD}{}\n\n", lines.join("\n"));
        std::fs::write(&path, format!("{before}{START}{table}{END}{after}")).unwrap();
        return;
    }
    let written: Vec<&str> = table.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert_eq!(written.len(), rows.len(), "docs/export.md has another number of rows");
    for ((written, line), row) in written.iter().zip(&lines).zip(rows) {
        let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
        let (is, should) = (cells(written), cells(line));
        for column in [1, 2, 3, 7, 8] {
            assert_eq!(is[column], should[column], "docs/export.md: {}", row.name);
        }
        let ratio: f64 = is[6].parse().unwrap();
        assert!((ratio - row.theirs / row.ours).abs() < 0.05, "docs/export.md: {}: {line}", row.name);
    }
}
