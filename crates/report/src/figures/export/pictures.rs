//! PDF and PNG of a figure, with the fonts of the machine.

use input::Figure as Format;
use resvg::{tiny_skia, usvg};
use std::sync::{Arc, OnceLock};

/// Pixels of a PNG per unit of the SVG: 192 dots per inch.
const PNG_SCALE: f32 = 2.0;

/// The SVG as PDF or PNG; `Err`: why not.
pub(super) fn converted(svg: &str, format: Format) -> Result<Vec<u8>, String> {
    let tree = tree(svg).map_err(|e| e.to_string())?;
    if format == Format::Pdf {
        return svg2pdf::to_pdf(&tree, Default::default(), svg2pdf::PageOptions::default())
            .map_err(|e| e.to_string());
    }
    let size = tree.size().to_int_size().scale_by(PNG_SCALE).ok_or("the figure has no size")?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("the figure is too large")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(PNG_SCALE, PNG_SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| e.to_string())
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
