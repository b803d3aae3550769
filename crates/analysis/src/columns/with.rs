//! A case with one more effect, and values taken over from model to model.

use input::{Case, EffectConfig, Value};
use model::{Effect, Model};
use std::sync::Arc;

/// A case with the parameter values of a model written into it, and more effects.
pub fn case_with(case: &Case, effects: &[EffectConfig]) -> Case {
    let mut c = case.clone();
    c.effects.extend(effects.iter().cloned());
    c
}

/// The configuration of an effect at given values (card order).
pub fn config_of(effect: &Arc<dyn Effect>, values: &[f64]) -> EffectConfig {
    config_with(effect, &model::Options::new(), values)
}

/// The same with settings of the effect.
pub fn config_with(effect: &Arc<dyn Effect>, settings: &model::Options, values: &[f64]) -> EffectConfig {
    let specs = effect.parameters(settings);
    let mut options: model::Options =
        effect.options().into_iter().filter_map(|o| o.default.map(|d| (o.name, d))).collect();
    options.extend(settings.clone());
    EffectConfig {
        name: effect.card().name.to_owned(),
        parameters: specs.iter().zip(values).map(|(s, &v)| (s.name.to_string(), Value::new(v))).collect(),
        specs,
        options,
        location: input::Location::default(),
    }
}

/// θ of `to`, taking values by path from `from`.
pub fn transfer(from: &Model, theta: &[f64], to: &Model) -> Vec<f64> {
    to.parameters.iter().map(|p| from.find(&p.path).map_or(p.value, |i| theta[i])).collect()
}
