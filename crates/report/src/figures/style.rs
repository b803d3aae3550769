//! One look for all figures: a few colours that colour-blind people can tell apart (Okabe & Ito).

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, RGBColor, SVGBackend};

/// Where a figure is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// What the plotting library answers.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Background.
pub const PAPER: RGBColor = RGBColor(255, 255, 255);
/// Text and axes.
pub const INK: RGBColor = RGBColor(34, 34, 38);
/// Grid lines and bands.
pub const FAINT: RGBColor = RGBColor(228, 228, 232);
/// Measured points.
pub const MEASURED: RGBColor = RGBColor(120, 120, 128);
/// The model.
pub const MODEL: RGBColor = RGBColor(213, 94, 0);
/// A second quantity.
pub const SECOND: RGBColor = RGBColor(0, 114, 178);
/// Published values.
pub const PUBLISHED: RGBColor = RGBColor(0, 158, 115);
/// Segments and parameters in turn.
pub const SERIES: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(120, 120, 128),
];
/// Font of all text.
pub const FONT: &str = "sans-serif";

/// Least and greatest of some numbers with a margin of 4 % on both sides.
pub fn span<'a>(values: impl IntoIterator<Item = &'a f64>) -> std::ops::Range<f64> {
    let finite = values.into_iter().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    if low > high {
        return 0.0..1.0;
    }
    let margin = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1e-6) };
    low - margin..high + margin
}

/// A number on an axis.
pub fn tick(x: &f64) -> String {
    let text = format!("{:.6}", if x.abs() < 1e-9 { 0.0 } else { *x });
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
