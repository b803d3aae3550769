//! What is believed of a model's parameters before the records are looked at.

use evidence::Belief;
use inverse::Free;
use model::{Card, Catalogue, Model, Scales, Screening, Sided};
use params::{ParamSpec, Transform};

/// Spread of a shape's belief in its natural coordinate, a factor of 4.5 either way in a logarithm; of a positive one that may be zero,
/// in what is ordinary of it.
const SHAPE_SPREAD: f64 = 1.5;

/// Spread of a base parameter's belief where nothing is believed of it: a factor of 20 either way in a logarithm.
const OPEN_SPREAD: f64 = 3.0;

/// The effect and parameter of a path `effects.NAME.PARAMETER`.
fn of_effect(path: &str) -> Option<(&str, &str)> {
    path.strip_prefix("effects.")?.split_once('.')
}

/// Belief of an amplitude: normal around neutral, half-normal where it has a sign, as wide as what a lab would call
/// ordinary.
pub(crate) fn amplitude(
    free: &Free,
    spec: &ParamSpec,
    at: usize,
    card: &Card,
    start: &[f64],
) -> Option<Belief> {
    let neutral = spec.neutral?;
    let ordinary = start.get(at).map_or(0.0, |s| (s - neutral).abs());
    let ordinary = if ordinary > 0.0 { ordinary } else { (spec.start - neutral).abs().max(1e-12) };
    let sd = ordinary / free.transform.slope(neutral).abs().max(1e-300);
    let (lower, upper) = free.bounds_z();
    let z = free.transform.forward(neutral);
    let (Screening::Score(side) | Screening::Refit(side)) = card.screening;
    let whole = match side {
        Sided::Positive => Belief::above(z, sd).within(z, upper),
        Sided::Both => Belief::normal(z, sd).within(lower, upper),
    };
    (whole.lower < whole.upper).then_some(whole)
}

/// Belief of a shape: about what is ordinary of it. Of a positive one that may be zero, half the box of its bounds would be far more than
/// any record has of it.
fn shape(free: &Free, spec: &ParamSpec, start: Option<&f64>) -> Belief {
    let typical = start.copied().unwrap_or(spec.start).clamp(spec.lower, spec.upper);
    let positive = spec.transform == Transform::Identity && spec.lower >= 0.0 && typical > 0.0;
    let scale = if positive { typical } else { free.natural_scale(typical) };
    let (lower, upper) = free.bounds_z();
    Belief::normal(free.forward(typical), SHAPE_SPREAD * scale).within(lower, upper)
}

/// Belief of a free parameter, and whether it is the amplitude of an effect.
pub(crate) fn belief(free: &Free, model: &Model, catalogue: &Catalogue, scales: &Scales) -> (Belief, bool) {
    let (lower, upper) = free.bounds_z();
    let wide = |mean: f64, sd: f64| (Belief::normal(mean, sd).within(lower, upper), false);
    if let Some((name, parameter)) = of_effect(&free.path)
        && let Some(effect) = catalogue.get(name)
        && let Some(config) = model.case.effects.iter().find(|c| c.name == name)
        && let Some(at) = config.specs.iter().position(|s| s.name == parameter)
    {
        let start = if config.options.is_empty() { effect.start(scales) } else { Vec::new() };
        let spec = &config.specs[at];
        if let Some(b) = amplitude(free, spec, at, effect.card(), &start) {
            return (b, true);
        }
        return (shape(free, spec, start.get(at)), false);
    }
    match free.prior {
        Some(p) => wide(p.mean, p.sd),
        // Nothing is believed: the same for all sets.
        None => {
            let start = model.parameters.iter().find(|p| p.path == free.path).map_or(free.start, |p| p.value);
            wide(free.forward(start), OPEN_SPREAD * free.natural_scale(start))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A case's sizes, as the effects' own tests have them.
    const SIZES: Scales = Scales {
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

    /// No shape is believed to be, for the most part, ten times what an effect calls ordinary, or next to nothing.
    #[test]
    fn shapes_are_believed_about_what_is_ordinary() {
        let mut may_be_zero = 0;
        for effect in effects::catalogue().iter() {
            let (specs, start) = (effect.parameters(&model::Options::new()), effect.start(&SIZES));
            for (spec, &typical) in specs.iter().zip(&start).skip(1).filter(|(s, _)| s.neutral.is_none()) {
                let free = Free::new(spec.name.clone(), (spec.lower, spec.upper), spec.transform, typical);
                let b = shape(&free, spec, Some(&typical));
                let quartiles = [0.25, 0.75].map(|u| free.backward(b.quantile(u)));
                let wide = quartiles[1].abs() / typical.abs();
                assert!(wide < 10.0, "{} {}: {quartiles:?} for {typical}", effect.card().name, spec.name);
                assert!(quartiles[1].abs() > 0.5 * typical.abs(), "{} {}", effect.card().name, spec.name);
                may_be_zero += usize::from(spec.transform == Transform::Identity && spec.lower >= 0.0);
            }
        }
        // Ψ0 of fiber_damage, β of mullins, Fs of grip_slip.
        assert_eq!(may_be_zero, 3);
    }

    /// Every effect has an amplitude whose belief stands at neutral, reaches what a lab would call ordinary, and goes to its
    /// admissible side alone.
    #[test]
    fn amplitudes_are_believed_around_neutral() {
        for effect in effects::catalogue().iter() {
            let (card, start) = (effect.card(), effect.start(&SIZES));
            let specs = effect.parameters(&model::Options::new());
            let (spec, bounds) = (&specs[0], (specs[0].lower, specs[0].upper));
            let free = Free::new(spec.name.clone(), bounds, spec.transform, spec.start);
            let b =
                amplitude(&free, spec, 0, card, &start).unwrap_or_else(|| panic!("{}: no belief", card.name));
            let neutral = spec.neutral.expect("an amplitude");
            assert!((free.backward(b.mean) - neutral).abs() < 1e-9, "{}", card.name);
            let distance = (free.forward(start[0]) - b.mean).abs() / b.sd;
            assert!((0.5..2.0).contains(&distance), "{}: {distance}", card.name);
            let (Screening::Score(side) | Screening::Refit(side)) = card.screening;
            assert_eq!(b.lower >= b.mean, side == Sided::Positive, "{}", card.name);
        }
    }
}
