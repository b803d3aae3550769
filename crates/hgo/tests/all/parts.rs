//! The parts that other laws are built of: fibre directions, a family's fictitious stress, tangents of single parts.

use crate::common;

use common::*;
use constitutive::{Describe, Jet, Part, Response, part_response, part_tangent, tensor};
use hgo::{
    D, FAMILIES, FIBRE_ONSET, FibreInvariants, Hgo, K1, KAPPA, fibre_direction, fibre_fictitious_stress,
    fibre_response, fibre_strain, fibre_tangent, volumetric, volumetric_tangent,
};
use proptest::prelude::*;

/// F as jets, one seed per component.
fn seeded(f: &[f64; 9]) -> [Jet<9>; 9] {
    std::array::from_fn(|i| Jet::variable(f[i], i))
}

/// Worst difference of a stress and analytic tangent from a response in jets, relative to the larger entries.
fn error(analytic: &([f64; 9], [[f64; 9]; 9]), jets: &Response<Jet<9>, 9>) -> f64 {
    let floor = largest(jets.force.iter().flat_map(|x| &x.eps));
    let stress = difference(&analytic.0, &jets.force.map(|x| x.re), 1e-3 * floor);
    analytic.1.iter().zip(&jets.force).map(|(a, p)| difference(a, &p.eps, floor)).fold(stress, f64::max)
}

proptest! {
    /// Aligned fibres see the stretch of their own direction: I4 = |F a|².
    #[test]
    fn an_aligned_family_is_strained_as_its_direction_is(f in deformations(), mut p in parameters()) {
        (p[KAPPA], p[FIBRE_ONSET]) = (0.0, 0.0);
        let full = Hgo { fibre_invariants: FibreInvariants::Full, ..Hgo::default() };
        for family in 0..FAMILIES {
            let a = fibre_direction(p[hgo::GAMMA], family);
            let stretched: f64 = tensor::apply(&f, &a).iter().map(|x| x * x).sum();
            prop_assert!((fibre_strain(&full, &f, &p, family) - (stretched - 1.0)).abs() < 1e-13);
        }
    }

    /// P = J^(−2/3) F (S̄ − (S̄ : C) C⁻¹/3) of a family, whichever invariants the law asks for.
    #[test]
    fn the_deviator_of_the_fictitious_stress_is_the_familys_stress(law in laws(), f in deformations(), p in parameters()) {
        let isochoric = Hgo { fibre_invariants: FibreInvariants::Isochoric, ..law };
        let (c, j) = (tensor::right_cauchy_green(&f), tensor::det(&f));
        let inverse = tensor::inverse(&c);
        for family in 0..FAMILIES {
            let [xx, yy, zz, xy, yz, xz] = fibre_fictitious_stress(&law, &f, &p, family);
            let s = [xx, xy, xz, xy, yy, yz, xz, yz, zz];
            let third = tensor::dot(&s, &c) / 3.0;
            let deviator = std::array::from_fn(|i| j.powf(-2.0 / 3.0) * (s[i] - third * inverse[i]));
            let stress = fibre_response(&isochoric, &f, &p, family).force;
            prop_assert!(difference(&tensor::mul(&f, &deviator), &stress, 1e-3 * largest(&s)) < 1e-12);
        }
    }

    #[test]
    fn tangents_of_single_parts_are_those_of_their_jets(law in laws(), f in deformations(), p in parameters()) {
        let (g, q) = (seeded(&f), p.map(Jet::constant));
        prop_assert!(error(&volumetric_tangent(&f, p[D]), &volumetric(&g, q[D])) < 1e-12);
        for family in 0..FAMILIES {
            let jets = fibre_response(&law, &g, &q, family);
            prop_assert!(error(&fibre_tangent(&law, &f, &p, family), &jets) < 1e-12);
        }
    }

    /// What the law offers to others: parts that make up its stress, with the tangents of their stresses.
    #[test]
    fn offered_parts_make_up_the_law(law in laws(), f in deformations(), p in parameters()) {
        let bulk = law.offers().bulk.expect("bulk parts");
        let volumetric = bulk.volumetric.expect("a volumetric part");
        prop_assert_eq!(bulk.fibres.len(), FAMILIES);
        let with = |k: usize, v: f64| {
            let mut q = p;
            q[k] = v;
            respond(&law, &f, &q).force
        };
        let whole = respond(&law, &f, &p).force;
        // U is proportional to 1/D; without k1 there are no families.
        let doubled = with(D, 0.5 * p[D]);
        let own = part_response(&volumetric, &f, &p).force;
        let summed = |parts: &[&Part]| -> [f64; 9] {
            parts.iter().map(|part| part_response(part, &f, &p).force).fold([0.0; 9], |a, b| std::array::from_fn(|i| a[i] + b[i]))
        };
        let families: Vec<&Part> = bulk.fibres.iter().map(|family| &family.response).collect();
        let fibres = summed(&families);
        let without = with(K1, 0.0);
        let scale = [&whole, &doubled, &own, &fibres].map(largest).into_iter().fold(0.0, f64::max);
        for i in 0..9 {
            prop_assert!((doubled[i] - whole[i] - own[i]).abs() < 1e-12 * scale);
            prop_assert!((whole[i] - without[i] - fibres[i]).abs() < 1e-12 * scale);
        }
        for part in families.into_iter().chain([&volumetric]).chain(bulk.fibres.iter().map(|family| &family.isochoric)) {
            let jets = part_response(part, &seeded(&f), &p.map(Jet::constant));
            prop_assert!(error(&part_tangent(part, &f, &p), &jets) < 1e-12);
        }
    }
}
