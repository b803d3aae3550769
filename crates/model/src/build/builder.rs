//! Parameters, composed laws and effects of a case, and the model of each test made from them.

use super::turned::turned;
use super::{Active, BaseLaws, BuildError, Discretisation, TestModel};
use crate::catalogue::{Catalogue, FLAT_SHEET};
use crate::effect::{Action, Bulk, Interface, Piece};
use experiments::{Experiment, Setting, SupportFault};
use fem::{Blend, Body, Link, Path, Problem};
use input::{Case, Geometry, Layout, Profile, Test, Value};
use mesh::Mesh;
use params::{ParamPath, ParamSpec, Parameter};
use std::sync::{Arc, Mutex};

/// What is shared by the tests while they are built.
pub(super) struct Builder {
    pub(super) parameters: Vec<Parameter>,
    pub(super) active: Vec<Active>,
    piece: Piece,
    pub(super) base: BaseLaws,
    bulk: Bulk,
    bulk_params: Vec<usize>,
    interface: Interface,
    /// θ indices of the interface law's parameters behind gc and σc.
    interface_rest: Vec<usize>,
    gc: usize,
    sigma_c: usize,
    has_path: bool,
}

impl Builder {
    pub(super) fn new(case: &Case, catalogue: &Catalogue, idle_neutral: bool) -> Result<Self, BuildError> {
        let mut parameters = Vec::new();
        let bulk =
            law_of("bulk", &case.bulk.law, catalogue.laws().bulk(&case.bulk.law))?.law(&case.bulk.options);
        for spec in bulk.parameters() {
            let value = case.bulk.value(&spec.name);
            parameters.push(parameter(ParamPath::bulk(&spec.name).to_string(), spec, &value));
        }
        let bulk_params = (0..parameters.len()).collect();
        let i = &case.interface;
        let interface = law_of("interface", &i.law, catalogue.laws().interface(&i.law))?.law(&i.options);
        let has_path = case.tests.iter().any(|t| t.kind.tears);
        let (mut gc, mut sigma_c, mut rest) = (0, 0, Vec::new());
        if has_path {
            let specs = interface.parameters();
            let mut per_area = |at: usize, value: &dyn Fn(usize) -> Value| {
                let first = parameters.len();
                for a in 0..i.areas {
                    let path = ParamPath::area(a + 1, &specs[at].name).to_string();
                    parameters.push(parameter(path, specs[at].clone(), &value(a)));
                }
                first
            };
            gc = per_area(cohesive::GC, &|a| i.gc_of(a));
            sigma_c = per_area(cohesive::SIGMA_C, &|a| i.sigma_c_of(a));
            for spec in specs.into_iter().skip(cohesive::LAMBDA) {
                rest.push(parameters.len());
                let value = i.value(&spec.name);
                parameters.push(parameter(format!("interface.{}", spec.name), spec, &value));
            }
        }
        let mut builder = Self {
            parameters,
            active: Vec::new(),
            piece: piece_of(&case.geometry, Layout::Sheet),
            base: BaseLaws {
                mirrors: bulk.offers().bulk.is_none_or(|b| b.mirrors),
                bulk: bulk.clone(),
                cohesion: interface.offers().cohesion,
                path: [gc, sigma_c].into_iter().chain(rest.iter().copied()).filter(|_| has_path).collect(),
            },
            bulk,
            bulk_params,
            interface,
            interface_rest: rest,
            gc,
            sigma_c,
            has_path,
        };
        builder.add_effects(case, catalogue, idle_neutral)?;
        Ok(builder)
    }

    /// Whether half the height is enough: no effect that takes part breaks the mirror.
    pub(super) fn half_height(&self, how: Discretisation) -> bool {
        let whole = |a: &Active| !a.idle && a.effect.card().breaks_half_height;
        self.base.mirrors && (how.neutral_halves || !self.active.iter().any(whole))
    }

    /// What an experiment may look at when it says what is meshed.
    pub(super) fn setting<'a>(
        &self,
        case: &'a Case,
        test: &'a Test,
        half_height: bool,
        how: Discretisation,
    ) -> Setting<'a> {
        let mirrors = self.base.mirrors;
        Setting { case, test, half_height, mirrors, split: how.split, coarsen: how.coarsen }
    }

    /// Entries of the bulk's history at a point.
    pub(super) fn bulk_history(&self) -> usize {
        self.bulk.history().len()
    }

    /// Effects in the order of their rank, so that the file's order cannot matter.
    fn add_effects(
        &mut self,
        case: &Case,
        catalogue: &Catalogue,
        idle_neutral: bool,
    ) -> Result<(), BuildError> {
        let mut found = Vec::new();
        for config in &case.effects {
            let effect =
                catalogue.get(&config.name).ok_or_else(|| BuildError::UnknownEffect(config.name.clone()))?;
            if let Some(lacking) = catalogue.lacking(&**effect, &config.options, &case.bulk, &case.interface)
            {
                return Err(BuildError::Case(format!(
                    "effect `{}` cannot act on this model: {lacking}",
                    config.name
                )));
            }
            found.push((effect.clone(), config));
        }
        found.sort_by_key(|(e, _)| (e.card().site, e.card().rank, e.card().name));
        for (effect, config) in found {
            let first = self.parameters.len();
            for spec in effect.parameters(&config.options) {
                let value = config.parameters.get(spec.name.as_ref()).copied().unwrap_or_default();
                self.parameters.push(parameter(
                    format!("effects.{}.{}", config.name, spec.name),
                    spec,
                    &value,
                ));
            }
            let params: Vec<usize> = (first..self.parameters.len()).collect();
            // The amplitude comes first and has a neutral value; what has none is void there.
            let own = &self.parameters[first..];
            let neutral = |p: &Parameter| p.spec.neutral.is_none_or(|n| n == p.value);
            let amplitude = own.first().is_some_and(|p| p.spec.neutral.is_some());
            let idle = idle_neutral && amplitude && own.iter().all(neutral);
            match effect.act(&config.options, &self.piece) {
                _ if idle => {}
                Action::Bulk(wrap) => {
                    self.bulk = wrap(self.bulk.clone());
                    self.bulk_params.extend(&params);
                }
                Action::Interface(wrap) if self.has_path => {
                    self.interface = wrap(self.interface.clone());
                    self.interface_rest.extend(&params);
                }
                _ => {}
            }
            self.active.push(Active { effect, params, options: config.options.clone(), idle });
        }
        Ok(())
    }

    pub(super) fn test(
        &mut self,
        case: &Case,
        catalogue: &Catalogue,
        test: &Test,
        index: usize,
        half_height: bool,
        how: Discretisation,
    ) -> Result<TestModel, BuildError> {
        let experiment = experiment_of(catalogue, test)?;
        let mesh = experiment
            .strip(&self.setting(case, test, half_height, how))
            .and_then(|strip| mesh::strip(&strip))
            .map_err(|source| BuildError::mesh(case, &test.name, source))?;
        let body = Arc::new(Body::of(&mesh));
        let no_set = |fault: SupportFault| {
            BuildError::Case(format!("test {}: the mesh has no `{}`", test.name, fault.set))
        };
        let supports = experiment.supports(&mesh, test).map_err(no_set)?;
        let waypoints = experiment.waypoints(&mesh).map_err(no_set)?;
        let multiplicity =
            if mesh.half_height { 2.0 } else { 1.0 } * if mesh.half_thickness { 2.0 } else { 1.0 };
        let path = test.kind.tears.then(|| self.path(case, &mesh, &body, experiment.one_face_turns()));
        let mut template = Problem {
            body,
            supports: Arc::new(supports),
            waypoints: Arc::new(waypoints),
            reactions: Arc::new(experiment.reactions(&mesh)),
            multiplicity,
            bulk: turned(&self.bulk, test.kind.layout),
            bulk_params: self.bulk_params.clone(),
            path,
            train: Vec::new(),
            takeup: Vec::new(),
            shape: Vec::new(),
            mount: Vec::new(),
        };
        let (piece, flat) = (piece_of(&case.geometry, test.kind.layout), test.kind.layout == Layout::Sheet);
        let (mut shapes, mut mounts, mut sensors) = (Vec::new(), Vec::new(), Vec::new());
        for a in self.active.iter().filter(|a| !a.idle) {
            match a.effect.act(&a.options, &piece) {
                _ if test.kind.two_axes && a.effect.card().site.is_of_one_axis() => {}
                Action::Mount(_) if !test.kind.clamped_faces => {}
                Action::Shape(_) if !flat && a.effect.card().needs.contains(&FLAT_SHEET) => {}
                Action::Train(law) => template.train.push(Link { law, params: a.params.clone() }),
                Action::TakeUp(law) => template.takeup.push(Link { law, params: a.params.clone() }),
                Action::Shape(s) => shapes.push((s, a.params.clone())),
                Action::Mount(m) => mounts.push((m, a.params.clone())),
                Action::Sensor(s) => sensors.push((s, a.params.clone())),
                Action::Bulk(_) | Action::Interface(_) => {}
            }
        }
        template.check().map_err(|source| BuildError::Fem { test: test.name.clone(), source })?;
        Ok(TestModel {
            test: test.clone(),
            mesh,
            index,
            template,
            shapes,
            mounts,
            sensors,
            pool: Mutex::new(Vec::new()),
        })
    }

    /// Law and parameters of every point of the tear path; `one_turns`: its lower face keeps its direction.
    fn path(&self, case: &Case, mesh: &Mesh, body: &Body, one_turns: bool) -> Path {
        let m = case.interface.areas;
        let sampling = match case.solver.integration {
            input::Integration::Gauss => fem::interface::Integration::Gauss,
            input::Integration::Nodal => fem::interface::Integration::Nodal,
        };
        let rule = fem::interface::Rule { sampling, upper: if one_turns { 0.0 } else { 0.5 } };
        let left = mesh.interfaces.iter().flat_map(|i| i.x).fold(f64::MAX, f64::min) - mesh.cut;
        let span = mesh.path_width - mesh.cut;
        let mut params = Vec::new();
        let mut position = Vec::new();
        for (e, el) in body.cohesive.iter().enumerate() {
            let nodes = el.lower.map(|n| mesh.nodes[n]);
            let at: [f64; 4] = std::array::from_fn(|q| {
                (fem::interface::point_x(&nodes, q, sampling) - left - mesh.cut) / span
            });
            let area = mesh.area(e, m);
            let point = |q: usize| -> Vec<Blend> {
                let (a, b, w) = match case.interface.profile {
                    Profile::Piecewise => (area, area, 0.0),
                    Profile::Smooth => between(at[q], m),
                };
                let blend = |base: usize| Blend { a: base + a, b: base + b, w };
                let mut list = vec![blend(self.gc), blend(self.sigma_c)];
                list.extend(self.interface_rest.iter().map(|&i| Blend::one(i)));
                list
            };
            params.push(std::array::from_fn(point));
            position.push(at);
        }
        Path { law: self.interface.clone(), rule, params, position }
    }
}

/// The piece as an effect may see it: along and across the load, as it lies in the model of a test.
fn piece_of(g: &Geometry, layout: Layout) -> Piece {
    let [width, length, thickness] = layout.extents(g);
    Piece { length, width, thickness, cut: g.cut }
}

/// The experiment of a test, or that there is none of this name.
pub(super) fn experiment_of<'a>(
    catalogue: &'a Catalogue,
    test: &Test,
) -> Result<&'a dyn Experiment, BuildError> {
    let found = catalogue.experiments().get(test.kind.word());
    let unknown =
        || BuildError::Case(format!("test {}: unknown experiment `{}`", test.name, test.kind.word()));
    found.map(|e| &**e).ok_or_else(unknown)
}

/// The law of a site, or that there is none of this name.
fn law_of<'a, L>(site: &str, name: &str, found: Option<&'a L>) -> Result<&'a L, BuildError> {
    found.ok_or_else(|| BuildError::Case(format!("unknown law `{name}` in [{site}]")))
}

/// Neighbouring area centres and the weight of the second, for the smooth profile.
fn between(at: f64, m: usize) -> (usize, usize, f64) {
    let s = (at * m as f64 - 0.5).clamp(0.0, (m - 1) as f64);
    let a = (s.floor() as usize).min(m - 1);
    (a, (a + 1).min(m - 1), s - a as f64)
}

/// How far a search may go where the file gives the bound of one side, and the law's other bound lies on the wrong side of it.
const BEYOND: f64 = 1e3;

/// A parameter with what the file says about it.
fn parameter(path: String, mut spec: ParamSpec, value: &Value) -> Parameter {
    let (lower, upper) = (spec.lower, spec.upper);
    spec.lower = value.min.unwrap_or(lower);
    spec.upper = value.max.unwrap_or(upper);
    // A bound of the file that lies beyond the law's other end takes that end along.
    if spec.lower >= spec.upper {
        match (value.min, value.max) {
            (None, Some(max)) => spec.lower = max / BEYOND,
            (Some(min), None) => spec.upper = min * BEYOND,
            _ => {}
        }
    }
    // k2 = 0, κ = 0, γ = 90°: the user chose a limit of the law; a search over orders of magnitude cannot start there.
    let held_at_limit =
        value.fixed.is_none() && !spec.fixed && value.value.is_some_and(|v| spec.transform.is_limit(v));
    let free = !held_at_limit && !value.fixed.unwrap_or(spec.fixed);
    let start = value.value.unwrap_or(spec.start);
    // A start inside the bounds the file gives.
    let start = if value.value.is_none() { start.clamp(spec.lower, spec.upper) } else { start };
    Parameter { path, value: start, free, held_at_limit, spec }
}
