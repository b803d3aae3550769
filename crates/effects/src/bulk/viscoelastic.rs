//! Stress that relaxes: Maxwell branches on the isochoric stress, or on the fibres alone.

use super::base::base_law;
use super::by_hand::{add, add_constant, add_deviatoric, inverse_transposed};
use super::isochoric;
use super::symmetric::{Frame, Sym, dot, pushed};
use crate::decorator::{Call, Decoration, Tangent, decorate};
use crate::numeric::{add_scaled, decay, mean_decay, mean_rise};
use crate::settings::{choice, integer, spread, word};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use hgo::{FAMILIES, FibreInvariants, Hgo};
use input::{OptionKind, OptionSpec, OptionValue};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const TAU_BOUNDS: (f64, f64) = (1e-2, 1e5);
const MOST_BRANCHES: i64 = 4;

static CARD: Card = Card {
    name: "viscoelastic",
    site: Site::Bulk,
    rank: 30,
    summary: "Stress relaxes while the tissue is held and rises with the rate of stretching. The \
              base parameters are the long-term (slow) response.",
    law: "S = S_inner + J^(−2/3) Dev ΣH_i,  Ḣ_i + H_i/τ_i = g_i d(J^(2/3) S_iso)/dt,  \
          S_iso = isochoric 2nd Piola stress of the inner law,  Dev A = A − ⅓ (A : C) C⁻¹;  \
          relaxing = \"fibres\": driven by 2 ∂Ψ_fibres/∂C̄ instead",
    reference: "Simo 1987, Comput. Methods Appl. Mech. Eng. 60, doi:10.1016/0045-7825(87)90107-1; \
                Holzapfel & Gasser 2001, Comput. Methods Appl. Mech. Eng. 190",
    shows_in: &["hold", "rate change", "unload", "reload"],
    look_alikes: &["lag"],
    separated_by: "a hold of several τ at constant displacement: a late sensor settles within its delay, tissue relaxes on",
    excludes: &[],
    // Loops of unloading show it without a pause, but not well.
    needs: &["pause or two rates"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// One to four Maxwell branches on the isochoric stress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Viscoelastic;

/// What the option `relaxing` may say.
const ALL: &str = "all";
const FIBRES: &str = "fibres";

fn branches(options: &Options) -> usize {
    integer(options, "branches", 1).clamp(1, MOST_BRANCHES) as usize
}

fn settings(branches: i64, relaxing: &str) -> Options {
    Options::from([
        ("branches".to_owned(), OptionValue::Integer(branches)),
        ("relaxing".to_owned(), OptionValue::Text(relaxing.to_owned())),
    ])
}

fn own_parameters(branches: usize) -> Vec<ParamSpec> {
    let tau = |start| {
        ParamSpec::new("tau", "τ", Quantity::Time, TAU_BOUNDS, start, "relaxation time of the branch")
    };
    let g = || {
        ParamSpec::new(
            "g",
            "g",
            Quantity::Dimensionless,
            (0.0, 5.0),
            0.2,
            "instantaneous over long-term stress, less one",
        )
        .neutral(0.0)
    };
    (0..branches)
        .flat_map(|b| {
            let mut pair = [g(), tau(10f64.powi(b as i32 + 1))];
            if b > 0 {
                for p in &mut pair {
                    p.name = format!("{}{}", p.name, b + 1).into();
                    p.symbol = format!("{}{}", p.symbol, ['₂', '₃', '₄'][b - 1]).into();
                }
            }
            pair
        })
        .collect()
}

impl Effect for Viscoelastic {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, options: &Options) -> Vec<ParamSpec> {
        own_parameters(branches(options))
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![
            OptionSpec {
                name: "branches".into(),
                kind: OptionKind::Integer { min: 1, max: MOST_BRANCHES },
                default: Some(OptionValue::Integer(1)),
                description: "number of relaxation branches; the second is g2, tau2, and so on".into(),
            },
            choice("relaxing", &[ALL, FIBRES], "the whole isochoric stress relaxes, or the fibres' alone"),
        ]
    }

    /// The fibres alone, whose stress no matrix tempers; or two branches a decade apart around the
    /// one that was found: tissue hardly relaxes with one time.
    fn richer(&self, options: &Options, values: &[f64]) -> Vec<(Options, Vec<f64>)> {
        let relaxing = word(options, "relaxing", ALL);
        let mut forms = Vec::new();
        if relaxing == ALL {
            forms.push((settings(branches(options) as i64, FIBRES), values.to_vec()));
        }
        if let [g, tau] = *values {
            let within = |tau: f64| tau.clamp(TAU_BOUNDS.0, TAU_BOUNDS.1);
            forms.push((settings(2, relaxing), vec![0.5 * g, within(tau / 3.0), 0.5 * g, within(3.0 * tau)]));
        }
        forms
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // What a record can tell lies between two samples and the whole test.
        let low = (2.0 * scales.sampling).max(scales.duration / 300.0);
        spread(low, scales.duration, 6)
            .into_iter()
            .map(|tau| vec![0.0, tau.clamp(TAU_BOUNDS.0, TAU_BOUNDS.1)])
            .collect()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![0.2, (scales.duration / 15.0).clamp(TAU_BOUNDS.0, TAU_BOUNDS.1)]
    }

    fn act(&self, options: &Options, _piece: &Piece) -> Action {
        let branches = branches(options);
        let fibres_alone = word(options, "relaxing", ALL) == FIBRES;
        Action::Bulk(Box::new(move |inner| {
            let base = Hgo { fibre_invariants: FibreInvariants::Isochoric, ..base_law(&inner) };
            let fibres = fibres_alone.then_some(base);
            Arc::new(decorate(inner, Maxwell { branches, fibres }))
        }))
    }
}

/// History: H of each branch, then the driving stress, the isochoric C and the work on the branches.
struct Maxwell {
    branches: usize,
    /// The law of the fibres, where they alone relax.
    fibres: Option<Hgo>,
}

#[inline(always)]
fn read<S: Scalar>(history: &[S], block: usize) -> Sym<S> {
    std::array::from_fn(|i| history[6 * block + i])
}

impl Maxwell {
    const fn stress_block(&self) -> usize {
        self.branches
    }
    const fn shape_block(&self) -> usize {
        self.branches + 1
    }
    const fn work(&self) -> usize {
        6 * (self.branches + 2)
    }

    /// Energy of the springs of the branches, |H|²/(2 g M), with M the secant stiffness of the
    /// inner law in the energy sense, at least that of its matrix.
    fn spring_energy(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> f64 {
        let s = read(new, self.stress_block());
        let psi = match &self.fibres {
            Some(law) => (0..FAMILIES)
                .map(|k| hgo::fibre_response(law, call.gradient, call.base, k).energy)
                .sum::<f64>(),
            None => isochoric(call.gradient, call.base, &call.inner_probe(call.gradient, inner_new)).energy,
        };
        let secant = if psi > 0.0 { dot(&s, &s) / (2.0 * psi) } else { 0.0 };
        let stiffness = secant.max(2.0 * call.base[hgo::MU]);
        (0..self.branches)
            .filter(|&b| call.own[2 * b] > 0.0)
            .map(|b| dot(&read(new, b), &read(new, b)) / (2.0 * call.own[2 * b] * stiffness))
            .sum()
    }
}

impl Maxwell {
    /// The stress that the branches follow: Dev of what the inner law would give without it (the
    /// fictitious stress; what comes of the volume alone has no deviator), or the fibres' fictitious stress as
    /// it is.
    #[inline(always)]
    fn driving_stress<S: Scalar>(&self, call: &Call<'_, S, 9>, frame: &Frame<S>, inner: &[S; 9]) -> Sym<S> {
        if let Some(law) = &self.fibres {
            let [a, b]: [Sym<S>; FAMILIES] =
                std::array::from_fn(|k| hgo::fibre_fictitious_stress(law, call.gradient, call.base, k));
            return std::array::from_fn(|i| a[i] + b[i]);
        }
        let per_m = frame.m.recip();
        frame.deviator(&frame.second_piola(inner)).map(|x| x * per_m)
    }

    /// Goes a step: the new history, and ΣH after it. `inner` is the first Piola stress without the branches.
    #[inline(always)]
    fn relax<S: Scalar>(
        &self,
        call: &Call<'_, S, 9>,
        frame: &Frame<S>,
        inner: &[S; 9],
        new: &mut [S],
    ) -> Sym<S> {
        let s = self.driving_stress(call, frame, inner);
        let c = frame.c.map(|x| x * frame.m);
        let (s_old, c_old) = (read(call.old, self.stress_block()), read(call.old, self.shape_block()));
        let (mut sum, mut work) = ([S::zero(); 6], S::zero());
        for b in 0..self.branches {
            let (g, x) = (call.own[2 * b], S::from(call.ctx.dt) / call.own[2 * b + 1]);
            let (left, kept) = (decay(x), mean_decay(x));
            let (taken, rise) = (g * kept, g * mean_rise(x));
            let mut mean = [S::zero(); 6];
            for i in 0..6 {
                let (h, change) = (call.old[6 * b + i], s[i] - s_old[i]);
                new[6 * b + i] = h * left + change * taken;
                sum[i] += new[6 * b + i];
                mean[i] = (h * kept + change * rise) * (c[i] - c_old[i]);
            }
            work += (mean[0] + mean[1] + mean[2]) * 0.5 + mean[3] + mean[4] + mean[5];
        }
        new[6 * self.stress_block()..][..6].copy_from_slice(&s);
        new[6 * self.shape_block()..][..6].copy_from_slice(&c);
        new[self.work()] = call.old[self.work()] + work;
        sum
    }
}

impl Decoration<9> for Maxwell {
    const NAME: &'static str = "viscoelastic";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters(self.branches)
    }

    fn history(&self) -> Vec<(String, f64)> {
        const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];
        let mut all = Vec::new();
        for b in 1..=self.branches {
            all.extend(COMPONENTS.map(|c| (format!("h{b}_{c}"), 0.0)));
        }
        all.extend(COMPONENTS.map(|c| (format!("s_iso_{c}"), 0.0)));
        all.extend(
            COMPONENTS
                .map(|c| (format!("c_iso_{c}"), if c.as_bytes()[0] == c.as_bytes()[1] { 1.0 } else { 0.0 })),
        );
        all.push(("work".into(), 0.0));
        all
    }

    fn rate_dependent(&self) -> bool {
        true
    }

    /// Exact for a driving stress linear in time within the step, hence stable for any step: an
    /// instantaneous change (dt = 0) loads the branch elastically, a long rest empties it.
    ///
    /// The driving stress derives from an energy of the unimodular C̄; with Dev outside the
    /// incremental stress has a potential and the tangent is symmetric.
    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        let frame = Frame::new(call.gradient);
        let sum = self.relax(call, &frame, &r.force, new);
        add_scaled(&mut r.force, frame.m, &pushed(call.gradient, &frame.deviator(&sum)));
        r
    }

    /// ΣH is linear in the driving stress: what the step starts from stays constant, and the share
    /// that the step adds follows the inner law's own tangent.
    fn hand_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        new: &mut [f64],
    ) -> Option<Tangent<9>> {
        let inner = call.inner_tangent(call.gradient, call.base, inner_new)?;
        let (frame, g) = (Frame::new(call.gradient), inverse_transposed(call.gradient));
        self.relax(call, &frame, &inner.0, new);
        let s_old = read(call.old, self.stress_block());
        let (mut constant, mut share) = ([0.0; 6], 0.0);
        for b in 0..self.branches {
            let (g, x) = (call.own[2 * b], call.ctx.dt / call.own[2 * b + 1]);
            let (left, taken) = (decay(x), g * mean_decay(x));
            share += taken;
            for i in 0..6 {
                constant[i] += call.old[6 * b + i] * left - taken * s_old[i];
            }
        }
        let mut sum = inner;
        add_constant(&mut sum, call.gradient, &g, frame.m, &frame.c, &constant);
        match &self.fibres {
            Some(law) => {
                for k in 0..FAMILIES {
                    add(&mut sum, share, &hgo::fibre_tangent(law, call.gradient, call.base, k));
                }
            }
            None => add_deviatoric(&mut sum, share, call.gradient, &g, &inner),
        }
        Some(sum)
    }

    /// Lost: the work done on the branches less what their springs hold.
    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        // An estimate where fibres stiffen: never more than the work that was put in.
        let springs = self.spring_energy(call, inner_new, new).min(new[self.work()].max(0.0));
        Energy { stored: inner.stored + springs, dissipated: inner.dissipated + new[self.work()] - springs }
    }
}
