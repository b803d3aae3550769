//! Zero-thickness 8-node interface element, and its mirrored half.
//!
//! Opening Δ from the displacement jump; reference area; the normal of a surface between the faces (deformed) only
//! splits Δ into normal and tangential parts, and is varied with them: the virtual work
//! T·δΔ + (t_n Δ_s − δ_n T_s)·δn makes the tangent symmetric and the element free of a spurious
//! moment in closing. In opening with λ = 1 the second term vanishes.

use crate::error::ElementFault;
use constitutive::{Context, Jet, Law, Over, PointLaw, Scalar, tangent_by_jets_3};

/// Integration points of the quadrilateral.
pub const POINTS: usize = 4;

/// Where the traction is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integration {
    /// 2 × 2 Gauss.
    #[default]
    Gauss,
    /// 2 × 2 at the nodes (Newton–Cotes): uncouples neighbouring openings.
    Nodal,
}

impl Integration {
    const fn coordinate(self) -> f64 {
        match self {
            Self::Gauss => 0.577_350_269_189_625_8,
            Self::Nodal => 1.0,
        }
    }
}

/// How an element is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Where the traction is sampled.
    pub sampling: Integration,
    /// Share of the upper face in the surface whose normal splits the opening; ½: the mid-surface. Where one face is folded
    /// back over the other that surface has no normal: the share is then 0, and the normal that of the lower face.
    pub upper: f64,
}

impl From<Integration> for Rule {
    fn from(sampling: Integration) -> Self {
        Self { sampling, upper: 0.5 }
    }
}

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Values of the shape functions and their local derivatives at a point.
struct ShapeFunctions {
    n: [f64; 4],
    dxi: [f64; 4],
    deta: [f64; 4],
}

fn shape(q: usize, rule: Integration) -> ShapeFunctions {
    let (x, e) = (CORNERS[q][0] * rule.coordinate(), CORNERS[q][1] * rule.coordinate());
    ShapeFunctions {
        n: CORNERS.map(|c| 0.25 * (1.0 + c[0] * x) * (1.0 + c[1] * e)),
        dxi: CORNERS.map(|c| 0.25 * c[0] * (1.0 + c[1] * e)),
        deta: CORNERS.map(|c| 0.25 * c[1] * (1.0 + c[0] * x)),
    }
}

fn combine<X: Scalar>(weights: &[f64; 4], v: &[[X; 3]; 4]) -> [X; 3] {
    let mut out = [X::zero(); 3];
    for a in 0..4 {
        for i in 0..3 {
            out[i] += v[a][i] * weights[a];
        }
    }
    out
}

fn cross<X: Scalar>(a: &[X; 3], b: &[X; 3]) -> [X; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot<X: Scalar>(a: &[X; 3], b: &[X; 3]) -> X {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn scaled<X: Scalar>(a: &[X; 3], s: X) -> [X; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

fn minus<X: Scalar>(a: &[X; 3], b: &[X; 3]) -> [X; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Reference x coordinate of a point of the quadrilateral, mm.
pub fn point_x(nodes: &[[f64; 3]; 4], q: usize, rule: Integration) -> f64 {
    combine(&shape(q, rule).n, nodes)[0]
}

/// Shares of the four nodes in a point of the quadrilateral.
pub fn shares(q: usize, rule: Integration) -> [f64; 4] {
    shape(q, rule).n
}

/// Local opening (normal, two tangential) and reference area of point `q`.
struct Opening<X> {
    local: [X; 3],
    frame: [[X; 3]; 3],
    delta: [X; 3],
    g1: [X; 3],
    g2: [X; 3],
    normal_length: X,
    area: X,
}

fn opening<X: Scalar>(
    x: &[[X; 3]; 4],
    lower: &[[X; 3]; 4],
    upper: &[[X; 3]; 4],
    s: &ShapeFunctions,
    share: f64,
) -> Opening<X> {
    let r1 = combine(&s.dxi, x);
    let r2 = combine(&s.deta, x);
    let rn = cross(&r1, &r2);
    let area = dot(&rn, &rn).sqrt();
    let [low, up] = [X::from(1.0 - share), X::from(share)];
    let mid: [[X; 3]; 4] =
        std::array::from_fn(|a| std::array::from_fn(|i| x[a][i] + (lower[a][i] * low + upper[a][i] * up)));
    let g1 = combine(&s.dxi, &mid);
    let g2 = combine(&s.deta, &mid);
    let m = cross(&g1, &g2);
    let normal_length = dot(&m, &m).sqrt();
    let n = scaled(&m, normal_length.recip());
    // Any tangential frame will do (the law is isotropic in the plane): the first is the
    // deformed ξ direction, which never lies along n.
    let t1 = scaled(&g1, dot(&g1, &g1).sqrt().recip());
    let t2 = cross(&n, &t1);
    let delta = minus(&combine(&s.n, upper), &combine(&s.n, lower));
    let local = [dot(&n, &delta), dot(&t1, &delta), dot(&t2, &delta)];
    Opening { local, frame: [n, t1, t2], delta, g1, g2, normal_length, area }
}

/// Openings (normal, two tangential, mm) and reference areas (mm²) of the four points.
pub fn openings(
    x: &[[f64; 3]; 4],
    lower: &[[f64; 3]; 4],
    upper: &[[f64; 3]; 4],
    rule: impl Into<Rule>,
) -> [([f64; 3], f64); POINTS] {
    let rule = rule.into();
    std::array::from_fn(|q| {
        let o = opening(x, lower, upper, &shape(q, rule.sampling), rule.upper);
        (o.local, o.area)
    })
}

/// Residual of the full element: lower nodes, then upper nodes.
///
/// `params[q]`: law parameters at point q; `old`, `new`: histories of the four points in turn.
#[allow(clippy::too_many_arguments)]
pub fn residual<X: Scalar, S: Scalar + Over<X>>(
    law: &(dyn PointLaw<3> + 'static),
    ctx: &[Context; POINTS],
    params: &[Vec<S>; POINTS],
    x: &[[X; 3]; 4],
    lower: &[[X; 3]; 4],
    upper: &[[X; 3]; 4],
    rule: impl Into<Rule>,
    old: &[S],
    new: &mut [S],
) -> [[S; 3]; 8]
where
    dyn PointLaw<3>: Law<S, 3>,
{
    let rule = rule.into();
    let nh = old.len() / POINTS;
    let mut r = [[S::zero(); 3]; 8];
    for q in 0..POINTS {
        let s = shape(q, rule.sampling);
        let o = opening(x, lower, upper, &s, rule.upper);
        let h = q * nh..(q + 1) * nh;
        let local = o.local.map(S::lift);
        let t = law.respond(&ctx[q], &local, &params[q], &old[h.clone()], &mut new[h]).force;
        let t = t.map(|c| c.times(o.area));
        let global: [S; 3] = std::array::from_fn(|i| {
            t[0].times(o.frame[0][i]) + t[1].times(o.frame[1][i]) + t[2].times(o.frame[2][i])
        });
        // Work of the turning normal: (t_n Δ_s − δ_n T_s)/|m|, tangential.
        let moment: [S; 3] = std::array::from_fn(|i| {
            let sliding = o.delta[i] - o.frame[0][i] * o.local[0];
            let shear = global[i] - t[0].times(o.frame[0][i]);
            (t[0].times(sliding) - shear.times(o.local[0])).times(o.normal_length.recip())
        });
        let (g1, g2) = (o.g1.map(S::lift), o.g2.map(S::lift));
        let w1 = cross(&g2, &moment);
        let w2 = cross(&moment, &g1);
        for a in 0..4 {
            for i in 0..3 {
                let turn = w1[i] * s.dxi[a] + w2[i] * s.deta[a];
                let pull = global[i] * s.n[a];
                r[a][i] += turn * (1.0 - rule.upper) - pull;
                r[4 + a][i] += turn * rule.upper + pull;
            }
        }
    }
    r
}

/// Residual (24 forces) of the full element and its 24 × 24 tangent.
pub type ForceAndTangent = ([f64; 24], Box<[[f64; 24]; 24]>);

/// Residual and 24 × 24 tangent of the full element, by three jet sweeps of eight unknowns.
#[allow(clippy::too_many_arguments)]
pub fn tangent(
    element: usize,
    law: &(dyn PointLaw<3> + 'static),
    ctx: &[Context; POINTS],
    params: &[Vec<f64>; POINTS],
    x: &[[f64; 3]; 4],
    u: &[[f64; 3]; 8],
    rule: impl Into<Rule>,
    old: &[f64],
    new: &mut [f64],
) -> Result<ForceAndTangent, ElementFault> {
    let rule = rule.into();
    let lifted: [Vec<Jet<8>>; POINTS] =
        std::array::from_fn(|q| params[q].iter().map(|&p| Jet::constant(p)).collect());
    let xj = x.map(|n| n.map(Jet::<8>::constant));
    let oj: Vec<Jet<8>> = old.iter().map(|&h| Jet::constant(h)).collect();
    let mut nj = oj.clone();
    let mut force = [0.0; 24];
    let mut k = Box::new([[0.0; 24]; 24]);
    for sweep in 0..3 {
        let uj: [[Jet<8>; 3]; 8] = std::array::from_fn(|a| {
            std::array::from_fn(|i| {
                let dof = 3 * a + i;
                if dof / 8 == sweep { Jet::variable(u[a][i], dof % 8) } else { Jet::constant(u[a][i]) }
            })
        });
        let lower: [[Jet<8>; 3]; 4] = std::array::from_fn(|a| uj[a]);
        let upper: [[Jet<8>; 3]; 4] = std::array::from_fn(|a| uj[4 + a]);
        let r = residual(law, ctx, &lifted, &xj, &lower, &upper, rule, &oj, &mut nj);
        for row in 0..24 {
            let j = r[row / 3][row % 3];
            if !j.is_finite() {
                return Err(ElementFault::Interface { element });
            }
            force[row] = j.re;
            k[row][8 * sweep..8 * sweep + 8].copy_from_slice(&j.eps);
        }
    }
    for (out, j) in new.iter_mut().zip(&nj) {
        *out = j.re;
    }
    Ok((force, k))
}

/// Residual of the mirrored element (half-height model): four nodes on the tear path, opening
/// 2 u_y, no sliding. Forces along y only.
#[allow(clippy::too_many_arguments)]
pub fn mirrored_residual<X: Scalar, S: Scalar + Over<X>>(
    law: &(dyn PointLaw<3> + 'static),
    ctx: &[Context; POINTS],
    params: &[Vec<S>; POINTS],
    x: &[[X; 3]; 4],
    uy: &[X; 4],
    rule: impl Into<Rule>,
    old: &[S],
    new: &mut [S],
) -> [S; 4]
where
    dyn PointLaw<3>: Law<S, 3>,
{
    let Rule { sampling, .. } = rule.into();
    let nh = old.len() / POINTS;
    let mut r = [S::zero(); 4];
    for q in 0..POINTS {
        let s = shape(q, sampling);
        let rn = cross(&combine(&s.dxi, x), &combine(&s.deta, x));
        let area = dot(&rn, &rn).sqrt();
        let mut d = X::zero();
        for a in 0..4 {
            d += uy[a] * (2.0 * s.n[a]);
        }
        let local = [S::lift(d), S::zero(), S::zero()];
        let h = q * nh..(q + 1) * nh;
        let t = law.respond(&ctx[q], &local, &params[q], &old[h.clone()], &mut new[h]).force[0].times(area);
        for a in 0..4 {
            r[a] += t * s.n[a];
        }
    }
    r
}

/// Residual and 4 × 4 tangent of the mirrored element.
#[allow(clippy::too_many_arguments)]
pub fn mirrored_tangent(
    element: usize,
    law: &(dyn PointLaw<3> + 'static),
    ctx: &[Context; POINTS],
    params: &[Vec<f64>; POINTS],
    x: &[[f64; 3]; 4],
    uy: &[f64; 4],
    rule: impl Into<Rule>,
    old: &[f64],
    new: &mut [f64],
) -> Result<([f64; 4], [[f64; 4]; 4]), ElementFault> {
    let Rule { sampling, .. } = rule.into();
    let nh = old.len() / POINTS;
    let (mut r, mut k) = ([0.0; 4], [[0.0; 4]; 4]);
    for q in 0..POINTS {
        let s = shape(q, sampling);
        let rn = cross(&combine(&s.dxi, x), &combine(&s.deta, x));
        let area = dot(&rn, &rn).sqrt();
        let d: f64 = (0..4).map(|a| 2.0 * s.n[a] * uy[a]).sum();
        let local = [d, 0.0, 0.0];
        let h = q * nh..(q + 1) * nh;
        let (t, c) =
            match law.analytic_tangent(&ctx[q], &local, &params[q], &old[h.clone()], &mut new[h.clone()]) {
                Some(done) => done,
                None => tangent_by_jets_3(law, &ctx[q], &local, &params[q], &old[h.clone()], &mut new[h]),
            };
        if !(t[0].is_finite() && c[0][0].is_finite()) {
            return Err(ElementFault::Interface { element });
        }
        for a in 0..4 {
            r[a] += t[0] * area * s.n[a];
            for b in 0..4 {
                k[a][b] += 2.0 * c[0][0] * area * s.n[a] * s.n[b];
            }
        }
    }
    Ok((r, k))
}
