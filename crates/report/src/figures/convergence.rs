//! Parameters and objective over the search (the paper's Fig. 6).

use super::style::{Area, Drawn, FAINT, FONT, INK, MODEL, PAPER, SERIES, tick};
use super::{Figure, draw};
use crate::ReportError;
use crate::answer::{IdentifyAnswer, StageHistory};
use crate::published::area as area_of;
use plotters::prelude::*;

const SIZE: (u32, u32) = (620, 470);

/// Accepted steps one after the other: position, stage, objective, values.
struct Step<'a> {
    at: f64,
    stage: usize,
    f: f64,
    history: &'a StageHistory,
    theta: &'a [f64],
}

/// The figure; none without a search.
pub fn figure(a: &IdentifyAnswer) -> Result<Option<Figure>, ReportError> {
    let steps = steps(&a.history);
    if steps.len() < 2 {
        return Ok(None);
    }
    let caption = "Convergence: parameters over their final values, and the objective over its start in each stage \
                   (accepted steps, coarse meshes first)";
    let figure = draw("convergence", caption.to_owned(), SIZE, |area| {
        let (top, bottom) = area.split_vertically(280);
        parameters(&top, a, &steps)?;
        objective(&bottom, &steps)
    })?;
    Ok(Some(figure))
}

fn steps(history: &[StageHistory]) -> Vec<Step<'_>> {
    let mut out = Vec::new();
    for (stage, h) in history.iter().enumerate() {
        for run in h.runs.iter().filter(|r| r.accepted) {
            let Some(f) = run.f else { continue };
            out.push(Step { at: out.len() as f64, stage, f, history: h, theta: &run.theta });
        }
    }
    out
}

/// First, middle and last area, as in the paper, and everything that is no area, with final values.
pub fn shown_parameters(a: &IdentifyAnswer) -> Vec<(String, f64)> {
    let areas = a.parameters.iter().filter_map(|p| area_of(&p.path)).max().map_or(0, |m| m + 1);
    let wanted = [0, areas / 2, areas.saturating_sub(1)];
    let keep = |path: &str| area_of(path).is_none_or(|i| wanted.contains(&i));
    a.parameters
        .iter()
        .filter(|p| keep(&p.path) && p.value != 0.0)
        .map(|p| (p.path.clone(), p.value))
        .collect()
}

fn parameters(area: &Area, a: &IdentifyAnswer, steps: &[Step]) -> Drawn {
    let series: Vec<(String, Vec<(f64, f64)>)> = shown_parameters(a)
        .into_iter()
        .map(|(path, end)| {
            let value = |s: &Step| s.history.paths.iter().position(|p| *p == path).map(|i| s.theta[i] / end);
            let points =
                steps.iter().filter_map(|s| value(s).filter(|v| *v > 0.0).map(|v| (s.at, v))).collect();
            (path, points)
        })
        .collect();
    let ratios = series.iter().flat_map(|s| s.1.iter().map(|p| p.1));
    let (low, high) = ratios.fold((0.8f64, 1.25f64), |(l, h), v| (l.min(v), h.max(v)));
    let end = steps.len() as f64 - 1.0;
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(190)
        .x_label_area_size(18)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..end, (low.max(1e-3)..high.min(1e3)).log_scale())?;
    let label = (FONT, 15).into_font().color(&INK);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style(label)
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .y_desc("value / final value")
        .draw()?;
    let text = (FONT, 12).into_font().color(&INK);
    for (i, (path, points)) in series.iter().enumerate() {
        let colour = SERIES[i % SERIES.len()];
        let width = if i < SERIES.len() { 2 } else { 1 };
        chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(width)))?;
        // The legend stands outside the curves.
        let (x, y) = (SIZE.0 as i32 - 178, 20 + 17 * i as i32);
        area.draw(&PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(width)))?;
        area.draw(&Text::new(path.clone(), (x + 24, y - 7), text.clone()))?;
    }
    Ok(())
}

fn objective(area: &Area, steps: &[Step]) -> Drawn {
    let first =
        |stage: usize| steps.iter().find(|s| s.stage == stage).map_or(1.0, |s| s.f.max(f64::MIN_POSITIVE));
    let value = |s: &Step| (s.f / first(s.stage)).max(1e-12);
    let low = steps.iter().map(value).fold(0.5f64, f64::min);
    let end = steps.len() as f64 - 1.0;
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(190)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..end, (0.8 * low..1.3).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style((FONT, 15).into_font().color(&INK))
        .x_label_formatter(&tick)
        .y_label_formatter(&|v: &f64| if *v >= 0.01 { tick(v) } else { format!("{v:.0e}") })
        .y_labels(4)
        .x_desc("accepted step")
        .y_desc("f / f at start")
        .draw()?;
    let stages = steps.last().map_or(0, |s| s.stage + 1);
    for stage in 0..stages {
        let line = || steps.iter().filter(move |s| s.stage == stage).map(|s| (s.at, value(s)));
        chart.draw_series(LineSeries::new(line(), MODEL.stroke_width(2)))?;
        chart.draw_series(line().map(|p| Circle::new(p, 2, PAPER.filled())))?;
        chart.draw_series(line().map(|p| Circle::new(p, 2, MODEL)))?;
        if let Some(s) = steps.iter().find(|s| s.stage == stage && s.stage > 0) {
            chart.draw_series([PathElement::new([(s.at - 0.5, 0.8 * low), (s.at - 0.5, 1.3)], FAINT)])?;
        }
    }
    Ok(())
}
