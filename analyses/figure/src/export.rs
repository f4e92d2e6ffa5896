//! From a figure to the bytes of a file.

use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};

use super::canvas::Form;
use super::error::PlotError;
use super::model::{Figure, Lettering};
use super::theme::PNG_DPI;

/// CSS pixels per inch, the unit of usvg.
const CSS_DPI: f32 = 96.0;

impl Figure {
    /// The figure as SVG with its printed size in mm. Unless text is asked for, letters are
    /// outlines and look the same in every viewer. Equal figures give equal bytes, here and in the other formats.
    ///
    /// # Errors
    /// [`PlotError`] if a range, a label or a layer cannot be drawn.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.draw(match self.lettering {
            Lettering::Outlines => Form::Svg,
            Lettering::Text => Form::Letters,
        })
    }

    /// The same drawing as PNG with 300 dots per inch.
    ///
    /// # Errors
    /// As [`Figure::svg`], or [`PlotError::Png`].
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        raster(&self.draw(Form::Svg)?)
    }

    /// The same drawing as PDF of the printed size, with selectable text and the fonts embedded.
    ///
    /// # Errors
    /// As [`Figure::svg`], or [`PlotError::Pdf`].
    pub fn pdf(&self) -> Result<Vec<u8>, PlotError> {
        let mut fonts = Database::new();
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        let options = Options { fontdb: Arc::new(fonts), ..Options::default() };
        let tree = svg2pdf::usvg::Tree::from_str(&self.draw(Form::Pdf)?, &options)?;
        let page = svg2pdf::PageOptions { dpi: CSS_DPI };
        svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page)
            .map_err(|error| PlotError::Pdf(error.to_string()))
    }
}

/// An SVG without text as PNG.
pub(super) fn raster(svg: &str) -> Result<Vec<u8>, PlotError> {
    let tree = Tree::from_str(svg, &Options::default())?;
    let scale = PNG_DPI as f32 / CSS_DPI;
    // At most a few thousand pixels: the casts only drop the fraction.
    let pixels_of = |length: f32| (length * scale).round() as u32;
    let (width, height) = (pixels_of(tree.size().width()), pixels_of(tree.size().height()));
    let mut pixels = Pixmap::new(width, height).ok_or(PlotError::Pixels)?;
    // The last row and column may be covered in part only.
    pixels.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    encode(&pixels, Some(PNG_DPI))
}

/// Opaque pixels as PNG, with the resolution at which they have their printed size.
pub(super) fn encode(pixels: &Pixmap, dpi: Option<f64>) -> Result<Vec<u8>, PlotError> {
    /// Inches in a metre.
    const METRE: f64 = 1000.0 / 25.4;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_pixel_dims(dpi.map(|dpi| {
        let per_metre = (dpi * METRE).round() as u32;
        png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }
    }));
    let mut writer = encoder.write_header()?;
    // Opaque, so that premultiplied colours are the colours.
    writer.write_image_data(pixels.data())?;
    writer.finish()?;
    Ok(bytes)
}
