//! The ladder: rms misfit falling with the effects added, noise level dashed.

use super::style::{Drawn, FAINT, FONT, INK, MODEL, SECOND, tick};
use super::{Figure, draw};
use crate::ReportError;
use plotters::prelude::*;

const SIZE: (u32, u32) = (620, 330);

/// The figure of (model, rms in N) rungs above the noise, N; none of a single rung.
///
/// # Errors
/// If it cannot be drawn.
pub fn figure(fitted_models: &[(String, f64)], noise: f64) -> Result<Option<Figure>, ReportError> {
    if fitted_models.len() < 2 {
        return Ok(None);
    }
    let caption = "Ladder: rms misfit over all force points against the effects added (dashed: noise)";
    let most = 1.15 * fitted_models.iter().fold(noise, |m, r| m.max(r.1));
    draw("ladder", caption.to_owned(), SIZE, |area| -> Drawn {
        let mut chart = ChartBuilder::on(area)
            .margin(10)
            .x_label_area_size(34)
            .y_label_area_size(70)
            .build_cartesian_2d(0.0..fitted_models.len() as f64, 0.0..most)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(FAINT)
            .axis_style(INK)
            .label_style((FONT, 15).into_font().color(&INK))
            .x_labels(0)
            .y_label_formatter(&tick)
            .x_desc("effects added, from left to right")
            .y_desc("rms misfit (N)")
            .draw()?;
        let text = (FONT, 13).into_font().color(&INK);
        for (i, (name, rms)) in fitted_models.iter().enumerate() {
            let (from, to) = (i as f64, i as f64 + 1.0);
            chart.draw_series([PathElement::new([(from, *rms), (to, *rms)], MODEL.stroke_width(3))])?;
            if let Some(next) = fitted_models.get(i + 1) {
                chart.draw_series([PathElement::new([(to, *rms), (to, next.1)], MODEL.stroke_width(1))])?;
            }
            chart.draw_series([Text::new(name.clone(), (from + 0.04, rms + 0.07 * most), text.clone())])?;
        }
        chart.draw_series(DashedLineSeries::new(
            [(0.0, noise), (fitted_models.len() as f64, noise)],
            6,
            4,
            SECOND.stroke_width(1),
        ))?;
        Ok(())
    })
    .map(Some)
}
