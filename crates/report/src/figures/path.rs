//! Toughness and strength along the tear path with intervals and published values.

use super::style::{Area, Drawn, FAINT, FONT, INK, MODEL, PUBLISHED, SECOND, tick};
use super::{Figure, draw};
use crate::ReportError;
use crate::answer::{IdentifyAnswer, ParameterAnswer};
use crate::published::area as area_of;
use plotters::prelude::*;

const SIZE: (u32, u32) = (620, 290);

/// The figure; none without areas.
pub fn figure(a: &IdentifyAnswer) -> Result<Option<Figure>, ReportError> {
    let of = |end: &str| -> Vec<&ParameterAnswer> {
        a.parameters.iter().filter(|p| area_of(&p.path).is_some() && p.path.ends_with(end)).collect()
    };
    let (gc, strength) = (of("].gc"), of("].sigma_c"));
    if gc.is_empty() && strength.is_empty() {
        return Ok(None);
    }
    let published = a.published.is_some();
    let note = if published { "; green diamonds: published" } else { "" };
    let caption = format!(
        "Toughness and strength along the tear path with 95 % intervals (hollow: not identifiable{note})"
    );
    draw("path", caption, SIZE, |area| {
        let (left, right) = area.split_horizontally(SIZE.0 / 2);
        bars(&left, &gc, "Gc (N/mm)", MODEL)?;
        bars(&right, &strength, "σc (MPa)", SECOND)
    })
    .map(Some)
}

fn bars(area: &Area, parameters: &[&ParameterAnswer], name: &str, colour: RGBColor) -> Drawn {
    if parameters.is_empty() {
        return Ok(());
    }
    let most = 1.08 * top(parameters);
    let areas = parameters.iter().filter_map(|p| area_of(&p.path)).max().map_or(1, |m| m + 1);
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(0.5..areas as f64 + 0.5, 0.0..most)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style((FONT, 15).into_font().color(&INK))
        .x_labels(areas.min(10))
        .x_label_formatter(&|x| if (x - x.round()).abs() < 1e-6 { tick(x) } else { String::new() })
        .y_label_formatter(&tick)
        .x_desc("area, from the cut")
        .y_desc(name)
        .draw()?;
    for p in parameters {
        let Some(area) = area_of(&p.path) else { continue };
        let x = area as f64 + 1.0;
        let low = p.interval_95[0].unwrap_or(0.0).clamp(0.0, most);
        let high = p.interval_95[1].unwrap_or(most).clamp(0.0, most);
        chart.draw_series([PathElement::new([(x, low), (x, high)], colour.stroke_width(2))])?;
        let fill = if p.identifiable { colour.filled() } else { colour.stroke_width(1) };
        chart.draw_series([Circle::new((x, p.value.min(most)), 4, fill)])?;
        if let Some(v) = p.published {
            let at = (x + 0.22, v.min(most));
            let diamond = [(0, -5), (5, 0), (0, 5), (-5, 0)];
            chart.draw_series([EmptyElement::at(at) + Polygon::new(diamond, PUBLISHED.filled())])?;
        }
    }
    Ok(())
}

/// Room for the values and for intervals that are no more than three times as high.
fn top(parameters: &[&ParameterAnswer]) -> f64 {
    let values = parameters.iter().flat_map(|p| [Some(p.value), p.published]).flatten();
    let highest = values.fold(f64::MIN_POSITIVE, f64::max);
    let ends = parameters.iter().filter_map(|p| p.interval_95[1]).filter(|e| *e <= 3.0 * highest);
    ends.fold(highest, f64::max)
}
