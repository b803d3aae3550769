//! The battery every effect passes: how laws are built, driven along a history, and compared.
#![allow(dead_code, missing_docs)]

use constitutive::{Context, Jet, Law, PointLaw};
use model::{Action, Bulk, Effect, Interface, Options, Piece, Scales, Site};
use std::sync::Arc;

pub const PIECE: Piece = Piece { length: 10.0, width: 6.0, thickness: 0.8, cut: 1.0 };

/// Sizes of an ordinary case (FCT-1 like).
pub const SCALES: Scales = Scales {
    peak_force: 0.9,
    uniaxial_peak: 0.11,
    displacement: 4.6,
    uniaxial_displacement: 1.1,
    duration: 300.0,
    sampling: 0.5,
    energy: 2e-2,
    delta_c: 0.5,
    sigma_c: 0.2,
    opening_rate: 0.02,
    fibre_strain: 0.25,
};

/// μ, k1, k2, γ, κ, D, onset.
pub const TISSUE: [f64; 7] = [5.1e-3, 0.9, 20.0, 0.67, 0.23, 0.1, 0.0];
/// Gc, σc, λ, K.
pub const TEAR: [f64; 4] = [0.25, 0.2, 1.0, 10.0];

pub type Steps<const G: usize> = Vec<(Context, [f64; G])>;

pub fn effects() -> Vec<Arc<dyn Effect>> {
    effects::catalogue().iter().cloned().collect()
}

pub fn named(name: &str) -> Arc<dyn Effect> {
    effects::catalogue().get(name).expect("in the catalogue").clone()
}

pub fn wrap_bulk(effect: &dyn Effect, inner: Bulk) -> Option<Bulk> {
    wrap_bulk_with(effect, &Options::new(), inner)
}

pub fn wrap_bulk_with(effect: &dyn Effect, options: &Options, inner: Bulk) -> Option<Bulk> {
    match effect.act(options, &PIECE) {
        Action::Bulk(wrap) => Some(wrap(inner)),
        _ => None,
    }
}

pub fn wrap_interface(effect: &dyn Effect, inner: Interface) -> Option<Interface> {
    match effect.act(&Options::new(), &PIECE) {
        Action::Interface(wrap) => Some(wrap(inner)),
        _ => None,
    }
}

/// Ordinary values of an effect in force.
pub fn active(effect: &dyn Effect) -> Vec<f64> {
    effect.start(&SCALES)
}

/// Deterministic numbers in [−1, 1).
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Load, unload, reload beyond, hold, rest, on a state of stretch with shear.
pub fn stretching(seed: u64) -> Steps<9> {
    let mut r = Numbers::new(seed);
    let shear: [f64; 9] = std::array::from_fn(|_| 0.06 * r.next());
    let stretches = [0.0, 0.05, 0.11, 0.16, 0.09, 0.03, 0.1, 0.19, 0.19, 0.19, 0.02, 0.21];
    let durations = [0.0, 1.0, 2.0, 1.0, 3.0, 1.0, 2.0, 4.0, 20.0, 60.0, 1e9, 0.0];
    let mut time = 0.0;
    stretches
        .into_iter()
        .zip(durations)
        .map(|(e, dt)| {
            time += if dt < 1e6 { dt } else { 0.0 };
            let lateral = 1.0 / (1.0f64 + e).sqrt();
            let mut f = [lateral, 0.0, 0.0, 0.0, 1.0 + e, 0.0, 0.0, 0.0, lateral];
            for (f, s) in f.iter_mut().zip(&shear) {
                *f += s * e / 0.2;
            }
            (Context { dt, time, path_position: 0.5 }, f)
        })
        .collect()
}

/// Open, close in part, reopen beyond, hold, close to contact, reopen; with sliding.
pub fn opening(seed: u64) -> Steps<3> {
    let mut r = Numbers::new(seed);
    let slide = [0.3 * r.next(), 0.3 * r.next()];
    let openings = [0.0, 0.2, 0.5, 0.9, 0.5, 0.3, 0.7, 1.3, 1.3, 0.4, -0.01, -0.02, 0.6, 2.0];
    let durations = [0.0, 5.0, 5.0, 10.0, 5.0, 2.0, 5.0, 10.0, 60.0, 10.0, 5.0, 1.0, 0.0, 10.0];
    let mut time = 0.0;
    openings
        .into_iter()
        .zip(durations)
        .map(|(n, dt): (f64, f64)| {
            time += dt;
            let o = n.max(0.1);
            (Context { dt, time, path_position: 0.3 }, [n, slide[0] * o, slide[1] * o])
        })
        .collect()
}

/// What a law answers along a history.
pub struct Trace<S, const G: usize> {
    pub force: Vec<[S; G]>,
    pub energy: Vec<S>,
    pub history: Vec<Vec<S>>,
}

/// Drives a law in plain numbers.
pub fn drive<const G: usize>(law: &dyn PointLaw<G>, params: &[f64], steps: &Steps<G>) -> Trace<f64, G> {
    let mut old: Vec<f64> = law.history().iter().map(|h| h.initial).collect();
    let mut t = Trace { force: vec![], energy: vec![], history: vec![] };
    for (ctx, g) in steps {
        let mut new = vec![f64::NAN; old.len()];
        let r = Law::<f64, G>::respond(law, ctx, g, params, &old, &mut new);
        assert!(new.iter().all(|x| x.is_finite()), "history not written or not finite");
        t.force.push(r.force);
        t.energy.push(r.energy);
        t.history.push(new.clone());
        old = new;
    }
    t
}

/// Drives a law with parameter `seed` and the gradient moving along `along`, in jets through the
/// whole history: total derivatives.
pub fn drive_jets<const G: usize>(
    law: &dyn PointLaw<G>,
    params: &[f64],
    steps: &Steps<G>,
    seed: usize,
    along: &[f64; G],
) -> Trace<Jet<1>, G> {
    let mut p: Vec<Jet<1>> = params.iter().map(|&x| Jet::constant(x)).collect();
    p[seed].eps[0] = 1.0;
    let mut old: Vec<Jet<1>> = law.history().iter().map(|h| Jet::constant(h.initial)).collect();
    let mut t = Trace { force: vec![], energy: vec![], history: vec![] };
    for (ctx, g) in steps {
        let gj: [Jet<1>; G] = std::array::from_fn(|i| Jet { re: g[i], eps: [along[i]] });
        let mut new = vec![Jet::constant(f64::NAN); old.len()];
        let r = Law::<Jet<1>, G>::respond(law, ctx, &gj, &p, &old, &mut new);
        t.force.push(r.force);
        t.energy.push(r.energy);
        t.history.push(new.clone());
        old = new;
    }
    t
}

/// Worst |jets − differences| over a history, relative to the largest derivative of all steps.
/// Outside the bounds a law need not exist, so that at a bound the difference is one-sided.
pub fn column_error<const G: usize>(
    law: &dyn PointLaw<G>,
    params: &[f64],
    steps: &Steps<G>,
    seed: usize,
    along: &[f64; G],
    h: f64,
) -> f64 {
    let spec = &law.parameters()[seed];
    let exact = drive_jets(law, params, steps, seed, along);
    let at = |d: f64| {
        let mut p = params.to_vec();
        p[seed] += d;
        let moved = steps.iter().map(|(c, g)| (*c, std::array::from_fn(|i| g[i] + d * along[i]))).collect();
        drive(law, &p, &moved).force
    };
    let one_sided = |s: f64| {
        let (f0, f1, f2, f3) = (at(0.0), at(s * h), at(2.0 * s * h), at(3.0 * s * h));
        combine(&[(&f0, -11.0 / 6.0), (&f1, 3.0), (&f2, -1.5), (&f3, 1.0 / 3.0)], s * h)
    };
    let difference: Vec<[f64; G]> = if params[seed] - h < spec.lower {
        one_sided(1.0)
    } else if params[seed] + h > spec.upper {
        one_sided(-1.0)
    } else {
        combine(&[(&at(h), 0.5), (&at(-h), -0.5)], h)
    };
    // Below this a difference of such forces is rounding.
    let largest = at(0.0).iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
    let (mut worst, mut scale) = (0.0f64, (1e-10 * largest / h).max(1e-300));
    for (e, d) in exact.force.iter().zip(&difference) {
        for i in 0..G {
            worst = worst.max((e[i].eps[0] - d[i]).abs());
            assert!(e[i].eps[0].is_finite(), "derivative not finite");
            scale = scale.max(d[i].abs());
        }
    }
    worst / scale
}

fn combine<const G: usize>(terms: &[(&Vec<[f64; G]>, f64)], h: f64) -> Vec<[f64; G]> {
    (0..terms[0].0.len())
        .map(|s| std::array::from_fn(|i| terms.iter().map(|(f, w)| w * f[s][i]).sum::<f64>() / h))
        .collect()
}

/// Cuts every step into `n`, gradients and times linear within.
pub fn refine<const G: usize>(steps: &Steps<G>, n: usize) -> Steps<G> {
    let mut out = vec![steps[0]];
    for pair in steps.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for i in 1..=n {
            let w = i as f64 / n as f64;
            let ctx = Context { dt: b.0.dt / n as f64, time: a.0.time + w * (b.0.time - a.0.time), ..b.0 };
            out.push((ctx, std::array::from_fn(|k| a.1[k] + w * (b.1[k] - a.1[k]))));
        }
    }
    out
}

/// External work at every step by the trapezoid, and stored and dissipated energy.
pub fn ledger<const G: usize>(law: &dyn PointLaw<G>, params: &[f64], steps: &Steps<G>) -> Vec<[f64; 3]> {
    let t = drive(law, params, steps);
    let virgin: Vec<f64> = law.history().iter().map(|h| h.initial).collect();
    let mut work = 0.0;
    (0..steps.len())
        .map(|s| {
            let old = if s == 0 { &virgin } else { &t.history[s - 1] };
            if s > 0 {
                for i in 0..G {
                    work += 0.5 * (t.force[s][i] + t.force[s - 1][i]) * (steps[s].1[i] - steps[s - 1].1[i]);
                }
            }
            let e = law.energies(&steps[s].0, &steps[s].1, params, old, &t.history[s]);
            [work, e.stored, e.dissipated]
        })
        .collect()
}

pub fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|v| v.to_bits()).collect()
}

pub fn base_bulk() -> Bulk {
    Arc::new(hgo::Hgo::default())
}

pub fn base_interface() -> Interface {
    Arc::new(cohesive::Cohesive)
}

pub fn all(site: Site) -> Vec<Arc<dyn Effect>> {
    let mut list: Vec<_> = effects().into_iter().filter(|e| e.card().site == site).collect();
    list.sort_by_key(|e| e.card().rank);
    list
}

pub fn joined(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().chain(b).copied().collect()
}

pub fn off_switches<const G: usize>(steps: Steps<G>) -> Steps<G> {
    let moved = |i: usize, s: usize| match (G, i) {
        (9, 4) => 1.02 + 1e-3 * (s % 3) as f64,
        (9, _) => 1.0,
        _ => 1.0 + 1e-3 * (s % 3) as f64,
    };
    // A closed tear is a switch too: it starts a little open.
    let shift = |i: usize| if G == 3 && i == 0 { 0.003 } else { 0.0 };
    steps
        .into_iter()
        .enumerate()
        .map(|(s, (c, g))| (c, std::array::from_fn(|i| g[i] * moved(i, s) + shift(i))))
        .collect()
}

pub fn step(value: f64, plausible: f64) -> f64 {
    2e-4 * value.abs().max(plausible.abs()).max(1e-9)
}
