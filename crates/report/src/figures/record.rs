//! A record as it was imported: force against displacement and against time, all rows and the points kept of them.

use super::style::{Area, Drawn, FAINT, FONT, INK, MEASURED, MODEL, span, tick};
use super::{Figure, draw};
use crate::ReportError;
use plotters::prelude::*;

const SIZE: (u32, u32) = (900, 400);
/// Most rows that are drawn; of more, least and greatest of each stretch.
const DRAWN: usize = 4000;

/// Time (s), displacement (mm) and force (N) of a record.
#[derive(Clone, Copy, Debug)]
pub struct Channels<'a> {
    /// s
    pub time: &'a [f64],
    /// mm
    pub displacement: &'a [f64],
    /// N
    pub force: &'a [f64],
}

/// The picture of a record; `points`: what a reduction kept.
///
/// # Errors
/// If it cannot be drawn.
pub fn of_record(
    name: &str,
    rows: Channels<'_>,
    points: Option<Channels<'_>>,
) -> Result<Figure, ReportError> {
    let caption = format!("{name}: force against displacement and against time, as imported");
    draw(name, caption, SIZE, |area| {
        let (left, right) = area.split_horizontally(SIZE.0 / 2);
        let kept = |p: Channels<'_>| (p.displacement.to_vec(), p.force.to_vec());
        panel(&left, rows.displacement, rows.force, points.map(kept), "displacement (mm)", "force (N)")?;
        let kept = |p: Channels<'_>| (p.time.to_vec(), p.force.to_vec());
        panel(&right, rows.time, rows.force, points.map(kept), "time (s)", "")
    })
}

fn panel(
    area: &Area,
    x: &[f64],
    y: &[f64],
    points: Option<(Vec<f64>, Vec<f64>)>,
    across: &str,
    up: &str,
) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(18)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(span(x), span(y))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style((FONT, 15).into_font().color(&INK))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .x_labels(6)
        .x_desc(across)
        .y_desc(up)
        .draw()?;
    let shown = thinned(y);
    chart.draw_series(LineSeries::new(shown.into_iter().map(|i| (x[i], y[i])), &MEASURED))?;
    if let Some((x, y)) = points {
        chart.draw_series(x.into_iter().zip(y).map(|p| Circle::new(p, 2, MODEL.filled())))?;
    }
    Ok(())
}

/// Indices that draw the same line: least and greatest of each stretch, and the ends.
fn thinned(y: &[f64]) -> Vec<usize> {
    if y.len() <= DRAWN {
        return (0..y.len()).collect();
    }
    let stretch = y.len().div_ceil(DRAWN / 2);
    let mut out = vec![0];
    for start in (0..y.len()).step_by(stretch) {
        let inside = start..(start + stretch).min(y.len());
        let least = inside.clone().min_by(|a, b| y[*a].total_cmp(&y[*b]));
        let greatest = inside.max_by(|a, b| y[*a].total_cmp(&y[*b]));
        out.extend(least);
        out.extend(greatest);
    }
    out.push(y.len() - 1);
    out.sort_unstable();
    out.dedup();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_record_is_drawn_with_its_peaks() -> Result<(), ReportError> {
        let y: Vec<f64> =
            (0..50_000).map(|i| if i == 31_234 { 5.0 } else { f64::from(i % 7) / 7.0 }).collect();
        let shown = thinned(&y);
        assert!(shown.len() <= DRAWN + 2 && shown.contains(&31_234) && shown.contains(&49_999));
        let all = Channels { time: &y, displacement: &y, force: &y };
        let picture = of_record("a", all, Some(all))?;
        assert!(picture.svg.contains("time (s)") && picture.svg.contains("displacement (mm)"));
        Ok(())
    }
}
