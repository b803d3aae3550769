//! Forest plot: a line per specimen with its interval, a diamond per group.

use super::style::tick;
use input::visible;
use std::fmt::Write;

/// One specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct ForestRow {
    /// Its name.
    pub label: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub interval: [f64; 2],
    /// Weight in the group's mean, 0 to 1; `None`: it is not in it.
    pub weight: Option<f64>,
}

/// One group.
#[derive(Clone, Debug, PartialEq)]
pub struct ForestGroup {
    /// Its name.
    pub name: String,
    /// Its specimens.
    pub rows: Vec<ForestRow>,
    /// Mean and its interval.
    pub mean: Option<(f64, [f64; 2])>,
    /// Where further specimens would lie.
    pub prediction: Option<[f64; 2]>,
}

const ROW: f64 = 20.0;
const LEFT: f64 = 250.0;
const WIDTH: f64 = 460.0;
const RIGHT: f64 = 250.0;
/// Half the height of a mean's diamond.
const DIAMOND: f64 = 6.0;

/// The plot as SVG; `axis` names the quantity with its unit. Empty where no row has a value.
pub fn forest(axis: &str, groups: &[ForestGroup]) -> String {
    let Some(scale) = Scale::of(groups) else { return String::new() };
    let lines: usize = groups.iter().map(|g| g.rows.len() + 1 + usize::from(g.mean.is_some())).sum();
    let height = ROW * (lines as f64 + 3.2);
    let total = LEFT + WIDTH + RIGHT;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\" fill=\"#222226\">\n<rect width=\"{total}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n"
    );
    let mut y = ROW;
    for group in groups {
        text(&mut out, 8.0, y, "bold", &group.name);
        y += ROW;
        for row in &group.rows {
            draw_row(&mut out, &scale, y, row);
            y += ROW;
        }
        if let Some((mean, interval)) = group.mean {
            draw_mean(&mut out, &scale, y, mean, interval, group.prediction);
            y += ROW;
        }
    }
    scale.draw(&mut out, y, axis);
    out.push_str("</svg>\n");
    out
}

fn draw_row(out: &mut String, scale: &Scale, y: f64, row: &ForestRow) {
    let label: String = row.label.chars().take(34).collect();
    text(out, 20.0, y, "normal", &label);
    let [low, high] = row.interval.map(|x| scale.at(x));
    let (x, middle) = (scale.at(row.value), y - 4.0);
    let colour = if row.weight.is_some() { "#0072B2" } else { "#9A9AA2" };
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "<path d=\"M{low:.1} {middle:.1}H{high:.1}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
    );
    scale.goes_on(out, middle, row.interval, colour);
    let half = 2.5 + 4.0 * row.weight.unwrap_or(0.0).sqrt();
    let fill = if row.weight.is_some() { colour } else { "none" };
    let _ = writeln!(
        out,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{2:.1}\" height=\"{2:.1}\" fill=\"{fill}\" stroke=\"{colour}\"/>",
        x - half,
        middle - half,
        2.0 * half
    );
    let weight = row.weight.map_or("not counted".to_owned(), |w| format!("{:.0} %", 100.0 * w));
    let [a, b] = row.interval.map(short);
    text(out, LEFT + WIDTH + 8.0, y, "normal", &format!("{} ({a} – {b}), {weight}", short(row.value)));
}

fn draw_mean(
    out: &mut String,
    scale: &Scale,
    y: f64,
    mean: f64,
    interval: [f64; 2],
    prediction: Option<[f64; 2]>,
) {
    let (middle, x) = (y - 4.0, scale.at(mean));
    if let Some([low, high]) = prediction.map(|p| p.map(|v| scale.at(v))) {
        let _ = writeln!(
            out,
            "<path d=\"M{low:.1} {middle:.1}H{high:.1}\" stroke=\"#D55E00\" stroke-width=\"1.5\" stroke-dasharray=\"3 3\"/>"
        );
    }
    // A diamond that the frame cuts has an edge there, not a tip that would be taken for its end.
    let [(low, left), (high, right)] = interval.map(|v| (scale.at(v), DIAMOND * scale.cut(mean, v)));
    let (top, bottom) = (middle - DIAMOND, middle + DIAMOND);
    let _ = writeln!(
        out,
        "<path d=\"M{low:.1} {:.1}L{x:.1} {top:.1}L{high:.1} {:.1}L{high:.1} {:.1}L{x:.1} {bottom:.1}L{low:.1} {:.1}Z\" \
         fill=\"#D55E00\"/>",
        middle - left,
        middle - right,
        middle + right,
        middle + left
    );
    text(out, 20.0, y, "bold", "random-effects mean");
    let [a, b] = interval.map(short);
    text(out, LEFT + WIDTH + 8.0, y, "bold", &format!("{} ({a} – {b})", short(mean)));
}

fn short(x: f64) -> String {
    crate::terminal::significant(x, 3)
}

fn text(out: &mut String, x: f64, y: f64, weight: &str, what: &str) {
    let what = visible(what).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-weight=\"{weight}\">{what}</text>");
}

/// From values to places, what lies outside at the rim.
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    /// Over values and means, and their intervals as far as these do not dwarf the values.
    fn of(groups: &[ForestGroup]) -> Option<Self> {
        let rows = || groups.iter().flat_map(|g| &g.rows);
        let means = groups.iter().filter_map(|g| g.mean.map(|m| m.0));
        let values: Vec<f64> = rows().map(|r| r.value).chain(means).filter(|v| v.is_finite()).collect();
        let low = values.iter().copied().reduce(f64::min)?;
        let high = values.iter().copied().reduce(f64::max)?;
        let limit = (high - low).max(0.2 * high.abs()).max(f64::MIN_POSITIVE);
        let ends = groups.iter().flat_map(|g| g.rows.iter().map(|r| r.interval).chain(g.mean.map(|m| m.1)));
        let (mut a, mut b) = (low, high);
        for [l, h] in ends.filter(|i| i.iter().all(|x| x.is_finite())) {
            (a, b) = (a.min(l.max(low - limit)), b.max(h.min(high + limit)));
        }
        let margin = 0.04 * (b - a).max(0.1 * limit);
        Some(Self { low: a - margin, high: b + margin })
    }

    fn at(&self, x: f64) -> f64 {
        let share = (x - self.low) / (self.high - self.low);
        LEFT + WIDTH * if share.is_nan() { 0.5 } else { share.clamp(0.0, 1.0) }
    }

    /// Height of a diamond, as a share, where the frame cuts it on the way from its middle to an end; 0: it does not.
    fn cut(&self, middle: f64, end: f64) -> f64 {
        let rim = end.clamp(self.low, self.high);
        let share = 1.0 - (rim - middle) / (end - middle);
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Heads of arrows where an interval goes on outside the frame.
    fn goes_on(&self, out: &mut String, y: f64, [low, high]: [f64; 2], colour: &str) {
        let ends = [(low < self.low, LEFT, 6.0), (high > self.high, LEFT + WIDTH, -6.0)];
        for (_, x, back) in ends.into_iter().filter(|e| e.0) {
            let to = x + back;
            let _ = writeln!(
                out,
                "<path d=\"M{x:.1} {y:.1}L{to:.1} {:.1}L{to:.1} {:.1}Z\" fill=\"{colour}\"/>",
                y - 4.0,
                y + 4.0
            );
        }
    }

    fn draw(&self, out: &mut String, y: f64, axis: &str) {
        let right = LEFT + WIDTH;
        let _ = writeln!(out, "<path d=\"M{LEFT} {y:.1}H{right}\" stroke=\"#222226\"/>");
        let raw = (self.high - self.low) / 5.0;
        let unit = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * unit).into_iter().find(|s| *s >= raw).unwrap_or(raw);
        let first = (self.low / step).ceil() as i64;
        for x in (first..first + 12).map(|k| k as f64 * step).take_while(|x| *x <= self.high) {
            let place = self.at(x);
            let _ = writeln!(out, "<path d=\"M{place:.1} {y:.1}v4\" stroke=\"#222226\"/>");
            text(out, place - 8.0, y + 16.0, "normal", &tick(&x));
        }
        text(out, LEFT, y + 32.0, "normal", axis);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(rows: Vec<ForestRow>) -> ForestGroup {
        ForestGroup { name: "a < b".into(), rows, mean: Some((1.5, [1.0, 2.0])), prediction: None }
    }

    #[test]
    fn every_row_is_drawn_inside_the_frame_whatever_its_numbers() {
        let row = |value: f64, interval: [f64; 2]| ForestRow {
            label: "s".into(),
            value,
            interval,
            weight: Some(0.5),
        };
        let wild = vec![row(1.0, [0.5, 1.5]), row(2.0, [-1e9, 1e9]), row(1.2, [f64::NAN, f64::INFINITY])];
        let svg = forest("Gc (N/mm)", &[group(wild)]);
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN\""), "{svg}");
        assert_eq!(svg.matches("H").count(), 4, "three intervals and the axis");
        assert!(forest("Gc", &[]).is_empty());
        // Both ends of the second interval go on outside, and the upper one of the third.
        assert_eq!(svg.matches("Z\" fill=\"#0072B2\"").count(), 3, "{svg}");
    }

    #[test]
    fn a_diamond_is_cut_where_the_frame_ends_and_whole_inside() {
        let scale = Scale { low: 0.0, high: 1.0 };
        assert_eq!((scale.cut(0.5, 0.9), scale.cut(0.5, 0.1)), (0.0, 0.0));
        // Half of the way lies outside: half the height is left.
        assert!((scale.cut(0.5, 1.5) - 0.5).abs() < 1e-12 && (scale.cut(0.5, -0.5) - 0.5).abs() < 1e-12);
        assert_eq!((scale.cut(0.5, f64::NAN), scale.cut(0.5, 0.5)), (0.0, 0.0));
        assert_eq!(scale.cut(0.5, f64::INFINITY), 1.0);
    }
}
