//! A figure as a file of its own: SVG as it is, PDF for papers, PNG for slides.

use super::Figure;
use crate::ReportError;
use input::Figure as Format;
use resvg::{tiny_skia, usvg};
use std::sync::{Arc, OnceLock};

/// Pixels of a PNG per unit of the SVG: 192 dots per inch.
const PNG_SCALE: f32 = 2.0;

/// Ending of a format's files.
pub fn ending(format: Format) -> &'static str {
    match format {
        Format::Svg => "svg",
        Format::Pdf => "pdf",
        Format::Png => "png",
    }
}

/// The figure in a format.
///
/// # Errors
/// If the figure cannot be converted.
pub fn export(figure: &Figure, format: Format) -> Result<Vec<u8>, ReportError> {
    let fault =
        |reason: String| ReportError::Figure { name: format!("{}.{}", figure.name, ending(format)), reason };
    match format {
        Format::Svg => Ok(figure.svg.clone().into_bytes()),
        Format::Pdf => {
            let tree = tree(&figure.svg).map_err(|e| fault(e.to_string()))?;
            svg2pdf::to_pdf(&tree, Default::default(), svg2pdf::PageOptions::default())
                .map_err(|e| fault(e.to_string()))
        }
        Format::Png => png(&figure.svg).map_err(fault),
    }
}

fn tree(svg: &str) -> Result<usvg::Tree, usvg::Error> {
    // The system's fonts are read once: that takes longer than all figures of a run.
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_system_fonts();
        sans(&mut fonts);
        Arc::new(fonts)
    });
    usvg::Tree::from_str(svg, &usvg::Options { fontdb: fonts.clone(), ..usvg::Options::default() })
}

/// `sans-serif` becomes a font that is there: the library's own choice is Arial.
fn sans(fonts: &mut usvg::fontdb::Database) {
    const WISHES: [&str; 5] = ["Arial", "Helvetica", "Liberation Sans", "DejaVu Sans", "Noto Sans"];
    let names: Vec<String> = fonts.faces().flat_map(|f| f.families.iter().map(|n| n.0.clone())).collect();
    let wished = WISHES.iter().find(|w| names.iter().any(|n| n == **w)).map(|w| (*w).to_owned());
    if let Some(name) = wished.or_else(|| names.first().cloned()) {
        fonts.set_sans_serif_family(name);
    }
}

fn png(svg: &str) -> Result<Vec<u8>, String> {
    let tree = tree(svg).map_err(|e| e.to_string())?;
    let size = tree.size().to_int_size().scale_by(PNG_SCALE).ok_or("the figure has no size")?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("the figure is too large")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(PNG_SCALE, PNG_SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_what_its_ending_says() -> Result<(), ReportError> {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"20\"><rect width=\"40\" height=\"20\" \
                   fill=\"#D55E00\"/><text x=\"4\" y=\"14\" font-family=\"sans-serif\">F</text></svg>";
        let figure = Figure { name: "a".into(), caption: String::new(), svg: svg.into() };
        assert!(export(&figure, Format::Pdf)?.starts_with(b"%PDF"));
        assert!(export(&figure, Format::Png)?.starts_with(b"\x89PNG"));
        assert_eq!(export(&figure, Format::Svg)?, svg.as_bytes());
        let broken = Figure { svg: "no svg".into(), ..figure };
        assert!(matches!(export(&broken, Format::Pdf), Err(ReportError::Figure { .. })));
        Ok(())
    }
}
