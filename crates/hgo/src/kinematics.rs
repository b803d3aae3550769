//! What every part of the law needs from F, computed once, and the form all its stresses share.

use constitutive::{Over, Response, Scalar, tensor};

/// A symmetric tensor without xz and yz components: all that two families in the x–y plane need.
#[derive(Clone, Copy)]
pub(crate) struct Planar<S> {
    pub xx: S,
    pub yy: S,
    pub zz: S,
    pub xy: S,
}

impl<S: Scalar> Planar<S> {
    pub fn zero() -> Self {
        Self::spherical(S::zero())
    }

    /// a · I.
    pub fn spherical(a: S) -> Self {
        Self { xx: a, yy: a, zz: a, xy: S::zero() }
    }

    pub fn scaled(self, a: S) -> Self {
        Self { xx: self.xx * a, yy: self.yy * a, zz: self.zz * a, xy: self.xy * a }
    }

    pub fn plus(self, o: Self) -> Self {
        Self { xx: self.xx + o.xx, yy: self.yy + o.yy, zz: self.zz + o.zz, xy: self.xy + o.xy }
    }

    /// Contraction of two such tensors.
    pub fn dot<X: Scalar>(&self, o: &Planar<X>) -> S
    where
        S: Over<X>,
    {
        self.xx.times(o.xx) + self.yy.times(o.yy) + self.zz.times(o.zz) + self.xy.times(o.xy) * 2.0
    }

    /// F · self.
    #[inline(always)]
    pub fn pushed<X: Scalar>(&self, f: &[X; 9]) -> [S; 9]
    where
        S: Over<X>,
    {
        let mut out = [S::zero(); 9];
        for i in [0, 3, 6] {
            out[i] = self.xx.times(f[i]) + self.xy.times(f[i + 1]);
            out[i + 1] = self.xy.times(f[i]) + self.yy.times(f[i + 1]);
            out[i + 2] = self.zz.times(f[i + 2]);
        }
        out
    }
}

/// F and what follows from it.
pub(crate) struct Kinematics<S> {
    pub f: [S; 9],
    /// cof F = ∂J/∂F.
    pub cof: [S; 9],
    /// J = det F.
    pub j: S,
    /// J^(−2/3).
    pub m: S,
    /// C − I without its xz and yz components. Exactly zero at F = I, so that the fibre switch
    /// there is not decided by rounding.
    pub c_minus_i: Planar<S>,
}

impl<S: Scalar> Kinematics<S> {
    /// Everything is NaN when det F is not positive: the caller of the law sees a non-finite
    /// answer whichever part it asks for.
    #[inline(always)]
    pub fn new(f: &[S; 9]) -> Self {
        let (mut f, mut cof) = (*f, tensor::cofactor(f));
        let mut j = f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2];
        let in_domain = j.value() > 0.0;
        if !in_domain {
            let nan = S::from(f64::NAN);
            (f, cof, j) = ([nan; 9], [nan; 9], nan);
        }
        let root = j.cbrt();
        let column = |a: usize, b: usize| f[a] * f[b] + f[a + 3] * f[b + 3] + f[a + 6] * f[b + 6];
        let c_minus_i = Planar {
            xx: column(0, 0) - 1.0,
            yy: column(1, 1) - 1.0,
            zz: column(2, 2) - 1.0,
            xy: column(0, 1),
        };
        Self { f, cof, j, m: (root * root).recip(), c_minus_i }
    }

    /// I1 − 3.
    pub fn i1_minus_3(&self) -> S {
        self.c_minus_i.xx + self.c_minus_i.yy + self.c_minus_i.zz
    }
}

/// A contribution to the stress, P = F · `along` + `across` · cof F, and to the energy.
#[derive(Clone, Copy)]
pub(crate) struct Part<S> {
    pub along: Planar<S>,
    pub across: S,
    pub energy: S,
}

impl<S: Scalar> Part<S> {
    pub fn zero() -> Self {
        Self { along: Planar::zero(), across: S::zero(), energy: S::zero() }
    }

    pub fn plus(self, o: Self) -> Self {
        Self {
            along: self.along.plus(o.along),
            across: self.across + o.across,
            energy: self.energy + o.energy,
        }
    }

    /// The first Piola stress and the energy.
    #[inline(always)]
    pub fn response<X: Scalar>(&self, kin: &Kinematics<X>) -> Response<S, 9>
    where
        S: Over<X>,
    {
        let mut force = self.along.pushed(&kin.f);
        for (p, c) in force.iter_mut().zip(&kin.cof) {
            *p += self.across.times(*c);
        }
        Response { force, energy: self.energy }
    }
}
