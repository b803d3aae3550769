//! The stress that the branches follow, and how it varies with the gradient.

use super::super::symmetric::{Frame, Sym};
use super::maxwell::Maxwell;
use crate::decorator::{Call, Tangent};
use constitutive::{FibreFamily, Jet, Law, Over, PointLaw, Scalar, part_response};

/// J^(−1/3) F.
pub(super) fn unimodular<S: Scalar>(f: &[S; 9]) -> [S; 9] {
    let per_root = constitutive::tensor::det(f).cbrt().recip();
    f.map(|x| x * per_root)
}

impl Maxwell {
    /// First Piola stress whose deviator the branches follow: the inner law's own, `inner`; or, of a law that sees the
    /// volume, J^(−1/3) times what it gives at J = 1, so that the incremental stress keeps a potential, Ψ(C̄).
    #[inline(always)]
    pub(super) fn followed<X: Scalar, S: Scalar + Over<X>>(
        &self,
        call: &Call<'_, S, 9>,
        frame: &Frame<X>,
        inner: &[S; 9],
    ) -> [S; 9]
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        if !self.volume_matters {
            return *inner;
        }
        let at_one = call.inner_at(&unimodular(call.gradient), call.base, &mut call.inner_old.to_vec());
        let root = frame.m.sqrt();
        at_one.force.map(|p| p.times(root))
    }

    /// The same with its tangent.
    pub(super) fn followed_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        frame: &Frame<f64>,
        g: &[f64; 9],
        inner: &Tangent<9>,
    ) -> Option<Tangent<9>> {
        if !self.volume_matters {
            return Some(*inner);
        }
        let f = unimodular(call.gradient);
        let (p, a) = call.inner_tangent(&f, call.base, &mut call.inner_old.to_vec())?;
        let root = frame.m.sqrt();
        let mut out = (p.map(|x| root * x), [[0.0; 9]; 9]);
        for (r, row) in out.1.iter_mut().enumerate() {
            // F̄ varies by J^(−1/3) (dF − ⅓ F (F⁻ᵀ : dF)), the factor by −⅓ J^(−1/3) (F⁻ᵀ : dF).
            let along: f64 = a[r].iter().zip(call.gradient).map(|(a, f)| a * f).sum();
            let third = (frame.m * along + out.0[r]) / 3.0;
            for s in 0..9 {
                row[s] = frame.m * a[r][s] - third * g[s];
            }
        }
        Some(out)
    }

    /// The stress that the branches follow: Dev of what the inner law would give without it (the
    /// fictitious stress; what comes of the volume alone has no deviator), or the fibres' fictitious stress as
    /// it is.
    #[inline(always)]
    pub(super) fn driving_stress<X: Scalar, S: Scalar + Over<X>>(
        &self,
        gradient: &[S; 9],
        base: &[S],
        frame: &Frame<X>,
        inner: &[S; 9],
    ) -> Sym<S>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        if let Some(families) = &self.fibres {
            let of = |f: &FibreFamily| {
                let s = part_response(&f.fictitious, gradient, base).force;
                [s[0], s[4], s[8], s[1], s[5], s[2]]
            };
            let sum = |a: Sym<S>, b: Sym<S>| std::array::from_fn(|i| a[i] + b[i]);
            return families.iter().map(of).reduce(sum).unwrap_or([S::zero(); 6]);
        }
        let per_m = frame.m.recip();
        frame.deviator(&frame.second_piola(inner)).map(|x| x.times(per_m))
    }

    /// The driving stress and its derivative by the gradient, with the stress that is followed and its tangent known.
    pub(super) fn driving_along(&self, call: &Call<'_, f64, 9>, followed: &Tangent<9>) -> Sym<Jet<9>> {
        let f: [Jet<9>; 9] = std::array::from_fn(|i| Jet::variable(call.gradient[i], i));
        let p: [Jet<9>; 9] = std::array::from_fn(|i| Jet { re: followed.0[i], eps: followed.1[i] });
        let base: Vec<Jet<9>> = match self.fibres {
            Some(_) => call.base.iter().map(|&x| Jet::constant(x)).collect(),
            None => Vec::new(),
        };
        self.driving_stress(&f, &base, &Frame::new(&f), &p)
    }
}
