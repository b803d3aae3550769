//! What is solved: body, supports, laws, and which parameter goes where.

use crate::error::FemError;
use crate::interface::{self, Rule};
use constitutive::{Context, PointLaw, Scalar};
use mesh::Mesh;
use std::sync::Arc;

/// Topology and reference positions.
#[derive(Clone, Debug)]
pub struct Body {
    /// Reference positions, mm.
    pub nodes: Vec<[f64; 3]>,
    /// Bricks, VTK order.
    pub hexes: Vec<[usize; 8]>,
    /// Interface elements: lower quad, and the upper one unless the path is a mirror.
    pub cohesive: Vec<CohesiveElement>,
    /// Nodes in elimination order (nested dissection).
    pub order: Vec<usize>,
}

/// A zero-thickness quadrilateral on the tear path.
#[derive(Clone, Debug)]
pub struct CohesiveElement {
    /// Lower side; in a mirrored model the nodes of the upper half.
    pub lower: [usize; 4],
    /// Upper side; `None` in a mirrored model (opening 2 u_y).
    pub upper: Option<[usize; 4]>,
}

impl Body {
    /// The body of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self {
            nodes: mesh.nodes.clone(),
            hexes: mesh.hexes.clone(),
            cohesive: mesh
                .interfaces
                .iter()
                .map(|i| CohesiveElement { lower: i.lower, upper: i.upper })
                .collect(),
            order: mesh::nested_dissection(mesh),
        }
    }
}

/// A prescribed displacement component: u = grip · u_grip + mount.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prescribed {
    /// Share of the grip displacement.
    pub grip: f64,
    /// Displacement at grip displacement zero, mm (a turned clamp).
    pub mount: f64,
}

/// A point on the way of a piece into the clamps: displacement (mm) of degrees of freedom that are held.
pub type Waypoint = Vec<(usize, f64)>;

/// A force that is measured: a sum of the forces on held degrees of freedom, (degree of freedom, weight). Faces that the
/// tear path reaches have none.
pub type Reaction = Vec<(usize, f64)>;

/// A law parameter at a point: (1 − w) θ_a + w θ_b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// First parameter.
    pub a: usize,
    /// Second parameter.
    pub b: usize,
    /// Weight of the second; exactly 0 gives θ_a to the bit.
    pub w: f64,
}

impl Blend {
    /// A single parameter.
    pub const fn one(a: usize) -> Self {
        Self { a, b: a, w: 0.0 }
    }
    fn of<S: Scalar>(self, theta: &[S]) -> S {
        if self.w == 0.0 { theta[self.a] } else { theta[self.a] * (1.0 - self.w) + theta[self.b] * self.w }
    }
}

/// The tear path: law, integration, and the parameters of each point.
#[derive(Clone)]
pub struct Path {
    /// Traction law.
    pub law: Arc<dyn PointLaw<3>>,
    /// How its elements are evaluated.
    pub rule: Rule,
    /// For each element and point: one entry per law parameter.
    pub params: Vec<[Vec<Blend>; interface::POINTS]>,
    /// For each element and point: position along the path, 0 at the cut, 1 at the far edge.
    pub position: Vec<[f64; interface::POINTS]>,
}

/// A one-dimensional law with its parameters: part of the load train or of its take-up.
#[derive(Clone)]
pub struct Link {
    /// Force → elongation (load train), or actuator displacement → taken-up displacement.
    pub law: Arc<dyn PointLaw<1>>,
    /// Parameter of each law parameter.
    pub params: Vec<usize>,
}

/// Nodes moved by a geometry parameter: ∂X/∂θ per node.
#[derive(Clone, Debug)]
pub struct ShapeField {
    /// Parameter.
    pub param: usize,
    /// ∂X/∂θ, mm per unit of the parameter.
    pub field: Vec<[f64; 3]>,
}

/// Prescribed displacements that depend on a parameter: ∂mount/∂θ per degree of freedom.
#[derive(Clone, Debug)]
pub struct MountField {
    /// Parameter.
    pub param: usize,
    /// (degree of freedom, ∂mount/∂θ).
    pub field: Vec<(usize, f64)>,
}

/// A complete quasi-static problem. Parameters θ are passed separately.
#[derive(Clone)]
pub struct Problem {
    /// Geometry.
    pub body: Arc<Body>,
    /// Per degree of freedom (3 per node): `None` = free.
    pub supports: Arc<Vec<Option<Prescribed>>>,
    /// Where the held faces pass by while the piece is mounted, in order; the supports are the end of that way. Empty for
    /// a piece that needs no turning.
    pub waypoints: Arc<Vec<Waypoint>>,
    /// Forces that are measured beside the work-conjugate one.
    pub reactions: Arc<Vec<Reaction>>,
    /// Whole specimen over modelled part: 4 for a quarter model. Scales force and energies.
    pub multiplicity: f64,
    /// Bulk law.
    pub bulk: Arc<dyn PointLaw<9>>,
    /// θ index of each bulk law parameter.
    pub bulk_params: Vec<usize>,
    /// Tear path, if there is one.
    pub path: Option<Path>,
    /// Load train between grip and actuator, in series: elongations add.
    pub train: Vec<Link>,
    /// Actuator displacement → displacement offered to train and tissue, applied in order; may remember where it was, not
    /// when.
    pub takeup: Vec<Link>,
    /// Geometry parameters.
    pub shape: Vec<ShapeField>,
    /// Mounting parameters.
    pub mount: Vec<MountField>,
}

/// Law parameters, gathered from θ.
#[derive(Clone)]
pub struct LocalParams<S> {
    /// Bulk law.
    pub bulk: Vec<S>,
    /// Each interface element and point.
    pub path: Vec<[Vec<S>; interface::POINTS]>,
    /// Each load-train link.
    pub train: Vec<Vec<S>>,
    /// Each take-up link.
    pub takeup: Vec<Vec<S>>,
}

impl Problem {
    /// Gathers the parameters of every law from θ.
    pub fn local<S: Scalar>(&self, theta: &[S]) -> LocalParams<S> {
        let pick = |ids: &[usize]| ids.iter().map(|&i| theta[i]).collect::<Vec<S>>();
        LocalParams {
            bulk: pick(&self.bulk_params),
            path: self.path.as_ref().map_or_else(Vec::new, |p| {
                p.params
                    .iter()
                    .map(|points| std::array::from_fn(|q| points[q].iter().map(|b| b.of(theta)).collect()))
                    .collect()
            }),
            train: self.train.iter().map(|l| pick(&l.params)).collect(),
            takeup: self.takeup.iter().map(|l| pick(&l.params)).collect(),
        }
    }

    /// History entries per bulk point.
    pub fn bulk_history(&self) -> usize {
        self.bulk.history().len()
    }

    /// History entries per interface point.
    pub fn path_history(&self) -> usize {
        self.path.as_ref().map_or(0, |p| p.law.history().len())
    }

    /// Whether any law looks at time.
    pub fn rate_dependent(&self) -> bool {
        self.bulk.rate_dependent()
            || self.path.as_ref().is_some_and(|p| p.law.rate_dependent())
            || self.train.iter().any(|l| l.law.rate_dependent())
    }

    /// The contexts of the four points of interface element `e`.
    pub fn path_context(&self, ctx: &Context, e: usize) -> [Context; interface::POINTS] {
        let at = self.path.as_ref().map_or([0.5; interface::POINTS], |p| p.position[e]);
        at.map(|path_position| Context { path_position, ..*ctx })
    }

    /// The displacement offered to train and tissue, s(u_actuator). `old` and `new` are the whole history of the rig: what
    /// take-ups remember stands behind what the train does.
    ///
    /// A take-up that remembers keeps its last answer. Along a followed path, where the actuator goes back by itself and no hand turns it,
    /// such a take-up moves with the actuator; `from` is then where the actuator stood before.
    pub fn take_up<S: Scalar>(
        &self,
        actuator: S,
        from: Option<f64>,
        params: &[Vec<S>],
        old: &[S],
        new: &mut [S],
    ) -> S
    where
        dyn PointLaw<1>: constitutive::Law<S, 1>,
    {
        let ctx = Context::default();
        let mut at = self.train.iter().map(|l| l.law.history().len()).sum();
        let (mut u, mut before) = (actuator, from.map(S::from));
        for (link, p) in self.takeup.iter().zip(params) {
            let here = at..at + link.law.history().len();
            at = here.end;
            let asked = |u: S, old: &[S], new: &mut [S]| {
                constitutive::Law::respond(&*link.law, &ctx, &[u], p, old, new).force[0]
            };
            match before {
                Some(y) if !here.is_empty() => {
                    new[here.start] = old[here.start] + (u - y);
                    (u, before) = (new[here.start], Some(old[here.start]));
                }
                _ => {
                    before = before.map(|y| asked(y, &[], &mut []));
                    u = asked(u, &old[here.clone()], &mut new[here]);
                }
            }
        }
        u
    }

    /// Checks that sizes agree.
    ///
    /// # Errors
    /// [`FemError::Setup`] naming what does not fit.
    pub fn check(&self) -> Result<(), FemError> {
        let setup = |ok: bool, text: &str| if ok { Ok(()) } else { Err(FemError::Setup(text.into())) };
        setup(self.supports.len() == 3 * self.body.nodes.len(), "supports do not match the nodes")?;
        setup(
            self.bulk_params.len() == self.bulk.parameters().len(),
            "bulk parameters do not match the law",
        )?;
        let cohesive = self.body.cohesive.len();
        setup(
            self.path.as_ref().map_or(0, |p| p.params.len()) == cohesive,
            "interface parameters do not match",
        )?;
        setup(
            self.path.as_ref().map_or(0, |p| p.position.len()) == cohesive,
            "interface positions do not match",
        )?;
        setup(self.takeup.iter().all(|l| !l.law.rate_dependent()), "a take-up law does not look at time")?;
        setup(
            self.takeup.iter().all(|l| l.law.history().len() < 2),
            "a take-up law remembers its last answer, and no more",
        )
    }
}
