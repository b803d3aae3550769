//! A resolved case back to TOML, so that reading it gives an equal case.

use crate::case::{Case, Ends, Geometry, Grips, Leg, Record, Test, Weight, absolute};
use crate::config::{
    BulkConfig, Control, DiagnoseConfig, EffectConfig, Figure, IdentifyConfig, Integration, InterfaceConfig,
    MeshConfig, Mode, OptionValue, OutputConfig, Profile, SolverConfig, Symmetry, Value,
};
use crate::units::{spell, spell_reciprocal};
use params::{ParamSpec, Quantity};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

/// The resolved configuration with every default, as TOML.
///
/// Reading it back gives a case for which [`Case::same_input`] holds, to the last bit of every number.
/// Records are named by their absolute paths; outlines and profiles are written out. A parameter for which
/// the file gave nothing stands as a comment.
pub fn resolved_toml(case: &Case) -> String {
    resolved_toml_with(case, |record| absolute(&record.path))
}

/// The same, with the path of each record chosen by the caller (for instance of a copy in the run directory;
/// relative paths are relative to the file that will be written).
pub fn resolved_toml_with(case: &Case, path: impl Fn(&Record) -> PathBuf) -> String {
    let mut w = Writer::default();
    w.text("name", &case.name);
    if !case.provenance.is_empty() {
        w.text("provenance", &case.provenance);
    }
    if let Some(parent) = &case.parent {
        w.text("parent", parent);
    }
    geometry(&mut w, &case.geometry);
    for t in &case.tests {
        test(&mut w, t, &path);
    }
    mesh(&mut w, &case.mesh);
    bulk(&mut w, &case.bulk);
    interface(&mut w, &case.interface);
    for e in &case.effects {
        effect(&mut w, e);
    }
    identify(&mut w, &case.identify);
    diagnose(&mut w, &case.diagnose);
    solver(&mut w, &case.solver);
    output(&mut w, &case.output);
    w.out
}

#[derive(Default)]
struct Writer {
    out: String,
}

impl Writer {
    fn line(&mut self, key: &str, value: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.out, "{key} = {value}");
    }

    fn header(&mut self, header: &str) {
        let _ = writeln!(self.out, "\n{header}");
    }

    fn text(&mut self, key: &str, value: &str) {
        self.line(key, &quoted(value));
    }

    fn number(&mut self, name: &str, quantity: Quantity, x: f64) {
        let (key, numbers) = spell(quantity, name, &[x]);
        self.line(&key, &float(numbers[0]));
    }

    fn optional(&mut self, name: &str, quantity: Quantity, x: Option<f64>) {
        if let Some(x) = x {
            self.number(name, quantity, x);
        }
    }

    fn values(&mut self, name: &str, quantity: Quantity, values: &[Value], held: bool) {
        let all: Vec<f64> = values.iter().flat_map(|v| [v.value, v.min, v.max]).flatten().collect();
        let (key, numbers) = spell(quantity, name, &all);
        self.spelled(&key, values, numbers, held);
    }

    fn spelled(&mut self, key: &str, values: &[Value], numbers: Vec<f64>, held: bool) {
        let mut numbers = numbers.into_iter();
        let mut next = |given: Option<f64>| given.and_then(|_| numbers.next());
        let shown: Vec<_> = values
            .iter()
            .map(|v| {
                value(
                    Value { value: next(v.value), min: next(v.min), max: next(v.max), fixed: v.fixed },
                    held,
                )
            })
            .collect();
        match shown.as_slice() {
            [Some(one)] => self.line(key, one),
            [None] => {
                let _ = writeln!(self.out, "# {key}: the parameter's own start and bounds");
            }
            many => {
                let many: Vec<String> =
                    many.iter().map(|v| v.clone().unwrap_or_else(|| "{}".to_owned())).collect();
                self.line(key, &format!("[{}]", many.join(", ")));
            }
        }
    }
}

/// `{:?}` prints the shortest digits that read back to the same number, always as a TOML float.
fn float(x: f64) -> String {
    format!("{x:?}")
}

fn quoted(text: &str) -> String {
    toml_edit::Value::from(text).to_string().trim().to_owned()
}

/// A parameter's value; `None` if nothing is given. `held`: fixed is what holds anyway.
fn value(v: Value, held: bool) -> Option<String> {
    let fixed = v.fixed.filter(|f| !held || !f);
    match (v.value, v.min, v.max, fixed) {
        (None, None, None, None) => None,
        (Some(x), None, None, None) => Some(float(x)),
        (start, min, max, fixed) => {
            let number = |name: &str, x: Option<f64>| x.map(|x| format!("{name} = {}", float(x)));
            let flag = fixed.map(|f| format!("fixed = {f}"));
            let parts = [number("start", start), number("min", min), number("max", max), flag];
            Some(format!("{{ {} }}", parts.into_iter().flatten().collect::<Vec<_>>().join(", ")))
        }
    }
}

fn rows<const N: usize>(rows: &[[f64; N]]) -> String {
    let row = |r: &[f64; N]| format!("[{}]", r.map(float).join(", "));
    format!("[{}]", rows.iter().map(row).collect::<Vec<_>>().join(", "))
}

fn geometry(w: &mut Writer, g: &Geometry) {
    w.header("[geometry]");
    for (name, x) in [("length", g.length), ("width", g.width), ("thickness", g.thickness), ("cut", g.cut)] {
        w.number(name, Quantity::Length, x);
    }
    w.optional("path_y", Quantity::Length, g.path_y);
    if let Some(outline) = &g.outline {
        w.line("outline_mm", &rows(outline));
    }
    if let Some(profile) = &g.thickness_profile {
        w.line("thickness_profile_mm", &rows(profile));
    }
}

fn test(w: &mut Writer, t: &Test, path: &impl Fn(&Record) -> PathBuf) {
    w.header("[[tests]]");
    w.text("name", &t.name);
    w.text("kind", t.kind.word());
    if let Some(record) = &t.record {
        w.text("data", &path(record).to_string_lossy());
    }
    if let Some(legs) = &t.protocol {
        let leg = |leg: &Leg| match leg {
            Leg::Ramp { to_mm, rate_mm_per_s } => {
                format!("{{ to_mm = {}, rate_mm_per_s = {} }}", float(*to_mm), float(*rate_mm_per_s))
            }
            Leg::Hold { hold_s } => format!("{{ hold_s = {} }}", float(*hold_s)),
        };
        w.line("protocol", &format!("[{}]", legs.iter().map(leg).collect::<Vec<_>>().join(", ")));
    }
    if t.kind.two_axes && t.protocol.is_some() && t.record.is_none() {
        w.line("ratio_x", &float(t.ratio_x));
    }
    w.text("ends", if t.ends == Ends::Clamped { "clamped" } else { "sliding" });
    w.text("grips", if t.grips == Grips::Ends { "ends" } else { "mouth" });
    w.optional("rest", Quantity::Time, t.rest_s);
    w.line("remount", &t.remount.to_string());
    w.line("fresh_piece", &t.fresh_piece.to_string());
    w.optional("force_sd", Quantity::Force, t.force_sd);
    w.optional("force_x_sd", Quantity::Force, t.force_x_sd);
    w.optional("grip_displacement_sd", Quantity::Length, t.grip_displacement_sd);
    w.optional("tear_front_sd", Quantity::Length, t.tear_front_sd);
    w.optional("width_change_sd", Quantity::Length, t.width_change_sd);
    w.optional("tear_front_opening", Quantity::Length, t.tear_front_opening);
    if !t.weights.is_empty() {
        let one = |x: &Weight| {
            let [from, to, weight] = [x.from_s, x.to_s, x.weight].map(float);
            format!("{{ from_s = {from}, to_s = {to}, weight = {weight} }}")
        };
        w.line("weights", &format!("[{}]", t.weights.iter().map(one).collect::<Vec<_>>().join(", ")));
    }
}

fn mesh(w: &mut Writer, m: &MeshConfig) {
    w.header("[mesh]");
    if let Some(d) = m.divisions {
        w.line("divisions", &format!("[{}, {}, {}]", d[0], d[1], d[2]));
    } else {
        w.number("bulk_size", Quantity::Length, m.bulk_size);
        w.number("path_size", Quantity::Length, m.path_size);
        w.line("layers", &m.layers.to_string());
    }
    w.text("symmetry", if m.symmetry == Symmetry::Auto { "auto" } else { "none" });
}

fn bulk(w: &mut Writer, b: &BulkConfig) {
    w.header("[bulk]");
    w.text("law", &b.law);
    for spec in &b.specs {
        law_parameter(w, spec, b.value(&spec.name));
    }
    options(w, &b.options);
}

fn interface(w: &mut Writer, i: &InterfaceConfig) {
    w.header("[interface]");
    w.text("law", &i.law);
    w.line("areas", &i.areas.to_string());
    w.text("profile", if i.profile == Profile::Piecewise { "piecewise" } else { "smooth" });
    for (index, spec) in i.specs.iter().enumerate() {
        match index {
            0 => w.values(&spec.name, spec.quantity, &i.gc, spec.fixed),
            1 => w.values(&spec.name, spec.quantity, &i.sigma_c, spec.fixed),
            _ => law_parameter(w, spec, i.value(&spec.name)),
        }
    }
    options(w, &i.options);
}

/// A parameter of a law, as its reciprocal where that reads back to the same number.
fn law_parameter(w: &mut Writer, spec: &ParamSpec, value: Value) {
    if spec.internal {
        return;
    }
    let reciprocal = spec.reciprocal.and_then(|r| Some((r, spell_reciprocal(&value, r.numerator)?)));
    match reciprocal {
        Some((r, other)) => {
            let numbers = [other.value, other.min, other.max].into_iter().flatten().collect();
            let key = crate::keys::units(r.quantity, r.name)
                .iter()
                .find(|s| s.factor == 1.0)
                .map_or_else(|| r.name.to_owned(), |s| format!("{}_{}", r.name, s.name));
            w.spelled(&key, &[other], numbers, spec.fixed);
        }
        None => w.values(&spec.name, spec.quantity, &[value], spec.fixed),
    }
}

fn options(w: &mut Writer, options: &BTreeMap<String, OptionValue>) {
    for (name, option) in options {
        match option {
            OptionValue::Bool(b) => w.line(name, &b.to_string()),
            OptionValue::Integer(i) => w.line(name, &i.to_string()),
            OptionValue::Number(x) => w.line(name, &float(*x)),
            OptionValue::Text(t) => w.text(name, t),
        }
    }
}

fn effect(w: &mut Writer, e: &EffectConfig) {
    w.header(&format!("[effects.{}]", toml_edit::Key::new(&e.name)));
    for spec in &e.specs {
        match e.parameters.get(spec.name.as_ref()) {
            Some(v) => w.values(&spec.name, spec.quantity, &[*v], false),
            None => {
                let start = float(spec.in_file_unit(spec.start));
                let _ = writeln!(w.out, "# {} = {start}: the parameter's own start", spec.key());
            }
        }
    }
    options(w, &e.options);
}

fn identify(w: &mut Writer, i: &IdentifyConfig) {
    w.header("[identify]");
    w.text("mode", if i.mode == Mode::Staged { "staged" } else { "joint" });
    w.number("tolerance", Quantity::Dimensionless, i.tolerance);
    w.line("max_iterations", &i.max_iterations.to_string());
    w.line("multi_start", &i.multi_start.to_string());
    w.line("coarse_first", &i.coarse_first.to_string());
    w.line("release_bulk", &i.release_bulk.to_string());
    match i.priors.literature {
        Some(on) if i.priors.given.is_empty() => w.line("priors", &on.to_string()),
        None => {
            let _ = writeln!(w.out, "# priors: off to identify, on to diagnose");
            if !i.priors.given.is_empty() {
                w.header("[identify.prior]");
            }
        }
        Some(on) => {
            w.header("[identify.priors]");
            w.line("literature", &on.to_string());
        }
    }
    for (path, prior) in &i.priors.given {
        let (section, name) = path.rsplit_once('.').unwrap_or(("bulk", path));
        let (key, mean) = spell(prior.quantity, name, &[prior.mean]);
        let sd = float(prior.relative_sd);
        w.line(&format!("{section}.{key}"), &format!("{{ mean = {}, relative_sd = {sd} }}", float(mean[0])));
    }
}

fn diagnose(w: &mut Writer, d: &DiagnoseConfig) {
    w.header("[diagnose]");
    w.number("rest", Quantity::Dimensionless, d.rest);
    w.number("practice", Quantity::Dimensionless, d.practice);
    w.number("expected_effects", Quantity::Dimensionless, d.expected_effects);
    w.line("laws", &d.laws.to_string());
}

fn solver(w: &mut Writer, s: &SolverConfig) {
    w.header("[solver]");
    w.optional("step", Quantity::Length, s.step_mm);
    w.text("control", if s.control == Control::Actuator { "actuator" } else { "path" });
    w.number("tolerance", Quantity::Dimensionless, s.tolerance);
    w.line("max_iterations", &s.max_iterations.to_string());
    w.text("integration", if s.integration == Integration::Gauss { "gauss" } else { "nodal" });
}

fn output(w: &mut Writer, o: &OutputConfig) {
    w.header("[output]");
    w.optional("noise", Quantity::Dimensionless, o.noise);
    w.line("seed", &o.seed.to_string());
    w.line("fields", &o.fields.to_string());
    let figure = |f: &Figure| match f {
        Figure::Svg => "\"svg\"",
        Figure::Pdf => "\"pdf\"",
        Figure::Png => "\"png\"",
    };
    w.line("figures", &format!("[{}]", o.figures.iter().map(figure).collect::<Vec<_>>().join(", ")));
}
