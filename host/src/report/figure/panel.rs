//! A panel: the rectangle of one graph on a sheet, with its axes; and the legend.

use super::scale::Scale;
use super::sheet::{Anchor, Sheet, text_width};

/// The rectangle of one graph.
#[derive(Clone, Copy, Debug)]
pub struct Panel {
    /// Left edge, pixels.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// Horizontal scale.
    pub x: Scale,
    /// Vertical scale.
    pub y: Scale,
}

impl Panel {
    /// Right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }
    /// Lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }
    /// Pixel of a value, horizontally. Far outside is cut, as renderers lose precision there.
    pub fn px(&self, value: f64) -> f64 {
        self.left + self.width * clamp(self.x.place(value))
    }
    /// Pixel of a value, vertically.
    pub fn py(&self, value: f64) -> f64 {
        self.bottom() - self.height * clamp(self.y.place(value))
    }

    /// Draws axes, and within the rectangle. The axes are named by (quantity, unit); those of x have labels, or the panel
    /// below has them.
    pub fn plot(
        &self,
        sheet: &mut Sheet,
        x: (&str, &str),
        y: (&str, &str),
        labels: bool,
        draw: impl FnOnce(&mut Sheet),
    ) {
        let data = [("x", self.x.attribute(x)), ("y", self.y.attribute(y))];
        sheet.group("panel", |sheet| {
            self.x_axis(sheet, x.0, x.1, labels);
            self.y_axis(sheet, y.0, y.1);
            self.inside(sheet, &data, draw);
        });
    }

    /// Draws within the rectangle; `data` says what its edges stand for, by axis.
    pub fn inside(&self, sheet: &mut Sheet, data: &[(&str, String)], draw: impl FnOnce(&mut Sheet)) {
        sheet.clipped((self.left, self.top - 2.0), (self.width, self.height + 4.0), data, draw);
    }

    /// Horizontal grid lines with their labels on the left, and the quantity above the upper left corner.
    fn y_axis(&self, sheet: &mut Sheet, quantity: &str, unit: &str) {
        let (ticks, unit) = self.y.ticks(((self.height / 45.0) as usize).max(3), unit);
        sheet.group("y-ticks", |sheet| {
            for (value, label) in ticks {
                let y = self.py(value);
                let class = if value == 0.0 && matches!(self.y, Scale::Linear(..)) { "axis" } else { "grid" };
                sheet.line((self.left, y), (self.right(), y), class);
                sheet.text((self.left - 6.0, y + 4.0), Anchor::End, "tick", &label);
            }
        });
        sheet.text((self.left, self.top - 9.0), Anchor::Start, "unit", &labelled(quantity, &unit));
    }

    /// Ticks and labels below, and the quantity under them at the right.
    fn x_axis(&self, sheet: &mut Sheet, quantity: &str, unit: &str, labels: bool) {
        let (ticks, unit) = self.x.ticks((self.width / 75.0) as usize, unit);
        let last = ticks.len();
        sheet.group("x-ticks", |sheet| {
            for (i, (value, label)) in ticks.into_iter().enumerate() {
                let x = self.px(value);
                sheet.line((x, self.top), (x, self.bottom()), "grid");
                if labels {
                    let anchor = if i + 1 == last && x > self.right() - 8.0 { Anchor::End } else { Anchor::Middle };
                    sheet.text((x, self.bottom() + 17.0), anchor, "tick", &label);
                }
            }
        });
        sheet.line((self.left, self.bottom()), (self.right(), self.bottom()), "axis");
        if labels {
            sheet.text((self.right(), self.bottom() + 35.0), Anchor::End, "unit", &labelled(quantity, &unit));
        }
    }
}

/// `quantity (unit)`.
fn labelled(quantity: &str, unit: &str) -> String {
    if unit.is_empty() { quantity.to_owned() } else { format!("{quantity} ({unit})") }
}

fn clamp(place: f64) -> f64 {
    if place.is_finite() { place.clamp(-20.0, 20.0) } else { f64::NAN }
}

/// One entry of a legend: what is drawn (a line's class, or a marker and its line), and the text.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    /// Class of the stroke.
    pub class: &'a str,
    /// Marker and its class.
    pub marker: Option<(char, &'a str)>,
    /// What it stands for.
    pub label: &'a str,
}

/// Height of a line of the legend, pixels.
const ROW: f64 = 21.0;

fn places(entries: &[Entry<'_>], width: f64) -> Vec<(f64, f64)> {
    let (mut x, mut row) = (0.0, 0.0);
    entries
        .iter()
        .map(|entry| {
            let wide = 40.0 + text_width(entry.label) + 18.0;
            if x > 0.0 && x + wide - 18.0 > width {
                (x, row) = (0.0, row + 1.0);
            }
            let place = (x, row);
            x += wide;
            place
        })
        .collect()
}

/// Height the legend takes.
pub fn legend_height(entries: &[Entry<'_>], width: f64) -> f64 {
    places(entries, width).last().map_or(0.0, |(_, row)| ROW * (row + 1.0))
}

/// Draws the legend, left and top at `corner`.
pub fn legend(sheet: &mut Sheet, corner: (f64, f64), entries: &[Entry<'_>], width: f64) {
    for (entry, (x, row)) in entries.iter().zip(places(entries, width)) {
        let (x, y) = (corner.0 + x, corner.1 + ROW * row + 10.0);
        sheet.line((x, y), (x + 32.0, y), entry.class);
        if let Some((shape, class)) = entry.marker {
            sheet.marker((x + 16.0, y), shape, 6.0, class);
        }
        sheet.text((x + 39.0, y + 4.5), Anchor::Start, "label", entry.label);
    }
}
