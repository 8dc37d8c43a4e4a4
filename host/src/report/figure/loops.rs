//! A plane of two signals against each other: limit cycles in position and velocity.

use super::Ink;
use super::column::Column;
use super::panel::{Entry, Panel, legend, legend_height};
use super::scale::Scale;
use super::sheet::{Sheet, through};

/// One closed or open curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop<'a> {
    /// How it is drawn.
    pub ink: Ink,
    /// What it is; curves of one label share a legend entry.
    pub label: &'a str,
    /// Horizontal values.
    pub x: &'a [f64],
    /// Vertical values.
    pub y: &'a [f64],
}

/// Draws the plane; axes are named by (quantity, unit).
pub fn loops(width: f64, x_axis: (&str, &str), y_axis: (&str, &str), curves: &[Loop<'_>]) -> Sheet {
    let mut entries: Vec<Entry<'_>> = Vec::new();
    for curve in curves {
        if !entries.iter().any(|entry| entry.label == curve.label) {
            entries.push(Entry { class: curve.ink.class(), marker: None, label: curve.label });
        }
    }
    let head = legend_height(&entries, width - 10.0) + 30.0;
    let (left, right) = (52.0, 10.0);
    let height = (0.55 * width).max(260.0);
    let mut sheet = Sheet::new(width, head + height + 42.0);
    legend(&mut sheet, (2.0, 2.0), &entries, width - 10.0);
    let panel = Panel {
        left,
        top: head,
        width: width - left - right,
        height,
        x: Scale::over(curves.iter().flat_map(|c| c.x.iter().copied()), 0.05),
        y: Scale::over(curves.iter().flat_map(|c| c.y.iter().copied()), 0.05),
    };
    for (k, curve) in curves.iter().enumerate() {
        let label = format!("{} {}", curve.label, k + 1);
        sheet.columns.push(Column::new(x_axis, &label, curve.x));
        sheet.columns.push(Column::new(y_axis, &label, curve.y));
    }
    panel.plot(&mut sheet, x_axis, y_axis, true, |sheet| {
        for curve in curves {
            // Both coordinates turn back: every n-th sample, not peaks of one of them.
            let stride = curve.x.len().div_ceil(1500).max(1);
            let points = curve.x.iter().zip(curve.y).step_by(stride);
            let line = through(points.map(|(x, y)| (panel.px(*x), panel.py(*y))));
            sheet.curve(&line, curve.ink.class(), curve.label);
        }
    });
    sheet
}
