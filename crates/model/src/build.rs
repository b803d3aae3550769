//! From a case to models of its tests: meshes, supports, laws, parameters.

use crate::camera::Camera;
use crate::effect::{Action, Bulk, Catalogue, Effect, Interface, Mount, Piece, Sensor, Shape, Site};
use fem::{Blend, Body, Link, MountField, Path, Prescribed, Problem, ShapeField, System};
use input::{Case, Ends, FibreInvariants, Grips, Profile, Symmetry, Test, TestKind, Value};
use mesh::{Mesh, Outline, Sizing, Strip};
use params::{ParamSpec, Parameter};
use std::sync::{Arc, Mutex};
use thiserror::Error;

/// Why a model could not be built.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BuildError {
    /// The mesh.
    #[error("test {test}: {source}")]
    Mesh {
        /// Test.
        test: String,
        /// What the mesher says.
        source: mesh::MeshError,
    },
    /// The finite-element problem.
    #[error("test {test}: {source}")]
    Fem {
        /// Test.
        test: String,
        /// What is wrong.
        source: fem::FemError,
    },
    /// An effect that is not in the catalogue.
    #[error("unknown effect `{0}`")]
    UnknownEffect(String),
    /// Something in the case that no model can be made of.
    #[error("{0}")]
    Case(String),
}

/// An effect in this model.
pub(crate) struct Active {
    pub effect: Arc<dyn Effect>,
    /// θ indices of its parameters.
    pub params: Vec<usize>,
    pub options: crate::effect::Options,
}

/// Specimen and sensor effects with their parameters.
type Shapes = Vec<(Arc<dyn Shape>, Vec<usize>)>;
type Mounts = Vec<(Arc<dyn Mount>, Vec<usize>)>;
type Sensors = Vec<(Arc<dyn Sensor>, Vec<usize>)>;

/// The model of one test.
pub struct TestModel {
    /// The test as the case describes it.
    pub test: Test,
    /// Its mesh.
    pub mesh: Mesh,
    /// Index of the test in the case.
    pub index: usize,
    template: Problem,
    shapes: Shapes,
    mounts: Mounts,
    pub(crate) sensors: Sensors,
    pool: Mutex<Vec<System>>,
}

/// The model of a specimen: one parameter vector, one model per test.
pub struct Model {
    /// The case it was built from.
    pub case: Arc<Case>,
    /// All parameters θ, hidden ones included, in the order of the parameter vector.
    pub parameters: Vec<Parameter>,
    /// Models of the tests, in the order of the case.
    pub tests: Vec<TestModel>,
    pub(crate) active: Vec<Active>,
}

/// How a model is discretised, beyond what the case says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretisation {
    /// Every element cut into this many along each axis.
    pub split: usize,
    /// Element sizes multiplied by this.
    pub coarsen: f64,
    /// Keep the half-height model although an effect breaks the mirror: exact to first order at
    /// the effect's neutral value (a clamp turned by θ against the other is ±θ/2 to the middle).
    pub neutral_halves: bool,
}

impl Default for Discretisation {
    fn default() -> Self {
        Self { split: 1, coarsen: 1.0, neutral_halves: false }
    }
}

impl Model {
    /// Builds the models of all tests of a case.
    ///
    /// # Errors
    /// [`BuildError`] naming the test.
    pub fn new(case: Arc<Case>, catalogue: &Catalogue, how: Discretisation) -> Result<Self, BuildError> {
        let mut builder = Builder::new(&case, catalogue)?;
        let half_height =
            how.neutral_halves || builder.active.iter().all(|a| !a.effect.card().breaks_half_height);
        let tests = case
            .tests
            .iter()
            .enumerate()
            .map(|(index, test)| builder.test(&case, test, index, half_height, how))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { parameters: builder.parameters, active: builder.active, tests, case })
    }

    /// Present parameter values θ.
    pub fn theta(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }

    /// Index of the parameter at a path.
    pub fn find(&self, path: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.path == path)
    }

    /// Indices of the free parameters.
    pub fn free(&self) -> Vec<usize> {
        (0..self.parameters.len()).filter(|&i| self.parameters[i].free).collect()
    }

    /// Whether a parameter is only carried for the law's sake and shown to nobody.
    pub fn is_hidden(&self, index: usize) -> bool {
        let p = &self.parameters[index];
        p.path == "bulk.fibre_onset" && !p.free
    }

    /// The site a parameter acts on.
    pub fn site_of(&self, index: usize) -> Site {
        match self.active.iter().find(|a| a.params.contains(&index)) {
            Some(a) => a.effect.card().site,
            None if self.parameters[index].path.starts_with("bulk.") => Site::Bulk,
            None => Site::Interface,
        }
    }

    /// Names of the effects in the model.
    pub fn effects(&self) -> Vec<String> {
        self.active.iter().map(|a| a.effect.card().name.to_owned()).collect()
    }

    /// Number of areas along the tear path.
    pub fn areas(&self) -> usize {
        self.case.interface.areas
    }
}

/// What is shared by the tests while they are built.
struct Builder {
    parameters: Vec<Parameter>,
    active: Vec<Active>,
    piece: Piece,
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
    fn new(case: &Case, catalogue: &Catalogue) -> Result<Self, BuildError> {
        let mut parameters = Vec::new();
        let law = hgo::Hgo {
            tension_only: case.bulk.tension_only,
            fibre_invariants: match case.bulk.fibre_invariants {
                FibreInvariants::Isochoric => hgo::FibreInvariants::Isochoric,
                FibreInvariants::Full => hgo::FibreInvariants::Full,
            },
        };
        let b = &case.bulk;
        let onset = Value::default();
        let values = [&b.mu, &b.k1, &b.k2, &b.gamma, &b.kappa, &b.d, &onset];
        for (spec, value) in constitutive::Describe::<9>::parameters(&law).into_iter().zip(values) {
            parameters.push(parameter(format!("bulk.{}", spec.name), spec, value));
        }
        let bulk_params = (0..parameters.len()).collect();
        let has_path = case.tests.iter().any(|t| t.kind == TestKind::Tearing);
        let (mut gc, mut sigma_c, mut rest) = (0, 0, Vec::new());
        if has_path {
            let specs = constitutive::Describe::<3>::parameters(&cohesive::Cohesive);
            let i = &case.interface;
            gc = parameters.len();
            for a in 0..i.areas {
                parameters.push(parameter(
                    format!("interface.area[{}].gc", a + 1),
                    specs[cohesive::GC].clone(),
                    &i.gc_of(a),
                ));
            }
            sigma_c = parameters.len();
            for a in 0..i.areas {
                let spec = specs[cohesive::SIGMA_C].clone();
                parameters.push(parameter(
                    format!("interface.area[{}].sigma_c", a + 1),
                    spec,
                    &i.sigma_c_of(a),
                ));
            }
            rest = vec![parameters.len(), parameters.len() + 1];
            parameters.push(parameter("interface.lambda".into(), specs[cohesive::LAMBDA].clone(), &i.lambda));
            parameters.push(parameter(
                "interface.penalty".into(),
                specs[cohesive::PENALTY].clone(),
                &i.penalty,
            ));
        }
        let g = &case.geometry;
        let mut builder = Self {
            parameters,
            active: Vec::new(),
            piece: Piece { length: g.length, width: g.width, thickness: g.thickness, cut: g.cut },
            bulk: Arc::new(law),
            bulk_params,
            interface: Arc::new(cohesive::Cohesive),
            interface_rest: rest,
            gc,
            sigma_c,
            has_path,
        };
        builder.add_effects(case, catalogue)?;
        Ok(builder)
    }

    /// Effects in the order of their rank, so that the file's order cannot matter.
    fn add_effects(&mut self, case: &Case, catalogue: &Catalogue) -> Result<(), BuildError> {
        let mut found = Vec::new();
        for config in &case.effects {
            let effect =
                catalogue.get(&config.name).ok_or_else(|| BuildError::UnknownEffect(config.name.clone()))?;
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
            match effect.act(&config.options, &self.piece) {
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
            self.active.push(Active { effect, params, options: config.options.clone() });
        }
        Ok(())
    }

    fn test(
        &mut self,
        case: &Case,
        test: &Test,
        index: usize,
        half_height: bool,
        how: Discretisation,
    ) -> Result<TestModel, BuildError> {
        let strip = strip_of(case, test, half_height, how)
            .map_err(|source| BuildError::Mesh { test: test.name.clone(), source })?;
        let mesh =
            mesh::strip(&strip).map_err(|source| BuildError::Mesh { test: test.name.clone(), source })?;
        let body = Arc::new(Body::of(&mesh));
        let supports = supports(&mesh, test)?;
        let multiplicity =
            if mesh.half_height { 2.0 } else { 1.0 } * if mesh.half_thickness { 2.0 } else { 1.0 };
        let path = (test.kind == TestKind::Tearing).then(|| self.path(case, &mesh, &body));
        let mut template = Problem {
            body,
            supports: Arc::new(supports),
            multiplicity,
            bulk: self.bulk.clone(),
            bulk_params: self.bulk_params.clone(),
            path,
            train: Vec::new(),
            takeup: Vec::new(),
            shape: Vec::new(),
            mount: Vec::new(),
        };
        let (mut shapes, mut mounts, mut sensors) = (Vec::new(), Vec::new(), Vec::new());
        for a in &self.active {
            match a.effect.act(&a.options, &self.piece) {
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

    /// Law and parameters of every point of the tear path.
    fn path(&self, case: &Case, mesh: &Mesh, body: &Body) -> Path {
        let m = case.interface.areas;
        let rule = match case.solver.integration {
            input::Integration::Gauss => fem::interface::Integration::Gauss,
            input::Integration::Nodal => fem::interface::Integration::Nodal,
        };
        let left = mesh.interfaces.iter().flat_map(|i| i.x).fold(f64::MAX, f64::min) - mesh.cut;
        let span = mesh.path_width - mesh.cut;
        let mut params = Vec::new();
        let mut position = Vec::new();
        for (e, el) in body.cohesive.iter().enumerate() {
            let nodes = el.lower.map(|n| mesh.nodes[n]);
            let at: [f64; 4] =
                std::array::from_fn(|q| (fem::interface::point_x(&nodes, q, rule) - left - mesh.cut) / span);
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

/// Neighbouring area centres and the weight of the second, for the smooth profile.
fn between(at: f64, m: usize) -> (usize, usize, f64) {
    let s = (at * m as f64 - 0.5).clamp(0.0, (m - 1) as f64);
    let a = (s.floor() as usize).min(m - 1);
    (a, (a + 1).min(m - 1), s - a as f64)
}

/// A parameter with what the file says about it.
fn parameter(path: String, mut spec: ParamSpec, value: &Value) -> Parameter {
    spec.lower = value.min.unwrap_or(spec.lower);
    spec.upper = value.max.unwrap_or(spec.upper);
    let free = !value.fixed.unwrap_or(spec.fixed);
    let start = value.value.unwrap_or(spec.start);
    // A start inside the bounds the file gives.
    let start = if value.value.is_none() { start.clamp(spec.lower, spec.upper) } else { start };
    Parameter { path, value: start, free, spec }
}

fn strip_of(
    case: &Case,
    test: &Test,
    half_height: bool,
    how: Discretisation,
) -> Result<Strip, mesh::MeshError> {
    let g = &case.geometry;
    let tear = test.kind == TestKind::Tearing;
    let homogeneous =
        test.ends == Ends::Sliding && !tear && g.outline.is_none() && g.thickness_profile.is_none();
    let alone = case.tests.iter().all(|t| t.kind == TestKind::Uniaxial && t.ends == Ends::Sliding);
    let sizing = match case.mesh.divisions {
        // A homogeneous state needs one element; only a history that later tests inherit needs more.
        _ if homogeneous && alone => Sizing::Divisions([1, 2, 1]),
        Some(d) => Sizing::Divisions(d),
        None => Sizing::Graded {
            bulk_size: case.mesh.bulk_size * how.coarsen,
            path_size: case.mesh.path_size * how.coarsen,
            layers: case.mesh.layers,
        },
    };
    let outline = g.outline.as_ref().map(|o| Outline::new(o)).transpose()?;
    let thickness_profile = g.thickness_profile.clone().map(mesh::Profile::thickness).transpose()?;
    let mut strip = Strip {
        cut: if homogeneous && alone { 0.0 } else { g.cut },
        path_y: g.path_y,
        tear,
        sizing,
        split: how.split,
        outline,
        thickness_profile,
        ..Strip::new(g.length, g.width, g.thickness)
    };
    if case.mesh.symmetry == Symmetry::Auto {
        strip.half_thickness = true;
        let even = case.mesh.divisions.is_none_or(|d| d[1] % 2 == 0) || (homogeneous && alone);
        strip.half_height = half_height && even && strip.is_symmetric(1e-6 * g.length);
    }
    Ok(strip)
}

/// Supports: which components are held, and which follow the grip.
fn supports(mesh: &Mesh, test: &Test) -> Result<Vec<Option<Prescribed>>, BuildError> {
    let mut s: Vec<Option<Prescribed>> = vec![None; 3 * mesh.nodes.len()];
    let share = if mesh.half_height { 0.5 } else { 1.0 };
    let nodes = |name: &str| -> Result<&[usize], BuildError> {
        mesh.set(name)
            .ok_or_else(|| BuildError::Case(format!("test {}: the mesh has no `{name}`", test.name)))
    };
    let mut hold = |n: usize, c: usize, grip: f64| s[3 * n + c] = Some(Prescribed { grip, mount: 0.0 });
    if mesh.half_thickness {
        nodes("mid_thickness")?.iter().for_each(|&n| hold(n, 2, 0.0));
    }
    if mesh.half_height && test.kind == TestKind::Uniaxial {
        nodes("mid_height")?.iter().for_each(|&n| hold(n, 1, 0.0));
    }
    let lateral = test.ends == Ends::Clamped;
    match test.grips {
        Grips::Ends => {
            for &n in nodes("top")? {
                hold(n, 1, share);
                if lateral {
                    hold(n, 0, 0.0);
                    hold(n, 2, 0.0);
                }
            }
            if !mesh.half_height {
                for &n in nodes("bottom")? {
                    hold(n, 1, 0.0);
                    if lateral {
                        hold(n, 0, 0.0);
                        hold(n, 2, 0.0);
                    }
                }
            }
            if !lateral {
                hold_rigid_motion(mesh, &mut hold, nodes("left")?);
            }
        }
        Grips::Mouth => {
            for &n in nodes("mouth_top")? {
                hold(n, 1, share);
                hold(n, 0, 0.0);
            }
            if !mesh.half_height {
                for &n in nodes("mouth_bottom")? {
                    hold(n, 1, 0.0);
                    hold(n, 0, 0.0);
                }
            }
            if !mesh.half_thickness
                && let Some(&n) = nodes("mouth_top")?.first()
            {
                hold(n, 2, 0.0);
            }
        }
    }
    Ok(s)
}

/// Sliding ends leave the strip free to move sideways: one edge is kept straight.
fn hold_rigid_motion(mesh: &Mesh, hold: &mut impl FnMut(usize, usize, f64), left: &[usize]) {
    let homogeneous = mesh.interfaces.is_empty();
    let ends: Vec<usize> = if homogeneous {
        left.to_vec()
    } else {
        left.first().into_iter().chain(left.last()).copied().collect()
    };
    for n in ends {
        hold(n, 0, 0.0);
    }
    if !mesh.half_thickness {
        let low = mesh.nodes.iter().fold(f64::MAX, |m, x| m.min(x[2]));
        for (n, x) in mesh.nodes.iter().enumerate() {
            if (x[2] - low).abs() < 1e-12 && (homogeneous || left.contains(&n)) {
                hold(n, 2, 0.0);
            }
        }
    }
}

impl TestModel {
    /// The problem at parameter values θ: nodes moved, clamp turned.
    pub fn problem(&self, theta: &[f64]) -> Problem {
        let mut p = self.template.clone();
        let pick = |ids: &[usize]| ids.iter().map(|&i| theta[i]).collect::<Vec<f64>>();
        if !self.shapes.is_empty() {
            self.move_nodes(&mut p, &pick);
        }
        if !self.mounts.is_empty() {
            let mut supports = (*p.supports).clone();
            let share = if self.mesh.half_height { 0.5 } else { 1.0 };
            for (mount, ids) in &self.mounts {
                let mut fields: Vec<Vec<(usize, f64)>> = vec![Vec::new(); ids.len()];
                for &n in self.mesh.set("top").unwrap_or_default() {
                    let (offset, by) = mount.offset(self.mesh.nodes[n][0], &pick(ids));
                    if let Some(s) = &mut supports[3 * n + 1] {
                        s.mount += share * offset;
                    }
                    for (f, d) in fields.iter_mut().zip(by) {
                        f.push((3 * n + 1, share * d));
                    }
                }
                p.mount.extend(ids.iter().zip(fields).map(|(&param, field)| MountField { param, field }));
            }
            p.supports = Arc::new(supports);
        }
        p
    }

    fn move_nodes(&self, p: &mut Problem, pick: &dyn Fn(&[usize]) -> Vec<f64>) {
        let mut body = (*p.body).clone();
        for (shape, ids) in &self.shapes {
            let values = pick(ids);
            let mut fields: Vec<Vec<[f64; 3]>> = vec![vec![[0.0; 3]; body.nodes.len()]; ids.len()];
            for (n, x) in body.nodes.iter_mut().enumerate() {
                let (to, by) = shape.position(*x, &values);
                *x = to;
                for (f, d) in fields.iter_mut().zip(by) {
                    f[n] = d;
                }
            }
            p.shape.extend(ids.iter().zip(fields).map(|(&param, field)| ShapeField { param, field }));
        }
        p.body = Arc::new(body);
    }

    /// Whether the problem's geometry depends on θ.
    pub fn moves_nodes(&self) -> bool {
        !self.shapes.is_empty()
    }

    /// Whether the bulk remembers (so that tests of a piece follow each other).
    pub fn has_memory(&self) -> bool {
        !self.template.bulk.history().is_empty()
    }

    /// Whether any law looks at time.
    pub fn rate_dependent(&self) -> bool {
        self.template.rate_dependent()
    }

    /// The camera of this test.
    pub fn camera(&self, areas: usize) -> Camera {
        Camera::new(&self.mesh, areas)
    }

    /// Unknowns of the finite-element problem.
    pub fn unknowns(&self) -> usize {
        self.template.supports.iter().filter(|s| s.is_none()).count()
    }

    /// Takes a solver from the pool, or makes one; its geometry is set to the problem's.
    ///
    /// # Errors
    /// [`BuildError::Fem`].
    pub fn take_system(&self, problem: &Problem) -> Result<System, BuildError> {
        let kept = self.pool.lock().map_or_else(|p| p.into_inner().pop(), |mut p| p.pop());
        match kept {
            Some(mut s) => {
                if self.moves_nodes() {
                    s.set_geometry(problem);
                }
                Ok(s)
            }
            None => System::new(problem)
                .map_err(|source| BuildError::Fem { test: self.test.name.clone(), source }),
        }
    }

    /// Gives a solver back.
    pub fn give_back(&self, system: System) {
        if let Ok(mut pool) = self.pool.lock() {
            pool.push(system);
        }
    }
}
