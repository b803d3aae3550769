//! The branches: their history, stress, tangent and energy.

use super::super::isochoric;
use super::super::symmetric::{Frame, Sym, dot, pushed};
use super::super::tangent::{add, add_constant, add_deviatoric, inverse_transposed};
use super::driving::unimodular;
use super::times::Times;
use super::weights::with_weights;
use crate::decorator::{Call, Decoration, Memory, Tangent};
use crate::lists::constants;
use constitutive::{
    Energy, FibreFamily, Law, Over, Part, PointLaw, Response, Scalar, part_response, part_tangent,
};
use params::ParamSpec;

/// History: H of each branch, then the driving stress, the isochoric C and the work on the branches.
pub(super) struct Maxwell {
    pub times: Times,
    /// The law of the fibres, where they alone relax.
    pub fibres: Option<Vec<FibreFamily>>,
    /// Whether the deviator of the inner stress depends on the volume: what relaxes is then asked for at J = 1.
    pub volume_matters: bool,
    /// The part of the volume.
    pub volumetric: Option<Part>,
    /// Initial shear modulus of the matrix, MPa.
    pub matrix_modulus: fn(&[f64]) -> f64,
}

#[inline(always)]
fn read<S: Scalar>(history: &[S], block: usize) -> Sym<S> {
    std::array::from_fn(|i| history[6 * block + i])
}

impl Maxwell {
    const fn stress_block(&self) -> usize {
        self.times.count()
    }
    const fn shape_block(&self) -> usize {
        self.times.count() + 1
    }
    const fn work(&self) -> usize {
        6 * (self.times.count() + 2)
    }

    /// Energy of the springs of the branches, |H|²/(2 g M), with M the secant stiffness of the
    /// inner law in the energy sense, at least that of its matrix.
    fn spring_energy(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> f64 {
        let s = read(new, self.stress_block());
        let psi = match &self.fibres {
            Some(families) => families
                .iter()
                .map(|f| part_response(&f.isochoric, call.gradient, call.base).energy)
                .sum::<f64>(),
            None => {
                let f = if self.volume_matters { unimodular(call.gradient) } else { *call.gradient };
                isochoric(self.volumetric.as_ref(), &f, call.base, &call.inner_probe(&f, inner_new)).energy
            }
        };
        let secant = if psi > 0.0 { dot(&s, &s) / (2.0 * psi) } else { 0.0 };
        let stiffness = secant.max(2.0 * (self.matrix_modulus)(call.base));
        let strength = |b: usize| self.times.of(call.own, b).0;
        (0..self.times.count())
            .filter(|&b| strength(b) > 0.0)
            .map(|b| dot(&read(new, b), &read(new, b)) / (2.0 * strength(b) * stiffness))
            .sum()
    }
}

impl Maxwell {
    /// Exact for a driving stress linear in time within the step, hence stable for any step: an
    /// instantaneous change (dt = 0) loads the branch elastically, a long rest empties it.
    ///
    /// The driving stress derives from an energy of the unimodular C̄; with Dev outside the
    /// incremental stress has a potential and the tangent is symmetric.
    #[inline(always)]
    fn answer<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        let frame = Frame::new(call.gradient);
        let followed = self.followed(call, &frame, &r.force);
        let s = self.driving_stress(call.gradient, call.base, &frame, &followed);
        let sum = self.relax(call, call.own, &frame, &s, new);
        add_pushed(&mut r.force, call.gradient, &frame, &sum);
        r
    }

    /// The same at a constant gradient `f`, where only parameters and history carry derivatives: kinematics in plain
    /// numbers, and all that none of them moves.
    fn at_rest<S: Scalar>(
        &self,
        call: &Call<'_, S, 9>,
        f: &[f64; 9],
        inner_new: &mut [S],
        new: &mut [S],
    ) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        let frame = Frame::new(f);
        let followed = self.followed(call, &frame, &r.force);
        let s = match (constants(&followed), constants(call.base)) {
            (Some(inner), Some(base)) => {
                let inner: [f64; 9] = std::array::from_fn(|i| inner[i]);
                self.driving_stress::<f64, f64>(f, &base[..call.base.len()], &frame, &inner).map(S::from)
            }
            _ => self.driving_stress(call.gradient, call.base, &frame, &followed),
        };
        let sum = match constants(call.own) {
            Some(own) => self.relax(call, &own[..call.own.len()], &frame, &s, new),
            None => self.relax(call, call.own, &frame, &s, new),
        };
        add_pushed(&mut r.force, f, &frame, &sum);
        r
    }

    /// Goes a step: the new history, and ΣH after it, with `s` the driving stress there. The work on the branches, and the
    /// shape that it asks for, are for the ledger alone, which has no derivatives: jets leave them.
    #[inline(always)]
    fn relax<X: Scalar, P: Scalar, S: Scalar + Over<P>>(
        &self,
        call: &Call<'_, S, 9>,
        own: &[P],
        frame: &Frame<X>,
        s: &Sym<S>,
        new: &mut [S],
    ) -> Sym<S> {
        let c: Sym<S> = frame.c.map(|x| S::from((x * frame.m).value()));
        let (s_old, c_old) = (read(call.old, self.stress_block()), read(call.old, self.shape_block()));
        let change: Sym<S> = std::array::from_fn(|i| s[i] - s_old[i]);
        let (mut sum, mut work) = ([S::zero(); 6], S::zero());
        with_weights(self.times, own, call.ctx.dt, |weights| {
            for (b, w) in weights.iter().enumerate() {
                let h: Sym<S> = read(call.old, b);
                for i in 0..6 {
                    let after = h[i].times(w.left) + change[i].times(w.taken);
                    new[6 * b + i] = after;
                    sum[i] += after;
                }
                if S::PLAIN {
                    let mean = |i: usize| (h[i].times(w.kept) + change[i].times(w.rise)) * (c[i] - c_old[i]);
                    work += (mean(0) + mean(1) + mean(2)) * 0.5 + mean(3) + mean(4) + mean(5);
                }
            }
        });
        new[6 * self.stress_block()..][..6].copy_from_slice(s);
        new[6 * self.shape_block()..][..6].copy_from_slice(&c);
        new[self.work()] = call.old[self.work()] + work;
        sum
    }
}

/// force += J^(−2/3) F Dev ΣH.
#[inline(always)]
fn add_pushed<X: Scalar, S: Scalar + Over<X>>(
    force: &mut [S; 9],
    f: &[X; 9],
    frame: &Frame<X>,
    sum: &Sym<S>,
) {
    for (to, added) in force.iter_mut().zip(pushed(f, &frame.deviator(sum))) {
        *to += added.times(frame.m);
    }
}

impl Decoration<9> for Maxwell {
    const NAME: &'static str = "viscoelastic";

    fn parameters(&self) -> Vec<ParamSpec> {
        self.times.parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];
        let mut all = Vec::new();
        for b in 1..=self.times.count() {
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

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        if !S::PLAIN && call.gradient.iter().all(S::is_constant) {
            return self.at_rest(call, &call.gradient.map(S::value), inner_new, new);
        }
        self.answer(call, inner_new, new)
    }

    /// ΣH is linear in the driving stress: what the step starts from stays constant, and the share
    /// that the step adds follows the inner law's own tangent.
    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        new: &mut [f64],
    ) -> Option<Tangent<9>> {
        let inner = call.inner_tangent(call.gradient, call.base, inner_new)?;
        let (frame, g) = (Frame::new(call.gradient), inverse_transposed(call.gradient));
        let followed = self.followed_tangent(call, &frame, &g, &inner)?;
        let s = self.driving_stress(call.gradient, call.base, &frame, &followed.0);
        self.relax(call, call.own, &frame, &s, new);
        let s_old = read(call.old, self.stress_block());
        let (mut constant, mut share) = ([0.0; 6], 0.0);
        with_weights(self.times, call.own, call.ctx.dt, |weights| {
            for (b, w) in weights.iter().enumerate() {
                share += w.taken;
                for i in 0..6 {
                    constant[i] += call.old[6 * b + i] * w.left - w.taken * s_old[i];
                }
            }
        });
        let mut sum = inner;
        add_constant(&mut sum, call.gradient, &g, frame.m, &frame.c, &constant);
        match &self.fibres {
            Some(families) => {
                for f in families {
                    add(&mut sum, share, &part_tangent(&f.isochoric, call.gradient, call.base));
                }
            }
            None => add_deviatoric(&mut sum, share, call.gradient, &g, &followed),
        }
        Some(sum)
    }

    /// Each branch takes its share of what the driving stress varies by, which follows the inner law's own tangent.
    fn history_tangent(&self, call: &Call<'_, f64, 9>, inner: Memory<'_, 9>, own: Memory<'_, 9>) -> bool {
        let Some(tangent) = call.inner_tangent(call.gradient, call.base, inner.new) else { return false };
        let (frame, g) = (Frame::new(call.gradient), inverse_transposed(call.gradient));
        let Some(followed) = self.followed_tangent(call, &frame, &g, &tangent) else { return false };
        if !call.inner_history_tangent(inner) {
            return false;
        }
        let s = self.driving_along(call, &followed);
        self.relax(call, call.own, &frame, &s.map(|x| x.re), own.new);
        own.rows.fill([0.0; 9]);
        with_weights(self.times, call.own, call.ctx.dt, |weights| {
            for (b, w) in weights.iter().enumerate() {
                for (row, s) in own.rows[6 * b..].iter_mut().zip(&s) {
                    *row = s.eps.map(|x| w.taken * x);
                }
            }
        });
        for (row, s) in own.rows[6 * self.stress_block()..].iter_mut().zip(&s) {
            *row = s.eps;
        }
        true
    }

    /// Lost: the work done on the branches less what their springs hold.
    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        // An estimate where fibres stiffen: never more than the work that was put in.
        let springs = self.spring_energy(call, inner_new, new).min(new[self.work()].max(0.0));
        Energy { stored: inner.stored + springs, dissipated: inner.dissipated + new[self.work()] - springs }
    }
}
