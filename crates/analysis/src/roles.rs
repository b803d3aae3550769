//! Which of two laws of a tear is which: where an effect's law and the file's respond alike with their roles exchanged, a fit
//! may end with either, and only one is what the effect's card means.

use inverse::Free;
use model::{Catalogue, Model};

/// Gives an effect's law and the file's the roles that the card means; whether they had others. Not where something is believed
/// of one of them, or where areas have values of their own: the exchanged model is then another one.
pub(crate) fn as_the_cards_say(
    model: &Model,
    catalogue: &Catalogue,
    free: &[Free],
    theta: &mut [f64],
) -> bool {
    let mut any = false;
    for effect in &model.case.effects {
        let own = effect.specs.iter().map(|s| format!("effects.{}.{}", effect.name, s.name));
        let paths: Vec<String> =
            ["gc", "sigma_c"].map(|n| format!("interface.area[1].{n}")).into_iter().chain(own).collect();
        let open = |path: &String| free.iter().any(|f| &f.path == path && f.prior.is_none());
        let Some(places) =
            paths.iter().map(|p| model.find(p).filter(|_| open(p))).collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let values: Vec<f64> = places.iter().map(|&i| theta[i]).collect();
        let exchanged = (catalogue.get(&effect.name))
            .filter(|_| model.areas() == 1)
            .and_then(|e| e.exchanged(&model.case.interface.law, [values[0], values[1]], &values[2..]));
        let Some((tear, own)) = exchanged else { continue };
        let new: Vec<f64> = tear.into_iter().chain(own).collect();
        let within = |(&i, v): (&usize, &f64)| {
            let spec = &model.parameters[i].spec;
            (spec.lower..=spec.upper).contains(v)
        };
        if new.len() == places.len() && places.iter().zip(&new).all(within) {
            places.iter().zip(&new).for_each(|(&i, &v)| theta[i] = v);
            any = true;
        }
    }
    any
}

#[cfg(test)]
mod tests;
