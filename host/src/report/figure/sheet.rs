//! The sheet an SVG is drawn on.

use std::fmt::Write as _;

use super::column::Column;
use super::style::{DARK, FIGURES, LIGHT};
use crate::file::FIGURE_MARK;
use crate::report::text::escape;

/// Where a text is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its beginning.
    Start,
    /// At its middle.
    Middle,
    /// At its end.
    End,
}

/// A drawing of a given size, in pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// The numbers that are drawn, for a table of the figure.
    pub columns: Vec<Column>,
    body: String,
}

/// Mean width of a letter at 13 px, pixels: rather wide, as fonts differ.
const LETTER: f64 = 7.5;

/// About how wide a text comes out, pixels.
pub fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER
}

impl Sheet {
    /// An empty sheet.
    pub const fn new(width: f64, height: f64) -> Self {
        Self { width, height, columns: Vec::new(), body: String::new() }
    }

    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    /// A straight line.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), class: &str) {
        self.path(&format!("M{:.1} {:.1}L{:.1} {:.1}", from.0, from.1, to.0, to.1), class);
    }

    /// A path.
    pub fn path(&mut self, d: &str, class: &str) {
        if !d.is_empty() {
            self.add(format_args!("<path class=\"{class}\" d=\"{d}\"/>"));
        }
    }

    /// A curve that the page's script reads: a path under the name that its values have.
    pub fn curve(&mut self, d: &str, class: &str, label: &str) {
        if !d.is_empty() {
            self.add(format_args!("<path class=\"{class}\" data-label=\"{}\" d=\"{d}\"/>", escape(label)));
        }
    }

    /// What `draw` draws, as one group.
    pub fn group(&mut self, class: &str, draw: impl FnOnce(&mut Self)) {
        self.add(format_args!("<g class=\"{class}\">"));
        draw(self);
        self.add(format_args!("</g>"));
    }

    /// A rectangle; what has no area is left out.
    pub fn rect(&mut self, corner: (f64, f64), size: (f64, f64), radius: f64, class: &str) {
        if size.0 > 0.0 && size.1 > 0.0 {
            let ((x, y), (w, h)) = (corner, size);
            self.add(format_args!(
                "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" rx=\"{radius}\"/>"
            ));
        }
    }

    /// A text on its base line.
    pub fn text(&mut self, at: (f64, f64), anchor: Anchor, class: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.add(format_args!(
            "<text class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            at.0,
            at.1,
            escape(text)
        ));
    }

    /// A marker of radius `r`: `■` square, `▲` triangular, else round.
    pub fn marker(&mut self, at: (f64, f64), shape: char, r: f64, class: &str) {
        let (x, y) = at;
        match shape {
            '■' => self.rect((x - 0.85 * r, y - 0.85 * r), (1.7 * r, 1.7 * r), 0.0, class),
            '▲' => {
                let (top, bottom, left, right) = (y - r, y + 0.8 * r, x - r, x + r);
                self.path(&format!("M{x:.1} {top:.1}L{right:.1} {bottom:.1}L{left:.1} {bottom:.1}Z"), class);
            }
            _ => self.add(format_args!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\"/>")),
        }
    }

    /// What `draw` draws, cut at the edges of the rectangle; with attributes `data-…`.
    pub fn clipped(
        &mut self,
        corner: (f64, f64),
        size: (f64, f64),
        data: &[(&str, String)],
        draw: impl FnOnce(&mut Self),
    ) {
        let ((x, y), (w, h)) = (corner, size);
        let mut attributes = String::new();
        for (name, value) in data {
            // Writing to a String cannot fail.
            let _ = write!(attributes, " data-{name}=\"{}\"", escape(value));
        }
        // A nested svg clips by itself; a clipPath would need an id that is unique on the page.
        self.add(format_args!(
            "<svg class=\"plot\"{attributes} x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" \
             viewBox=\"{x:.1} {y:.1} {w:.1} {h:.1}\">"
        ));
        draw(self);
        self.add(format_args!("</svg>"));
    }

    /// The element; `standalone` with name space, style and background of its own.
    pub fn svg(&self, title: &str, description: &str, standalone: bool) -> String {
        let mut out = String::new();
        // On a page the figure has the page's margins; a file needs its own.
        let pad = if standalone { 14.0 } else { 0.0 };
        let origin = 0.0 - pad;
        let (w, h) = (self.width + 2.0 * pad, self.height + 2.0 * pad);
        let space = if standalone {
            format!(" xmlns=\"http://www.w3.org/2000/svg\" {FIGURE_MARK} width=\"{w:.0}\" height=\"{h:.0}\"")
        } else {
            String::new()
        };
        let label = escape(title);
        let _ = writeln!(
            out,
            "<svg{space} viewBox=\"{origin:.0} {origin:.0} {w:.0} {h:.0}\" role=\"img\" aria-label=\"{label}\">"
        );
        let _ = writeln!(out, "<title>{}</title>\n<desc>{}</desc>", escape(title), escape(description));
        if standalone {
            let _ = writeln!(
                out,
                "<style>svg{{{LIGHT}}}\n@media (prefers-color-scheme:dark){{svg{{{DARK}}}}}\n{FIGURES}</style>\n\
                 <rect class=\"paper\" x=\"{origin:.0}\" y=\"{origin:.0}\" width=\"{w:.0}\" height=\"{h:.0}\"/>"
            );
        }
        out.push_str(&self.body);
        out.push_str("</svg>");
        out
    }
}

/// A path through points in pixels, to a hundredth; it is interrupted where a point is not finite. The page's script reads
/// values back from it: a hundredth is about 1e-4 of a panel. Enlarged a hundred times it is a pixel.
pub fn through(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut d = String::new();
    let mut pen = 'M';
    for (x, y) in points {
        if x.is_finite() && y.is_finite() {
            let _ = write!(d, "{pen}{x:.2} {y:.2}");
            pen = 'L';
        } else {
            pen = 'M';
        }
    }
    d
}
