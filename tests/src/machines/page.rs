//! docs/machines.md: the sums, every row, and what is known of the machines.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Machine;
use super::alteration::{FRESH, FURTHER};
use super::catalogue::MACHINES;
use super::rows::Row;
use super::score::Score;
use super::splits;
use super::truth::Truth;

/// A machine, a row of it, and the row's score.
type Scored<'a> = (&'a Machine, &'a Row, Score);

/// Scores in the order of the table of sums.
const SCORES: [Score; 4] = [Score::Right, Score::Wrong, Score::Abstains, Score::FalseNothing];

const HEAD: &str = "# Real machines

Recordings of machines that nobody simulated, discovered with nothing told, and judged by what is known of
them. Written on {date}; the rows are of commit {commits} and in [machines.csv](machines.csv). The last
command was

    {command}

It goes on where it was stopped; `--anew` makes the rows again. The recordings are other people's: the
tests find them as tests/src/lib.rs says, and the project holds none.

*Splits.* `all`: every recording, the last third of each held out by the tool. `without 2 of 8`: the second
file is held out, the others are fitted; of more than eight files, every fifth. `half 1`, `third 2`: that
part of the files alone, or of the time of each where there are fewer files. `group`: files of one kind.
The splits *alone* and *altered* have sums of their own below.

*Scores.* Right: the leading name is true of the machine or tied with one that is, and no other name is
false. Wrong: a name is false, with all that is tied with it. Abstains: refused, *unknown*, or true names
without the one that is needed. False nothing: *nothing missing* is the verdict, although something is.
Where nothing is missing, naming nothing is right.

*Errors.* Force residual: what the model leaves of the held-out force, in per cent of the drive. 1 s open
loop: held-out simulation over windows of 1 s. Drive-free curve: a cubic in time, fitted to the position in
such windows without the drive. A model that is further off has learnt nothing from the drive. Arrows lead
from the base model to the final one.
";

/// The tables of the rows. Rows of machines that the catalogue does not have are left out.
///
/// # Errors
/// A name in a row that no effect has.
pub fn tables(rows: &[Row]) -> Result<String, String> {
    let (mut scored, mut harder): (Vec<Scored<'_>>, Vec<Scored<'_>>) = (Vec::new(), Vec::new());
    for machine in MACHINES {
        let hard: Vec<String> = splits::harder(machine).iter().map(ToString::to_string).collect();
        for row in rows.iter().filter(|row| row.machine == machine.name) {
            let own = (machine, row, row.score(machine)?);
            if hard.contains(&row.split) { harder.push(own) } else { scored.push(own) }
        }
    }
    let mut out = String::new();
    // Here and below, writing to a String cannot fail.
    sums(&mut out, &scored);
    made_worse(&mut out, &harder);
    details(&mut out, &scored);
    notes(&mut out, &scored);
    known(&mut out);
    Ok(out)
}

/// Sums over the harder splits, and those of their rows that are wrong.
fn made_worse(out: &mut String, scored: &[Scored<'_>]) {
    if scored.is_empty() {
        return;
    }
    let _ = write!(
        out,
        "\n## Files alone, and recordings made worse\n\n\
         `file 4 alone`: one file of several, up to eight of a machine. The others are all recordings, altered as another\n\
         logger or a cheaper sensor would have it. `mirrored`: drive and position with the other sign. `1 row of 2`: a\n\
         slower log. `held 3 rows`: a position that is read at every third row. `step × 4`: a coarser encoder. `jitter 20 %`:\n\
         stamps that are off by up to a tenth of an interval. `tenths 1 to 6`: a part of each recording. A machine stays\n\
         what it is, so a name that is false of it is wrong here too. The method was changed where such rows were wrong, so\n\
         nobody has kept them unseen. [machines-altered-start.csv](machines-altered-start.csv) has them before the change. The further ones are\n\
         alterations of other sizes, which were first run afterwards: {}. Then the method was changed by them too. The fresh\n\
         ones were first run after that: {}.\n\n\
         | machine | splits | right | wrong | abstains | false nothing |\n|---|---|---|---|---|---|\n",
        FURTHER.map(|alteration| format!("`{alteration}`")).join(", "),
        FRESH.map(|alteration| format!("`{alteration}`")).join(", ")
    );
    for machine in MACHINES {
        let own = scored.iter().filter(|(of, _, score)| of.name == machine.name && *score != Score::NotAsked);
        let own: Vec<Score> = own.map(|(.., score)| *score).collect();
        if !own.is_empty() {
            let _ = writeln!(out, "| {} | {} |", machine.name, counted(&own));
        }
    }
    let all: Vec<Score> = scored.iter().map(|(.., score)| *score).filter(|score| *score != Score::NotAsked).collect();
    let _ = writeln!(out, "| **total** | {} |", counted(&all));
    for (set, alterations) in [("further", FURTHER), ("fresh", FRESH)] {
        let names = alterations.map(|alteration| alteration.to_string());
        let own = scored.iter().filter(|(_, row, score)| names.contains(&row.split) && *score != Score::NotAsked);
        let own: Vec<Score> = own.map(|(.., score)| *score).collect();
        let _ = writeln!(out, "| of these, the {set} ones | {} |", counted(&own));
    }
    out.push('\n');
    for (_, row, score) in scored.iter().filter(|(.., score)| matches!(score, Score::Wrong | Score::FalseNothing)) {
        let names = if row.named.is_empty() {
            String::new()
        } else {
            format!(": {}", row.named.replace('~', " = ").replace('+', ", "))
        };
        let _ = writeln!(out, "- {}, {}: {}{names}.", row.machine, row.split, score.words());
    }
}

/// How many scores there are, and how many of each kind.
fn counted(scores: &[Score]) -> String {
    let of = |wanted: &Score| scores.iter().filter(|score| *score == wanted).count().to_string();
    format!("{} | {}", scores.len(), SCORES.iter().map(of).collect::<Vec<_>>().join(" | "))
}

/// The page, with its day, the command that made its newest rows, and further notes on them.
///
/// # Errors
/// As [`tables`].
pub fn page(rows: &[Row], date: &str, command: &str, remark: &str) -> Result<String, String> {
    let mut commits: Vec<&str> =
        rows.iter().map(|row| row.commit.as_str()).filter(|commit| !commit.is_empty()).collect();
    commits.sort_unstable();
    commits.dedup();
    let head = HEAD.replace("{date}", date).replace("{command}", command).replace("{commits}", &commits.join(", "));
    let remark = if remark.is_empty() { String::new() } else { format!("\n{remark}\n") };
    Ok(format!("{head}{remark}\n{}", tables(rows)?))
}

fn sums(out: &mut String, scored: &[Scored<'_>]) {
    let _ = writeln!(
        out,
        "## Sums\n\n| machine | splits | right | wrong | abstains | false nothing | all recordings |\n|---|---|---|---|---|---|---|"
    );
    let asked: Vec<_> = scored.iter().filter(|(.., score)| *score != Score::NotAsked).collect();
    let counts = |of: &dyn Fn(&Machine) -> bool| {
        let these: Vec<Score> = asked.iter().filter(|(machine, ..)| of(machine)).map(|(.., score)| *score).collect();
        counted(&these)
    };
    let whole: Vec<_> = asked.iter().filter(|(_, row, _)| row.split == "all").collect();
    for machine in MACHINES.iter().filter(|machine| asked.iter().any(|(of, ..)| of.name == machine.name)) {
        let all = whole.iter().find(|(of, ..)| of.name == machine.name).map_or("–", |(.., score)| score.words());
        let _ = writeln!(out, "| {} | {} | {all} |", machine.name, counts(&|of| of.name == machine.name));
    }
    let right = whole.iter().filter(|(.., score)| *score == Score::Right).count();
    let _ = writeln!(out, "| **total** | {} | {right} of {} right |", counts(&|_| true), whole.len());
    let run = |machine: &Machine| scored.iter().any(|(of, row, _)| of.name == machine.name && row.split == "all");
    let missing: Vec<&str> = MACHINES.iter().filter(|machine| !run(machine)).map(|machine| machine.name).collect();
    if !missing.is_empty() {
        let _ = writeln!(out, "\nNo row over all recordings yet: {}.", missing.join(", "));
    }
}

fn details(out: &mut String, scored: &[Scored<'_>]) {
    let _ = writeln!(
        out,
        "\n## Every split\n\n| machine | split | truth | score | verdict | names | found (known) | force residual | 1 s open loop \
         | drive-free curve | seconds |\n|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for (machine, row, score) in scored {
        let truth = match machine.truth {
            Truth::Effects { lead, .. } => lead.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(" or "),
            other => other.words(),
        };
        let names = row.named.replace('~', " = ").replace('+', ", ");
        let force = arrow([row.force_before, row.force_after], |value| format!("{:.1} %", 100.0 * value));
        let open_loop = arrow([row.open_loop_before, row.open_loop_after], number);
        let curve = row.drive_free.map_or_else(|| "–".to_owned(), |value| format!("{} {}", number(value), row.unit));
        let seconds = row.seconds.map_or_else(|| "–".to_owned(), |seconds| format!("{seconds:.1}"));
        let _ = writeln!(
            out,
            "| {} | {} | {truth} | {} | {} | {names} | {} | {force} | {open_loop} | {curve} | {seconds} |",
            row.machine,
            row.split,
            score.words(),
            row.verdict.replace('_', " "),
            beside(machine, row),
        );
    }
    let _ = writeln!(
        out,
        "\n`a = b`: tied, these recordings cannot tell them apart. Errors are in the unit of the drive-free curve's column. *–*: \
         there is none."
    );
}

/// The parameters whose values are known and which the final model has, with what is known.
fn beside(machine: &Machine, row: &Row) -> String {
    let mut cells: Vec<(String, Vec<String>)> = Vec::new();
    for known in machine.known {
        let Some(found) = row.parameter(&known.label()) else { continue };
        let cell = format!("{} {}", known.label(), number(found));
        match cells.iter_mut().find(|(of, _)| *of == cell) {
            Some((_, values)) => values.push(known.value()),
            None => cells.push((cell, vec![known.value()])),
        }
    }
    let cells = cells.into_iter().map(|(cell, values)| format!("{cell} ({})", values.join(", ")));
    cells.collect::<Vec<_>>().join("; ")
}

/// Each refusal once, with the rows that it holds for.
fn notes(out: &mut String, scored: &[Scored<'_>]) {
    let mut notes: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (machine, row, _) in scored.iter().filter(|(_, row, _)| !row.note.is_empty()) {
        notes.entry(row.note.as_str()).or_default().push(format!("{}, {}", machine.name, row.split));
    }
    if notes.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n## What was refused\n");
    for (note, rows) in notes {
        let _ = writeln!(out, "- {note}. Rows: {}.", rows.join("; "));
    }
}

fn known(out: &mut String) {
    let _ = writeln!(
        out,
        "\n## The machines\n\n| machine | what it is | files | drive → position | truth | known values |\n|---|---|---|---|---|---|"
    );
    for machine in MACHINES {
        let columns = machine.columns;
        let select = columns.select.map_or_else(String::new, |select| format!(", `--where {select}`"));
        let values = machine.known.iter().map(|k| format!("{} {} ({})", k.label(), k.value(), k.source));
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} → {}{select} | {} | {} |",
            machine.name,
            machine.title,
            machine.files,
            columns.input.unwrap_or("–"),
            columns.position,
            machine.truth.words(),
            values.collect::<Vec<_>>().join("; ")
        );
    }
}

fn arrow(ends: [Option<f64>; 2], show: impl Fn(f64) -> String) -> String {
    match ends {
        [Some(before), Some(after)] => format!("{} → {}", show(before), show(after)),
        _ => "–".to_owned(),
    }
}

/// Three significant digits.
fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-2..1e4).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = if size == 0.0 { 0.0 } else { (2.0 - size.log10().floor()).clamp(0.0, 5.0) };
    format!("{value:.*}", digits as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(machine: &str, split: &str, verdict: &str, named: &str) -> Row {
        Row {
            machine: machine.into(),
            split: split.into(),
            verdict: verdict.into(),
            named: named.into(),
            ..Row::default()
        }
    }

    /// Sums per machine and in total, and the line of a row with a known parameter beside what was found.
    #[test]
    fn the_tables_hold_sums_and_rows() {
        let emps = Row {
            parameters: "b=2.7;asymmetric_viscous.d=-1.1".into(),
            open_loop_before: Some(3.6e-3),
            open_loop_after: Some(3.84e-4),
            drive_free: Some(5.1e-3),
            unit: "m".into(),
            seconds: Some(4.26),
            ..row("emps", "all", "partly_explained", "asymmetric_viscous~constant_load")
        };
        let rows = [
            emps,
            row("emps", "half 1", "explained", "dahl"),
            Row { note: "no window".into(), ..row("frc-left", "all", "refused", "") },
            row("so101", "all", "no_drive", ""),
            row("emps", "mirrored", "explained", "asymmetric_viscous"),
            row("emps", "held 2 rows", "explained", "asymmetric_viscous"),
            row("flexlink", "file 1 alone", "nothing_missing", ""),
            row("flexlink", "step × 4", "explained", "dahl~lugre"),
        ];
        let text = tables(&rows).unwrap();
        for line in [
            "| emps | 2 | 1 | 1 | 0 | 0 | right |",
            "| frc-left | 1 | 0 | 0 | 1 | 0 | abstains |",
            "| **total** | 3 | 1 | 1 | 1 | 0 | 1 of 2 right |",
            "| emps | all | asymmetric_viscous or constant_load | right | partly explained | asymmetric_viscous = \
             constant_load | b 2.70 (2.706) | – | 3.60e-3 → 3.84e-4 | 5.10e-3 m | 4.3 |",
            "- no window. Rows: frc-left, all.",
            "| flexlink | 2 | 0 | 1 | 0 | 1 |",
            "| **total** | 4 | 2 | 1 | 0 | 1 |\n",
            "| of these, the further ones | 1 | 1 | 0 | 0 | 0 |\n",
            "- flexlink, file 1 alone: false nothing.",
            "- flexlink, step × 4: **wrong**: dahl = lugre.",
            "No row over all recordings yet: laas-sine, laas-speed, xl330,",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
        assert!(tables(&[row("emps", "all", "explained", "magic")]).is_err());
        let numbers = [0.0, 0.25, 72.0, 5789.4, 12345.0, 1e-4].map(number);
        assert_eq!(numbers, ["0", "0.250", "72.0", "5789", "1.23e4", "1.00e-4"]);
    }
}
