//! Figures as SVG that follows the reader's light or dark setting.

mod bars;
mod bins;
mod bode;
mod column;
mod decimate;
mod fold;
mod ladder;
mod loops;
mod panel;
#[cfg(feature = "command")]
mod raster;
mod scale;
mod sheet;
mod stack;
mod style;

pub use bars::{Bar, bars};
pub use bins::bins;
pub use bode::{Reading, bode};
pub use column::Column;
pub use fold::fold;
pub use ladder::{Step, ladder};
pub use loops::{Loop, loops};
#[cfg(feature = "command")]
pub use raster::RasterError;
pub use scale::Scale;
pub use sheet::Sheet;
pub use stack::{Series, Strip, stack, stack_over};
pub use style::{DARK, FIGURES, LIGHT};

/// Width of a drawing for a page, pixels.
pub const WIDE: f64 = 800.0;
/// Width of a drawing for a phone of 390 pixels.
pub const NARROW: f64 = 358.0;

/// How a line is inked: each has a colour and a dash pattern of its own, so that neither carries the meaning alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Measured: broad and pale, the models are drawn on it.
    Measured,
    /// The base model: dashed.
    Before,
    /// The final model: solid.
    After,
    /// The applied drive, and other quantities beside the subject.
    Drive,
    /// The noise: dotted.
    Floor,
}

impl Ink {
    /// The class in the style sheet.
    pub const fn class(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Before => "before",
            Self::After => "after",
            Self::Drive => "drive",
            Self::Floor => "floor",
        }
    }
}

/// A finished figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it shows, in a few words.
    pub title: String,
    /// The caption: how to read it.
    pub caption: String,
    wide: Sheet,
    narrow: Sheet,
}

impl Figure {
    /// Draws a figure at both widths.
    pub fn new(title: impl Into<String>, caption: impl Into<String>, draw: impl Fn(f64) -> Sheet) -> Self {
        let mut narrow = draw(NARROW);
        narrow.columns.clear();
        Self { title: title.into(), caption: caption.into(), wide: draw(WIDE), narrow }
    }

    /// The numbers of the figure as CSV: a comment with the title, the columns with their units, and as many rows as the
    /// longest column. They are the numbers that were given, not those of the pixels.
    pub fn csv(&self) -> String {
        column::csv(&self.title, &self.wide.columns)
    }

    /// The figure for a page.
    pub fn html(&self) -> String {
        format!(
            "<figure>\n<div class=\"wide\">{}</div>\n<div class=\"narrow\">{}</div>\n<figcaption><b>{}.</b> {}</figcaption>\n</figure>\n",
            self.wide.svg(&self.title, &self.caption, false),
            self.narrow.svg(&self.title, &self.caption, false),
            crate::report::text::escape(&self.title),
            crate::report::text::escape(&self.caption)
        )
    }

    /// The figure as a picture: wide, at twice its size, in the light colours.
    ///
    /// # Errors
    /// [`RasterError`].
    #[cfg(feature = "command")]
    pub fn png(&self) -> Result<Vec<u8>, RasterError> {
        raster::png(&self.title, &self.file())
    }

    /// The figure as a file of its own: wide, on its own background, light or dark as the reader's setting is.
    pub fn file(&self) -> String {
        self.wide.svg(&self.title, &self.caption, true)
    }
}
