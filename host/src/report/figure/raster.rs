//! A drawing as PNG: at twice its size, in the light colours, with a font that is in the program.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, fontdb};

use super::style::LIGHT;

/// Pixels of the picture for a pixel of the drawing: paper and dense screens need more than one.
const PIXELS: f32 = 2.0;
/// The font.
const FONT: &str = "DejaVu Sans";
/// Key and value of the text in a picture by which breakaway knows it again.
const SOFTWARE: (&str, &str) = ("Software", "breakaway");

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    for font in [dejavu::sans::regular(), dejavu::sans::bold()] {
        fonts.load_font_data(font.to_vec());
    }
    fonts.set_sans_serif_family(FONT);
    Arc::new(fonts)
});

/// Why a figure cannot be made a picture.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum RasterError {
    /// The drawing is not understood, or has no size.
    #[error("the figure `{title}` cannot be made a PNG: {what}; its SVG is whole")]
    Drawing {
        /// Title of the figure.
        title: String,
        /// What is wrong.
        what: String,
    },
}

/// The PNG of a drawing as SVG.
///
/// # Errors
/// [`RasterError`].
pub fn png(title: &str, svg: &str) -> Result<Vec<u8>, RasterError> {
    let refused = |what: String| RasterError::Drawing { title: title.to_owned(), what };
    let options =
        usvg::Options { fontdb: Arc::clone(&FONTS), font_family: FONT.to_owned(), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(&light(svg), &options).map_err(|error| refused(error.to_string()))?;
    let size = tree.size().to_int_size();
    let scaled = |pixels: u32| (pixels as f32 * PIXELS) as u32;
    let (width, height) = (scaled(size.width()), scaled(size.height()));
    let mut picture = Pixmap::new(width, height).ok_or_else(|| refused(format!("{width} by {height} pixels")))?;
    resvg::render(&tree, Transform::from_scale(PIXELS, PIXELS), &mut picture.as_mut());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    // The paper covers all, so that no colour is multiplied by its opacity.
    let written = encoder
        .add_text_chunk(SOFTWARE.0.to_owned(), SOFTWARE.1.to_owned())
        .and_then(|()| encoder.write_header())
        .and_then(|mut writer| writer.write_image_data(picture.data()));
    written.map_err(|error| refused(error.to_string()))?;
    Ok(bytes)
}

/// The drawing with the light colours themselves for their names, which a browser would look up.
fn light(svg: &str) -> String {
    let named = LIGHT.split(';').filter_map(|colour| colour.split_once(':'));
    named.fold(svg.to_owned(), |svg, (name, colour)| svg.replace(&format!("var({name})"), colour))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colours are those of the style, and letters leave ink: a picture without a font would have none.
    #[test]
    fn a_drawing_keeps_its_colours_and_its_letters() {
        let drawing = |text: &str| {
            format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60\" height=\"20\"><style>\
                 svg{{font-family:system-ui,sans-serif;font-size:13px}} svg .paper{{fill:var(--paper)}} \
                 svg text{{fill:var(--ink)}}</style>\
                 <rect class=\"paper\" width=\"60\" height=\"20\"/><text x=\"2\" y=\"15\">{text}</text></svg>"
            )
        };
        let decoded = |text: &str| {
            let bytes = png("a", &drawing(text)).unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!((reader.info().width, reader.info().height), (120, 40));
            pixels
        };
        let dark = |pixels: &[u8]| pixels.chunks(4).filter(|pixel| pixel[0] < 128).count();
        let (empty, lettered) = (decoded(""), decoded("ω · µ −"));
        assert!(empty.chunks(4).all(|pixel| pixel == [255, 255, 255, 255]));
        // Four letters of some 30 dark pixels each; an empty box for a missing one has an outline too, but all are there.
        assert!(dark(&lettered) > 60, "{}", dark(&lettered));
        assert_ne!(decoded("ω"), decoded("µ"));
    }

    #[test]
    fn what_is_no_drawing_is_refused() {
        let error = png("The ladder", "<svg").unwrap_err().to_string();
        assert!(error.starts_with("the figure `The ladder` cannot be made a PNG: "), "{error}");
    }
}
