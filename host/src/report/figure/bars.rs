//! Horizontal bars: shares, before and after.

use super::column::Column;
use super::scale::Scale;
use super::sheet::{Anchor, Sheet};

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar<'a> {
    /// What the row is.
    pub label: &'a str,
    /// Share before, at most 1; below zero counts as nothing.
    pub before: f64,
    /// Share after; `None` if nothing was added.
    pub after: Option<f64>,
}

/// Draws the rows on a scale of 0 to 100 %, which `axis` says what of.
pub fn bars(width: f64, axis: &str, rows: &[Bar<'_>]) -> Sheet {
    let narrow = width < 500.0;
    let two = rows.iter().any(|row| row.after.is_some());
    // A narrow drawing has the labels above the bars, a wide one beside them.
    let (left, row_height) = match (narrow, two) {
        (true, true) => (4.0, 62.0),
        (true, false) => (4.0, 44.0),
        (false, true) => (230.0, 46.0),
        (false, false) => (230.0, 32.0),
    };
    let head = if two { 34.0 } else { 8.0 };
    let span = width - left - 58.0;
    let mut sheet = Sheet::new(width, head + row_height * rows.len() as f64 + 46.0);
    if two {
        sheet.rect((4.0, 6.0), (26.0, 11.0), 0.0, "bar-before");
        sheet.text((36.0, 16.0), Anchor::Start, "label", "before");
        sheet.rect((110.0, 6.0), (26.0, 11.0), 0.0, "bar-after");
        sheet.text((142.0, 16.0), Anchor::Start, "label", "after");
    }
    sheet.columns.push(Column::words("coordinate", rows.iter().map(|row| row.label)));
    let mut share = |name: &str, values: Vec<f64>| sheet.columns.push(Column::new((name, "1"), "", &values));
    share("share before", rows.iter().map(|row| row.before).collect());
    if two {
        share("share after", rows.iter().map(|row| row.after.unwrap_or(f64::NAN)).collect());
    }
    let bottom = head + row_height * rows.len() as f64;
    let ticks = if narrow { 2 } else { 4 };
    let scale = Scale::Linear(0.0, 1.0);
    for i in 0..=ticks {
        let share = i as f64 / ticks as f64;
        let x = left + span * scale.place(share);
        sheet.line((x, head), (x, bottom), "grid");
        let anchor = if narrow && i == 0 { Anchor::Start } else { Anchor::Middle };
        sheet.text((x, bottom + 17.0), anchor, "tick", &format!("{:.0} %", 100.0 * share));
    }
    for (i, row) in rows.iter().enumerate() {
        let top = head + row_height * i as f64;
        let mut y = if narrow {
            sheet.text((left + 2.0, top + 16.0), Anchor::Start, "label", row.label);
            top + 22.0
        } else {
            sheet.text((left - 10.0, top + 0.5 * row_height + 4.5), Anchor::End, "label", row.label);
            top + 6.0
        };
        let values = [(Some(row.before), "bar-before", "t-before"), (row.after, "bar-after", "t-after")];
        for (share, class, ink) in values {
            let Some(share) = share.filter(|share| share.is_finite()) else { continue };
            let length = span * share.clamp(0.0, 1.0);
            sheet.rect((left, y), (length.max(1.5), 14.0), 0.0, class);
            let percent = format!("{:.0} %", 100.0 * share.max(0.0));
            sheet.text((left + length + 7.0, y + 12.0), Anchor::Start, ink, &percent);
            y += 18.0;
        }
    }
    sheet.line((left, head), (left, bottom), "axis");
    sheet.text((left + span, bottom + 37.0), Anchor::End, "unit", axis);
    sheet
}
