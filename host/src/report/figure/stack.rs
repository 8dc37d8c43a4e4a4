//! Signals over one time axis, in strips under each other: measured, simulated, their difference, the drive.

use super::Ink;
use super::column::Column;
use super::decimate::peaks;
use super::panel::{Entry, Panel, legend, legend_height};
use super::scale::Scale;
use super::sheet::{Sheet, through};

/// Most points of a line in a wide drawing.
const MOST_POINTS: usize = 2000;

/// One line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series<'a> {
    /// How it is drawn.
    pub ink: Ink,
    /// What it is, for the legend.
    pub label: &'a str,
    /// Its values, one per time.
    pub y: &'a [f64],
}

/// One strip.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip<'a> {
    /// The quantity.
    pub quantity: &'a str,
    /// Its unit.
    pub unit: &'a str,
    /// Height of the graph, pixels.
    pub height: f64,
    /// Its lines; the first is drawn first.
    pub series: Vec<Series<'a>>,
    /// A band ±σ around zero: the noise.
    pub band: Option<f64>,
    /// Whether values are held from sample to sample, as a drive is.
    pub held: bool,
}

/// Draws strips over the time `t` (s).
pub fn stack(width: f64, t: &[f64], strips: &[Strip<'_>]) -> Sheet {
    stack_over(width, ("time", "s"), t, strips)
}

/// Draws strips over `t`, which is the quantity and unit of `x_axis`.
pub fn stack_over(width: f64, x_axis: (&str, &str), t: &[f64], strips: &[Strip<'_>]) -> Sheet {
    let mut entries: Vec<Entry<'_>> = Vec::new();
    for series in strips.iter().flat_map(|strip| &strip.series) {
        if !entries.iter().any(|entry| entry.label == series.label) {
            entries.push(Entry { class: series.ink.class(), marker: None, label: series.label });
        }
    }
    let (left, right, gap) = (52.0, 10.0, 40.0);
    let inner = width - left - right;
    let head = legend_height(&entries, width - 10.0) + 30.0;
    let heights: f64 = strips.iter().map(|strip| strip.height).sum();
    let gaps = gap * strips.len().saturating_sub(1) as f64;
    let mut sheet = Sheet::new(width, head + heights + gaps + 42.0);
    legend(&mut sheet, (2.0, 2.0), &entries, width - 10.0);
    let x = Scale::over(t.iter().copied(), 0.0);
    sheet.columns.push(Column::new(x_axis, "", t));
    let mut top = head;
    for (i, strip) in strips.iter().enumerate() {
        let values = strip.series.iter().flat_map(|series| series.y.iter().copied());
        let y = Scale::over(values.chain(strip.band.iter().flat_map(|s| [-*s, *s])), 0.07);
        let panel = Panel { left, top, width: inner, height: strip.height, x, y };
        for series in &strip.series {
            let label = if series.label == strip.quantity { "" } else { series.label };
            sheet.columns.push(Column::new((strip.quantity, strip.unit), label, series.y));
        }
        let (labels, y_axis) = (i + 1 == strips.len(), (strip.quantity, strip.unit));
        panel.plot(&mut sheet, x_axis, y_axis, labels, |sheet| {
            if let Some(sigma) = strip.band {
                let (upper, lower) = (panel.py(sigma), panel.py(-sigma));
                sheet.rect((panel.left, upper), (panel.width, lower - upper), 0.0, "band-floor");
            }
            for series in &strip.series {
                sheet.curve(&trace(&panel, t, series.y, strip.held), series.ink.class(), series.label);
            }
            // Its edges once more on top: a residual that is all noise would hide the band.
            for edge in strip.band.iter().flat_map(|sigma| [*sigma, -*sigma]) {
                let y = panel.py(edge);
                sheet.line((panel.left, y), (panel.right(), y), "edge");
            }
        });
        top += strip.height + gap;
    }
    sheet
}

fn trace(panel: &Panel, t: &[f64], y: &[f64], held: bool) -> String {
    let most = if panel.width < 500.0 { MOST_POINTS / 2 } else { MOST_POINTS };
    let kept = peaks(&y[..y.len().min(t.len())], most);
    let point = |k: usize| (panel.px(t[k]), panel.py(y[k]));
    if !held {
        return through(kept.into_iter().map(point));
    }
    let mut last: Option<(f64, f64)> = None;
    let steps = kept.into_iter().flat_map(|k| {
        let (x, y) = point(k);
        // A relay holds its level for hundreds of samples: those in between need no point.
        let corner = last.filter(|(_, before)| *before != y).map(|(_, before)| (x, before));
        let new = last.is_none_or(|(_, before)| before != y) || k + 1 == t.len();
        last = Some((x, y));
        corner.into_iter().chain(new.then_some((x, y)))
    });
    through(steps.collect::<Vec<_>>())
}
