//! The battery every law must pass: shared by the tests of all crates, and by a user's own laws.
//!
//! The functions answer with the worst discrepancy they saw, so that a test states its tolerance.

use crate::{Context, Jet, PointLaw, tensor};

/// Responds in plain numbers; returns force, energy and new history.
pub fn respond<const G: usize>(
    law: &dyn PointLaw<G>,
    ctx: &Context,
    gradient: &[f64; G],
    params: &[f64],
    old: &[f64],
) -> ([f64; G], f64, Vec<f64>) {
    let mut new = vec![0.0; old.len()];
    let r = law.respond(ctx, gradient, params, old, &mut new);
    (r.force, r.energy, new)
}

/// The virgin history of a law.
pub fn virgin<const G: usize>(law: &dyn PointLaw<G>) -> Vec<f64> {
    law.history().iter().map(|h| h.initial).collect()
}

/// Worst |tangent by `Jet<9>` − central difference|, relative to the largest tangent entry.
pub fn tangent_error_9(
    law: &dyn PointLaw<9>,
    ctx: &Context,
    f: &[f64; 9],
    params: &[f64],
    old: &[f64],
    h: f64,
) -> f64 {
    let mut new = vec![0.0; old.len()];
    let (_, a) = crate::tangent_by_jets_9(law, ctx, f, params, old, &mut new);
    difference_error(law, ctx, f, params, old, h, |i, j| a[i][j])
}

/// Worst |tangent by `Jet<3>` − central difference|, relative to the largest tangent entry.
pub fn tangent_error_3(
    law: &dyn PointLaw<3>,
    ctx: &Context,
    d: &[f64; 3],
    params: &[f64],
    old: &[f64],
    h: f64,
) -> f64 {
    let mut new = vec![0.0; old.len()];
    let (_, a) = crate::tangent_by_jets_3(law, ctx, d, params, old, &mut new);
    difference_error(law, ctx, d, params, old, h, |i, j| a[i][j])
}

fn difference_error<const G: usize>(
    law: &dyn PointLaw<G>,
    ctx: &Context,
    g: &[f64; G],
    params: &[f64],
    old: &[f64],
    h: f64,
    tangent: impl Fn(usize, usize) -> f64,
) -> f64 {
    let (mut worst, mut scale) = (0.0f64, 0.0f64);
    for j in 0..G {
        let (mut up, mut down) = (*g, *g);
        up[j] += h;
        down[j] -= h;
        let (fu, _, _) = respond(law, ctx, &up, params, old);
        let (fd, _, _) = respond(law, ctx, &down, params, old);
        for i in 0..G {
            let fd = (fu[i] - fd[i]) / (2.0 * h);
            worst = worst.max((tangent(i, j) - fd).abs());
            scale = scale.max(tangent(i, j).abs());
        }
    }
    worst / scale.max(1e-300)
}

/// Worst |analytic tangent − jet tangent| relative to the largest entry; `None` when a law has no
/// analytic tangent.
pub fn analytic_tangent_error<const G: usize>(
    law: &dyn PointLaw<G>,
    ctx: &Context,
    g: &[f64; G],
    params: &[f64],
    old: &[f64],
    by_jets: ([f64; G], [[f64; G]; G]),
) -> Option<f64> {
    let mut new = vec![0.0; old.len()];
    let (force, a) = law.analytic_tangent(ctx, g, params, old, &mut new)?;
    let (jf, ja) = by_jets;
    let scale_a = ja.iter().flatten().fold(1e-300f64, |m, x| m.max(x.abs()));
    let scale_f = jf.iter().fold(1e-300f64, |m, x| m.max(x.abs())).max(1e-12 * scale_a);
    let mut worst = 0.0f64;
    for i in 0..G {
        worst = worst.max((force[i] - jf[i]).abs() / scale_f);
        for j in 0..G {
            worst = worst.max((a[i][j] - ja[i][j]).abs() / scale_a);
        }
    }
    Some(worst)
}

/// Worst |∂force/∂parameter by jets − central difference| relative to the force, for every
/// parameter in turn with relative step `h`.
pub fn parameter_error<const G: usize>(
    law: &dyn PointLaw<G>,
    ctx: &Context,
    g: &[f64; G],
    params: &[f64],
    old: &[f64],
    h: f64,
) -> f64 {
    let mut worst = 0.0f64;
    for k in 0..params.len() {
        let step = h * params[k].abs().max(1e-3);
        let jets: Vec<Jet<1>> = params
            .iter()
            .enumerate()
            .map(|(i, &p)| if i == k { Jet::variable(p, 0) } else { Jet::constant(p) })
            .collect();
        let gj = g.map(Jet::<1>::constant);
        let oj: Vec<Jet<1>> = old.iter().map(|&o| Jet::constant(o)).collect();
        let mut nj = oj.clone();
        let r = law.respond(ctx, &gj, &jets, &oj, &mut nj);
        let (mut up, mut down) = (params.to_vec(), params.to_vec());
        up[k] += step;
        down[k] -= step;
        let (fu, _, _) = respond(law, ctx, g, &up, old);
        let (fd, _, _) = respond(law, ctx, g, &down, old);
        let scale = (0..G).fold(1e-12f64, |m, i| m.max(r.force[i].eps[0].abs()));
        for i in 0..G {
            let fd = (fu[i] - fd[i]) / (2.0 * step);
            worst = worst.max((r.force[i].eps[0] - fd).abs() / scale);
        }
    }
    worst
}

/// Worst |P(Q F) − Q P(F)| relative to |P|, for a rotation Q: frame indifference of a bulk law.
pub fn objectivity_error(
    law: &dyn PointLaw<9>,
    ctx: &Context,
    f: &[f64; 9],
    q: &[f64; 9],
    params: &[f64],
    old: &[f64],
) -> f64 {
    let (p, _, _) = respond(law, ctx, f, params, old);
    let (pq, _, _) = respond(law, ctx, &tensor::mul(q, f), params, old);
    let turned = tensor::mul(q, &p);
    let scale = p.iter().fold(1e-300f64, |m, x| m.max(x.abs()));
    (0..9).fold(0.0f64, |m, i| m.max((pq[i] - turned[i]).abs())) / scale
}

/// A rotation from three Euler angles.
pub fn rotation(a: f64, b: f64, c: f64) -> [f64; 9] {
    let rz = |t: f64| [t.cos(), -t.sin(), 0.0, t.sin(), t.cos(), 0.0, 0.0, 0.0, 1.0];
    let rx = |t: f64| [1.0, 0.0, 0.0, 0.0, t.cos(), -t.sin(), 0.0, t.sin(), t.cos()];
    tensor::mul(&rz(a), &tensor::mul(&rx(b), &rz(c)))
}
