//! A second place to look along the tear path: strengths of neighbouring areas trade against each other, and a search that has
//! made every other area weak may have a better optimum where these are the strong ones.

use model::Model;

/// Values whose areas are as many times weaker than their geometric mean as they were stronger, toughness and strength alike;
/// `None` where fewer than two areas are free.
pub(super) fn mirrored(model: &Model, theta: &[f64]) -> Option<Vec<f64>> {
    let mut out = theta.to_vec();
    let mut any = false;
    for name in ["gc", "sigma_c"] {
        let areas = (1..=model.areas()).filter_map(|k| model.find(&format!("interface.area[{k}].{name}")));
        let free: Vec<usize> = areas.filter(|&i| model.parameters[i].free && theta[i] > 0.0).collect();
        let mean = free.iter().map(|&i| theta[i].ln()).sum::<f64>() / free.len() as f64;
        for &i in &free {
            let spec = &model.parameters[i].spec;
            out[i] = (2.0 * mean - theta[i].ln()).exp().clamp(spec.lower, spec.upper);
        }
        any |= free.len() > 1;
    }
    any.then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unloaded;
    use model::Discretisation;
    use std::sync::Arc;

    #[test]
    fn strong_areas_become_as_weak_as_they_were_strong() {
        let catalogue = effects::catalogue();
        let of = |areas: usize| {
            let mut case = unloaded(&catalogue);
            case.interface.areas = areas;
            Model::new(Arc::new(case), &catalogue, Discretisation::default()).expect("a model")
        };
        let model = of(3);
        let mut theta = model.theta();
        let places = |name: &str| {
            [1, 2, 3].map(|k| model.find(&format!("interface.area[{k}].{name}")).expect("a parameter"))
        };
        let (gc, sigma_c) = (places("gc"), places("sigma_c"));
        for (i, v) in gc.iter().zip([0.1, 0.2, 0.4]).chain(sigma_c.iter().zip([0.3, 0.1, 0.9])) {
            theta[*i] = v;
        }
        let found = mirrored(&model, &theta).expect("areas");
        for (i, v) in gc.iter().zip([0.4, 0.2, 0.1]).chain(sigma_c.iter().zip([0.3, 0.9, 0.1])) {
            assert!((found[*i] / v - 1.0).abs() < 1e-12, "{found:?}");
        }
        let moved = found.iter().zip(&theta).filter(|(a, b)| a != b).count();
        assert!(moved <= 6 && found != theta);
        assert!(mirrored(&of(1), &of(1).theta()).is_none());
    }
}
