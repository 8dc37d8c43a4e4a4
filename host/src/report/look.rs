//! What was seen in a log, for people: a table of its channels, a drawing, faults, and the command that follows.

use std::fmt::Write as _;

use super::figure::{Figure, Ink, Series, Strip, stack};
use super::text::number;
use crate::look::{Guess, Look, Summary};
use crate::recording::{ReadOptions, Recording};

/// Channels that are listed; a log of a robot may have thousands.
const LISTED: usize = 60;
/// Characters of a channel's line, and of a drawing.
const LINE: usize = 16;
const WIDE: usize = 72;
/// Rows of characters of a drawing, each of four dots.
const HIGH: usize = 4;
/// The characters of a line, from low to high.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The bits of the dots of a character of Braille: left column from the top, then the right one.
const DOTS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

/// The page of one file.
pub fn page(look: &Look) -> String {
    let mut text = format!("{}: {}, {} channels\n\n", look.file, look.format, look.channels.len());
    // Writing to a String cannot fail.
    let guessed = |name: &str| {
        [&look.guesses.time, &look.guesses.drive, &look.guesses.position]
            .into_iter()
            .zip(["time", "drive", "position"])
            .find_map(|(guess, role)| guess.as_ref().filter(|guess| guess.channel == name).map(|_| role))
    };
    let width =
        look.channels.iter().take(LISTED).map(|channel| channel.name.chars().count()).max().unwrap_or(0).min(48);
    for channel in look.channels.iter().take(LISTED) {
        let _ = writeln!(text, "{}", line(channel, width, guessed(&channel.name)));
    }
    if look.channels.len() > LISTED {
        let _ = writeln!(text, "  and {} more; --json lists all", look.channels.len() - LISTED);
    }
    for passed_over in look.passed_over.iter().take(8) {
        let _ = writeln!(text, "  not read: {passed_over}");
    }
    if look.passed_over.len() > 8 {
        let _ = writeln!(text, "  not read: {} more", look.passed_over.len() - 8);
    }
    text.push('\n');
    let mut role = |name: &str, guess: &Option<Guess>, none: &str| {
        let _ = match guess {
            Some(Guess { channel, reason }) => writeln!(text, "{name:<9} {channel}: {reason}"),
            None => writeln!(text, "{name:<9} {none}"),
        };
    };
    let none = match (look.guesses.stamped, look.options.fs_hz) {
        (_, Some(_)) => "counted from the rows, by --fs",
        (true, None) => "the file stamps each row itself",
        (false, None) => "not found; name it with --time, or give the rate with --fs",
    };
    role("time", &look.guesses.time, none);
    role("drive", &look.guesses.drive, "not found; name it with --input");
    role("position", &look.guesses.position, "not found; name it with --position");
    if let Some(recording) = &look.recording {
        let timing = recording.timing();
        let length = recording.t.last().zip(recording.t.first()).map_or(0.0, |(last, first)| last - first);
        let rate = if timing.median_s > 0.0 { 1.0 / timing.median_s } else { 0.0 };
        let _ = writeln!(text, "\n{} rows, {} s at {} Hz", recording.t.len(), number(length, 4), number(rate, 4));
        for (name, values) in [("position", &recording.x), ("drive", &recording.u)] {
            let _ = write!(text, "\n{}", drawing(name, values));
        }
    }
    text.push('\n');
    if look.faults.is_empty() {
        text.push_str("nothing is wrong with it\n");
    }
    for fault in &look.faults {
        let share = fault.share.map_or_else(String::new, |share| format!(" ({} of the rows)", percent(share)));
        let _ = writeln!(text, "fault{share}: {}", fault.text);
    }
    for hint in &look.hints {
        let _ = writeln!(text, "hint: {hint}");
    }
    if let Some(command) = command(look) {
        let _ = writeln!(text, "\n{command}");
    }
    text
}

fn percent(share: f64) -> String {
    if 0.0 < share && share < 0.001 { "< 0.1 %".to_owned() } else { format!("{:.1} %", 100.0 * share) }
}

/// The line of a channel.
fn line(channel: &Summary, width: usize, role: Option<&str>) -> String {
    let Summary { name, unit, rows, rate_hz, range, texts, drawn } = channel;
    let rate = rate_hz.map_or_else(String::new, |rate| format!("{} Hz", number(rate, 4)));
    let what = match range {
        Some((low, high)) => {
            let unit = unit.as_deref().map_or_else(String::new, |unit| format!(" {unit}"));
            format!("{} … {}{unit}", number(*low, 4), number(*high, 4))
        }
        None => format!("text: {}", texts.join(", ")),
    };
    let role = role.map_or_else(String::new, |role| format!("  ← {role}"));
    let plain: String = name.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    format!("  {plain:<width$} {rows:>9} {rate:>11}  {:<LINE$}  {what}{role}", sparkline(drawn))
}

/// The means of `count` parts of some numbers.
fn parts(values: &[f64], count: usize) -> Vec<f64> {
    let count = count.min(values.len());
    let part = |k: usize| &values[k * values.len() / count..(k + 1) * values.len() / count];
    (0..count).map(|k| part(k).iter().sum::<f64>() / part(k).len() as f64).collect()
}

/// Values as shares of their range, 0 to 1.
fn shares(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    values.iter().map(move |value| if high > low { (value - low) / (high - low) } else { 0.5 })
}

/// A line of bars.
fn sparkline(values: &[f64]) -> String {
    let parts = parts(values, LINE);
    let bar = |share: f64| BARS[((share * 8.0) as usize).min(7)];
    shares(&parts).map(bar).collect()
}

/// A drawing in dots of Braille, two in a character side by side and four on top of each other, with its range.
fn drawing(name: &str, values: &[f64]) -> String {
    let (columns, rows) = (2 * WIDE, 4 * HIGH);
    let mut cells = vec![vec![0_u8; WIDE]; HIGH];
    let heights: Vec<usize> =
        shares(values).map(|share| ((1.0 - share) * (rows - 1) as f64).round() as usize).collect();
    for column in 0..columns.min(heights.len()) {
        let count = columns.min(heights.len());
        let part = &heights[column * heights.len() / count..((column + 1) * heights.len() / count)];
        let (Some(top), Some(bottom)) = (part.iter().min(), part.iter().max()) else { continue };
        for row in *top..=*bottom {
            cells[row / 4][column / 2] |= DOTS[column % 2][row % 4];
        }
    }
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let mut text = String::new();
    for (row, cells) in cells.iter().enumerate() {
        let label = match row {
            0 => number(high, 4),
            row if row + 1 == HIGH => number(low, 4),
            row if row == HIGH / 2 => name.to_owned(),
            _ => String::new(),
        };
        let dots: String = cells.iter().filter_map(|cell| char::from_u32(0x2800 + u32::from(*cell))).collect();
        let _ = writeln!(text, "{label:>10} {dots}");
    }
    text
}

/// Drive and position over time.
pub fn figure(look: &Look, recording: &Recording) -> Figure {
    let Recording { t, u, x, units, .. } = recording;
    let first = t.first().copied().unwrap_or(0.0);
    let t: Vec<f64> = t.iter().map(|t| t - first).collect();
    let strip = |quantity, unit, ink, y, held| Strip {
        quantity,
        unit,
        height: 180.0,
        series: vec![Series { ink, label: quantity, y }],
        band: None,
        held,
    };
    let caption = "Position and drive as the file has them, from its first row on.";
    Figure::new(look.file.clone(), caption, |width| {
        let position = strip("position", &units.x, Ink::Measured, x, false);
        stack(width, &t, &[position, strip("drive", &units.u, Ink::Drive, u, true)])
    })
}

/// The command that identifies the file; `None` where drive or position is not known.
pub fn command(look: &Look) -> Option<String> {
    let (drive, position) = (look.guesses.drive.as_ref()?, look.guesses.position.as_ref()?);
    let mut words = vec!["breakaway identify".to_owned(), quoted(&look.file)];
    let mut flag = |flag: &str, value: &str| words.push(format!("{flag} {}", quoted(value)));
    let ReadOptions { time, time_unit, fs_hz, encoder_step, counts_per_turn, window_s, wrap, select, dbc, .. } =
        &look.options;
    if let Some(time) = time {
        flag("--time", time);
    }
    flag("--input", &drive.channel);
    flag("--position", &position.channel);
    let numbers = [("--fs", *fs_hz), ("--encoder-step", *encoder_step), ("--counts-per-turn", *counts_per_turn)];
    let window =
        window_s.map_or([None, None], |(from, to)| [Some(from), Some(to)].map(|end| end.filter(|end| end.is_finite())));
    for (name, value) in numbers.into_iter().chain([("--from", window[0]), ("--to", window[1])]) {
        if let Some(value) = value {
            flag(name, &value.to_string());
        }
    }
    if let Some(unit) = time_unit {
        flag("--time-unit", &unit.to_string());
    }
    if let Some(wrap) = wrap {
        flag("--wrap", &wrap.to_string());
    }
    if let Some(dbc) = dbc {
        flag("--dbc", &dbc.display().to_string());
    }
    for condition in select {
        flag("--where", &condition.to_string());
    }
    Some(words.join(" "))
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_./:=@%+-".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}
