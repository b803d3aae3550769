//! Model against measurement, misfit underneath (the paper's Fig. 5).

use super::style::{Area, Drawn, FAINT, FONT, INK, MEASURED, MODEL, PAPER, SERIES, span, tick};
use super::{Figure, draw};
use crate::{Curve, ReportError};
use plotters::prelude::*;

const SIZE: (u32, u32) = (620, 470);

/// The figure of one test.
pub fn figure(c: &Curve) -> Result<Figure, ReportError> {
    let measured = !c.measured.is_empty();
    let caption = if measured {
        format!("{}: record and model, misfit (record − model) below with the noise band of ± 2 sd", c.test)
    } else {
        format!("{}: computed curve", c.test)
    };
    draw(&c.test, caption, SIZE, |area| {
        if measured {
            let (top, bottom) = area.split_vertically(330);
            force(&top, c)?;
            misfit(&bottom, c)
        } else {
            force(area, c)
        }
    })
}

fn points<'a>(u: &'a [f64], f: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    u.iter().copied().zip(f.iter().copied())
}

/// Share of the axes' width and height that the names of record and model take.
const NAMES: (f64, f64) = (0.22, 0.25);

/// The corner in which the names of record and model hide least of them; the upper left one of several.
fn emptiest(c: &Curve) -> SeriesLabelPosition {
    let (x, y) = (span(&c.displacement), span(c.measured.iter().chain(&c.model)));
    let share = |range: &std::ops::Range<f64>, v: f64| (v - range.start) / (range.end - range.start);
    let hidden = |right: bool, upper: bool| {
        let all = points(&c.displacement, &c.measured).chain(points(&c.displacement, &c.model));
        all.filter(|&(u, f)| {
            let (across, up) = (share(&x, u), share(&y, f));
            let across = if right { 1.0 - across } else { across };
            let up = if upper { 1.0 - up } else { up };
            across < NAMES.0 && up < NAMES.1
        })
        .count()
    };
    let corners = [
        (hidden(false, true), SeriesLabelPosition::UpperLeft),
        (hidden(true, true), SeriesLabelPosition::UpperRight),
        (hidden(true, false), SeriesLabelPosition::LowerRight),
        (hidden(false, false), SeriesLabelPosition::LowerLeft),
    ];
    corners.into_iter().min_by_key(|c| c.0).map_or(SeriesLabelPosition::UpperLeft, |c| c.1)
}

fn force(area: &Area, c: &Curve) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(18)
        .x_label_area_size(if c.measured.is_empty() { 40 } else { 18 })
        .y_label_area_size(64)
        .build_cartesian_2d(span(&c.displacement), span(c.measured.iter().chain(&c.model)))?;
    let label = (FONT, 15).into_font().color(&INK);
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style(label.clone())
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .y_desc("force (N)");
    if c.measured.is_empty() {
        mesh.x_desc("displacement (mm)");
    }
    mesh.draw()?;
    if !c.measured.is_empty() {
        chart
            .draw_series(points(&c.displacement, &c.measured).map(|p| Circle::new(p, 2, MEASURED.filled())))?
            .label("record")
            .legend(|(x, y)| Circle::new((x + 10, y), 3, MEASURED.filled()));
    }
    chart
        .draw_series(LineSeries::new(points(&c.displacement, &c.model), MODEL.stroke_width(2)))?
        .label("model")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], MODEL.stroke_width(2)));
    chart.configure_series_labels().position(emptiest(c)).background_style(PAPER).label_font(label).draw()?;
    Ok(())
}

fn misfit(area: &Area, c: &Curve) -> Drawn {
    let residual = c.residual();
    let most = residual.iter().fold(3.0 * c.noise, |m, r| m.max(r.abs())) * 1.1;
    let x = span(&c.displacement);
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_top(2)
        .margin_right(18)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(x.clone(), -most..most)?;
    let band = [(x.start, -2.0 * c.noise), (x.end, 2.0 * c.noise)];
    chart.draw_series([Rectangle::new(band, FAINT.filled())])?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(INK)
        .label_style((FONT, 15).into_font().color(&INK))
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .y_labels(5)
        .x_desc("displacement (mm)")
        .y_desc("misfit (N)")
        .draw()?;
    chart.draw_series([PathElement::new([(x.start, 0.0), (x.end, 0.0)], INK)])?;
    let mut names: Vec<&String> = Vec::new();
    for (i, (&u, &r)) in c.displacement.iter().zip(&residual).enumerate() {
        let colour = c.segment.get(i).map_or(SERIES[0], |s| {
            let at = names.iter().position(|n| *n == s).unwrap_or_else(|| {
                names.push(s);
                names.len() - 1
            });
            SERIES[at % SERIES.len()]
        });
        chart.draw_series([Circle::new((u, r), 2, colour.filled())])?;
    }
    Ok(())
}
