//! Units as machines write them, and the way to mm, s, N and MPa.

use serde::Serialize;

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// In s.
    Time,
    /// In mm.
    Length,
    /// In N.
    Force,
    /// A pure number: strain or stretch.
    Ratio,
    /// In MPa.
    Stress,
    /// In mm/s.
    Speed,
    /// In 1/s.
    Rate,
}

/// A unit: its value is the number times the factor. A power of ten moves the decimal mark of the text instead, so
/// that 12.3 mN are exactly the double nearest to 0.0123 N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub measure: Measure,
    /// Power of ten to the internal unit.
    pub exponent: i32,
    /// What is left of the factor after that.
    pub factor: f64,
}

impl Unit {
    const fn ten(measure: Measure, exponent: i32) -> Self {
        Self { measure, exponent, factor: 1.0 }
    }

    /// The whole factor.
    pub fn scale(&self) -> f64 {
        self.factor * 10_f64.powi(self.exponent)
    }
}

/// The unit of this text, with or without brackets.
pub fn parse(text: &str) -> Option<Unit> {
    let text = tidy(text);
    named(&text).or_else(|| named(&lowered(&text)))
}

/// Without brackets and blanks, the many signs for micro, square and dot made one.
fn tidy(text: &str) -> String {
    let text = text.trim().trim_matches(|c| "()[]<>{}（）【】".contains(c));
    text.chars()
        .filter(|c| !c.is_whitespace() && !"^·⋅.".contains(*c))
        .map(|c| match c {
            'µ' | 'μ' => 'u',
            '²' => '2',
            c => c,
        })
        .collect()
}

/// Lower case, but for what would change its meaning: M(ega) and m(illi).
fn lowered(text: &str) -> String {
    if text.starts_with('M')
        && !text.eq_ignore_ascii_case("mm")
        && text.len() < 4
        && !text.eq_ignore_ascii_case("min")
    {
        return String::new();
    }
    text.to_lowercase()
}

fn named(text: &str) -> Option<Unit> {
    use Measure::{Force, Length, Rate, Ratio, Speed, Stress, Time};
    let other = |measure, factor| Unit { measure, exponent: 0, factor };
    Some(match text {
        "s" | "S" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunde" | "sekunden" | "秒" => {
            Unit::ten(Time, 0)
        }
        "ms" | "msec" | "毫秒" => Unit::ten(Time, -3),
        "us" | "usec" => Unit::ten(Time, -6),
        "min" | "minute" | "minutes" | "分" | "分钟" => other(Time, 60.0),
        "h" | "hr" | "hour" | "hours" | "std" => other(Time, 3600.0),
        "mm" | "millimeter" | "millimetre" | "毫米" => Unit::ten(Length, 0),
        "um" | "micron" | "microns" | "微米" => Unit::ten(Length, -3),
        "nm" => Unit::ten(Length, -6),
        "cm" => Unit::ten(Length, 1),
        "m" => Unit::ten(Length, 3),
        "in" | "inch" | "inches" | "\"" => other(Length, 25.4),
        "N" | "newton" | "newtons" | "牛" | "牛顿" => Unit::ten(Force, 0),
        "mN" | "毫牛" => Unit::ten(Force, -3),
        "uN" | "微牛" => Unit::ten(Force, -6),
        "nN" => Unit::ten(Force, -9),
        "cN" | "cn" => Unit::ten(Force, -2),
        "daN" | "dan" => Unit::ten(Force, 1),
        "kN" | "KN" | "kn" | "千牛" => Unit::ten(Force, 3),
        "MN" => Unit::ten(Force, 6),
        "gf" => other(Force, 9.80665e-3),
        "kgf" | "kp" => other(Force, 9.80665),
        "lbf" => other(Force, 4.448_221_615_260_5),
        "%" | "percent" => Unit::ten(Ratio, -2),
        "‰" => Unit::ten(Ratio, -3),
        "ue" | "uε" | "uɛ" | "microstrain" => Unit::ten(Ratio, -6),
        "1" | "-" | "mm/mm" | "m/m" | "in/in" | "strain" => Unit::ten(Ratio, 0),
        "Pa" | "pa" => Unit::ten(Stress, -6),
        "hPa" | "hpa" => Unit::ten(Stress, -4),
        "kPa" | "KPa" | "kpa" => Unit::ten(Stress, -3),
        "MPa" | "Mpa" | "N/mm2" | "n/mm2" | "MN/m2" | "兆帕" => Unit::ten(Stress, 0),
        "GPa" | "gpa" => Unit::ten(Stress, 3),
        "N/m2" => Unit::ten(Stress, -6),
        "psi" => other(Stress, 6.894_757_293_168e-3),
        "mm/s" | "mm/sec" => Unit::ten(Speed, 0),
        "um/s" => Unit::ten(Speed, -3),
        "mm/min" => other(Speed, 1.0 / 60.0),
        "m/s" => Unit::ten(Speed, 3),
        "in/min" => other(Speed, 25.4 / 60.0),
        "Hz" | "hz" | "1/s" => Unit::ten(Rate, 0),
        "kHz" | "khz" => Unit::ten(Rate, 3),
        _ => return None,
    })
}

/// A name with its unit taken off: `Load [kN]`, `Kraft in kN`, `Time(ms)`, `XForce_mN`, `Extension / mm`, `Force, N`.
pub(crate) fn split(name: &str) -> (String, Option<String>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('<', '>'), ('{', '}'), ('（', '）')] {
        if let (Some(a), Some(b)) = (name.rfind(open), name.rfind(close))
            && a < b
            && a > 0
        {
            let inner = name[a + open.len_utf8()..b].trim();
            if parse(inner).is_some() || inner.is_empty() {
                let rest = format!("{} {}", &name[..a], &name[b + close.len_utf8()..]);
                return (rest.trim().to_owned(), Some(inner.to_owned()).filter(|u| !u.is_empty()));
            }
        }
    }
    for separator in [" in ", " / ", "/", ", ", "_", " ", "-", ":"] {
        if let Some(at) = name.rfind(separator) {
            let (front, back) = (name[..at].trim(), name[at + separator.len()..].trim());
            let bare = !front.is_empty() && back != "-" && back != "1" && back != "in";
            if bare && parse(back).is_some() {
                return (front.to_owned(), Some(back.to_owned()));
            }
        }
    }
    (name.to_owned(), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_taken_off_names() {
        for (name, bare, unit) in [
            ("Load [kN]", "Load", "kN"),
            ("Kraft in kN", "Kraft", "kN"),
            ("Extension (mm)", "Extension", "mm"),
            ("Time(ms)", "Time", "ms"),
            ("Force(uN)", "Force", "uN"),
            ("XForce_mN", "XForce", "mN"),
            ("Time_S", "Time", "S"),
            ("Extension / mm", "Extension", "mm"),
            ("Force, N", "Force", "N"),
            ("Tip Displacement(µm)", "Tip Displacement", "µm"),
            ("Tensile stress (N/mm²)", "Tensile stress", "N/mm²"),
            ("位移(mm)", "位移", "mm"),
        ] {
            assert_eq!(split(name), (bare.to_owned(), Some(unit.to_owned())), "{name}");
            assert!(parse(unit).is_some(), "{unit}");
        }
        assert_eq!(split("Crosshead position"), ("Crosshead position".into(), None));
        assert_eq!(split("Segment ID"), ("Segment ID".into(), None));
    }

    /// Every unit once, in mm, s, N and MPa (BIPM 2019, NIST SP 811 for inch, pound-force and psi).
    #[test]
    fn units_are_as_large_as_they_are() {
        use Measure::{Force, Length, Rate, Ratio, Speed, Stress, Time};
        let pound = 0.453_592_37 * 9.806_65;
        for (measure, units) in [
            (Time, vec![("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("min", 60.0), ("h", 3600.0)]),
            (Length, vec![("mm", 1.0), ("µm", 1e-3), ("nm", 1e-6), ("cm", 10.0), ("m", 1e3), ("in", 25.4)]),
            (Force, vec![("N", 1.0), ("mN", 1e-3), ("µN", 1e-6), ("nN", 1e-9), ("kN", 1e3), ("MN", 1e6)]),
            (
                Force,
                vec![("cN", 1e-2), ("daN", 10.0), ("gf", 9.806_65e-3), ("kgf", 9.806_65), ("lbf", pound)],
            ),
            (Ratio, vec![("1", 1.0), ("%", 1e-2), ("‰", 1e-3), ("µε", 1e-6), ("mm/mm", 1.0)]),
            (Stress, vec![("MPa", 1.0), ("kPa", 1e-3), ("hPa", 1e-4), ("Pa", 1e-6), ("GPa", 1e3)]),
            (Stress, vec![("N/mm²", 1.0), ("N/m²", 1e-6), ("psi", pound / (25.4 * 25.4))]),
            (
                Speed,
                vec![
                    ("mm/s", 1.0),
                    ("µm/s", 1e-3),
                    ("mm/min", 1.0 / 60.0),
                    ("m/s", 1e3),
                    ("in/min", 25.4 / 60.0),
                ],
            ),
            (Rate, vec![("Hz", 1.0), ("1/s", 1.0), ("kHz", 1e3)]),
        ] {
            for (text, size) in units {
                let unit = parse(text).expect(text);
                assert_eq!(unit.measure, measure, "{text}");
                assert!((unit.scale() / size - 1.0).abs() < 1e-12, "{text}: {}", unit.scale());
            }
        }
    }

    #[test]
    fn mega_and_milli_are_not_mixed_up() {
        assert_eq!(parse("mN").map(|u| u.exponent), Some(-3));
        assert_eq!(parse("MN").map(|u| u.exponent), Some(6));
        assert_eq!(parse("MM").map(|u| (u.measure, u.exponent)), Some((Measure::Length, 0)));
        assert_eq!(parse("MS"), None);
        assert_eq!(parse("(sec)").map(|u| u.measure), Some(Measure::Time));
        assert_eq!(parse("V"), None);
    }
}
