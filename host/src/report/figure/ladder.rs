//! The ladder: how the simulation error falls as effects are added, down to the noise.

use super::column::Column;
use super::panel::{Entry, Panel, legend, legend_height};
use super::scale::Scale;
use super::sheet::{Anchor, Sheet, text_width, through};
use crate::report::text::{number, quantity};

/// One rung.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Its name: `base model`, `+ Stribeck friction`.
    pub label: String,
    /// Held-out error over 1 s, from a start fitted to its beginning.
    pub open_loop: f64,
    /// Held-out error over 0.4 s.
    pub holdout: f64,
    /// Error over 0.4 s on the fitted data.
    pub fit: f64,
}

/// What is drawn: label, marker, class of the marker, class of the line.
const TRACES: [(&str, char, &str, &str); 3] = [
    ("held-out data, 1 s ahead", '●', "dot-after", "link-after"),
    ("held-out data, 0.4 s", '■', "dot-drive", "link-drive"),
    ("fitted data, 0.4 s", '▲', "dot-muted", "link-muted"),
];

impl Step {
    /// In the order of [`TRACES`].
    const fn values(&self) -> [f64; 3] {
        [self.open_loop, self.holdout, self.fit]
    }
}

/// Draws the ladder; errors and `noise` in the position's `unit`.
pub fn ladder(width: f64, steps: &[Step], noise: f64, unit: &str) -> Sheet {
    let mut entries: Vec<Entry<'_>> = TRACES
        .iter()
        .map(|(label, shape, dot, link)| Entry { class: link, marker: Some((*shape, dot)), label })
        .collect();
    entries.push(Entry { class: "floor", marker: None, label: "noise floor" });
    let head = legend_height(&entries, width - 10.0) + 32.0;
    let (left, right, height) = (62.0, 10.0, if width < 500.0 { 280.0 } else { 310.0 });
    let column = (width - left - right) / steps.len().max(1) as f64;
    let labels: Vec<Vec<String>> = steps.iter().map(|step| wrap(&step.label, column - 6.0)).collect();
    // Crowded columns are numbered, with their names listed below; factors and values would lie on each other.
    let roomy = column > 85.0;
    let lines = if roomy { labels.iter().map(Vec::len).max().unwrap_or(1) } else { steps.len() + 1 };
    let mut sheet = Sheet::new(width, head + height + 14.0 + 17.0 * lines as f64);
    legend(&mut sheet, (2.0, 2.0), &entries, width - 10.0);
    let values = steps.iter().flat_map(Step::values).chain([noise]);
    let panel = Panel {
        left,
        top: head,
        width: width - left - right,
        height,
        x: Scale::Linear(0.0, steps.len().max(1) as f64),
        y: Scale::log_over(values, 1.7, 2.0),
    };
    for i in (1..steps.len()).step_by(2) {
        sheet.rect((panel.px(i as f64), panel.top), (column, height), 0.0, "column");
    }
    // The labels carry the unit, as its prefix changes along the axis.
    for (value, label) in panel.y.ticks(4, unit).0 {
        let y = panel.py(value);
        sheet.line((left, y), (panel.right(), y), "grid");
        sheet.text((left - 6.0, y + 4.0), Anchor::End, "tick", &label);
    }
    sheet.text((2.0, head - 10.0), Anchor::Start, "unit", "simulation error (rms, logarithmic)");
    sheet.line((left, panel.bottom()), (panel.right(), panel.bottom()), "axis");
    floor(&mut sheet, &panel, noise, unit);
    let middle = |i: usize| panel.px(i as f64 + 0.5);
    let names: Vec<&str> = steps.iter().map(|step| step.label.as_str()).collect();
    sheet.columns.push(Column::words("effects added", names.iter().copied()));
    let data = [("x", serde_json::json!(["words", names]).to_string()), ("y", panel.y.attribute(("error", unit)))];
    panel.inside(&mut sheet, &data, |sheet| {
        for (trace, (label, shape, dot, link)) in TRACES.iter().enumerate().rev() {
            let places = || steps.iter().enumerate().map(|(i, step)| (middle(i), panel.py(step.values()[trace])));
            sheet.curve(&through(places()), link, label);
            for place in places().filter(|(_, y)| y.is_finite()) {
                sheet.marker(place, *shape, 6.0, dot);
            }
            let values: Vec<f64> = steps.iter().map(|step| step.values()[trace]).collect();
            sheet.columns.push(Column::new(("rms error", unit), label, &values));
        }
    });
    for (i, step) in steps.iter().enumerate().filter(|(i, _)| roomy || *i == 0 || i + 1 == steps.len()) {
        let y = panel.py(step.open_loop);
        if y.is_finite() {
            let text = quantity(step.open_loop, unit, 2);
            let x = (middle(i) + 12.0).min(panel.right() - 0.5 * text_width(&text) - 4.0);
            sheet.text((x, y - 14.0), Anchor::Middle, "strong halo t-after", &text);
        }
    }
    let row = |row: usize| panel.bottom() + 20.0 + 17.0 * row as f64;
    let class = |i: usize| if i == 0 { "label" } else { "strong" };
    for (i, (step, label)) in steps.iter().zip(&labels).enumerate() {
        if roomy {
            for (line, text) in label.iter().enumerate() {
                sheet.text((middle(i), row(line)), Anchor::Middle, class(i), text);
            }
        } else {
            sheet.text((middle(i), row(0)), Anchor::Middle, class(i), &i.to_string());
            sheet.text((left, row(i + 1)), Anchor::Start, class(i), &format!("{i}: {}", step.label));
        }
    }
    for (i, pair) in steps.windows(2).enumerate().filter(|_| roomy) {
        shrink(&mut sheet, &panel, i as f64 + 1.0, pair);
    }
    sheet
}

/// The noise: a dotted line and a wash below it.
fn floor(sheet: &mut Sheet, panel: &Panel, noise: f64, unit: &str) {
    let y = panel.py(noise);
    if y.is_finite() {
        sheet.rect((panel.left, y), (panel.width, panel.bottom() - y), 0.0, "band-floor");
        sheet.line((panel.left, y), (panel.right(), y), "floor");
        let text = format!("noise {}", quantity(noise, unit, 2));
        sheet.text((panel.right() - 5.0, y + 16.0), Anchor::End, "t-floor", &text);
    }
}

/// By what factor the open-loop error fell, in a pill on the line between two rungs.
fn shrink(sheet: &mut Sheet, panel: &Panel, at: f64, pair: &[Step]) {
    let [before, after] = [&pair[0], &pair[1]].map(|step| step.open_loop);
    let y = 0.5 * (panel.py(before) + panel.py(after));
    if !y.is_finite() {
        return;
    }
    let ratio = before / after;
    let text = if ratio >= 1.0 { format!("÷ {}", number(ratio, 2)) } else { format!("× {}", number(1.0 / ratio, 2)) };
    let wide = text_width(&text) + 12.0;
    sheet.rect((panel.px(at) - 0.5 * wide, y - 12.0), (wide, 24.0), 12.0, "pill");
    sheet.text((panel.px(at), y + 4.5), Anchor::Middle, "strong t-after", &text);
}

fn wrap(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(line) + text_width(word) + 7.0 <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
