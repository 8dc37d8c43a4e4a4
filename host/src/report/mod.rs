//! Figures and pages: what a discovery or an identification found, as one HTML file without any network, and as JSON.
//!
//! The figures are SVG written directly, not through `plotters`. The SVG backend of `plotters` puts colours, fonts and a
//! background into every element. Such a figure cannot follow the reader's light or dark setting, be restyled for print,
//! or carry a title and description for a screen reader. What is needed instead (scales, ticks, paths) is small:
//! [`figure`].
//!
//! Every figure is drawn twice, for a phone's width and for a page's, so that its lettering keeps its size. The style
//! sheet shows one of them.

pub mod choice;
pub mod discovery;
pub mod figure;
pub mod identification;
pub mod json;
pub mod look;
pub mod page;
pub mod remark;
#[cfg(feature = "command")]
pub mod response;
pub mod sine;
pub mod text;
pub mod tracking;
