//! The effects of a rung as configurations: their start values, and other forms of the same effect.

use super::{FeLadder, Fitted};
use crate::columns::{config_of, config_with, scales, transfer};
use crate::identify::AnalysisError;
use diagnose::Finding;
use input::EffectConfig;
use model::Model;
use std::collections::BTreeMap;
use std::sync::Arc;

impl FeLadder<'_> {
    /// The same effects with one of them in another form, where the fit leaves structure and a form pays for its parameters.
    pub(super) fn best_form(&self, f: &Fitted) -> Result<Option<Fitted>, AnalysisError> {
        let mut best: Option<Fitted> = None;
        for at in 0..f.model.case.effects.len() {
            while let Some(better) = self.better_form(best.as_ref().unwrap_or(f), at)? {
                best = Some(better);
            }
        }
        Ok(best)
    }

    /// The best of the other forms of one effect, if it pays for its parameters and the record is not explained yet.
    fn better_form(&self, f: &Fitted, at: usize) -> Result<Option<Fitted>, AnalysisError> {
        if self.fitted_model(&f.model.effects(), f).explained(&self.policy) {
            return Ok(None);
        }
        let config = &f.model.case.effects[at];
        let Some(effect) = self.catalogue.get(&config.name) else { return Ok(None) };
        let path = |s: &params::ParamSpec| format!("effects.{}.{}", config.name, s.name);
        let values: Vec<f64> =
            config.specs.iter().filter_map(|s| f.model.find(&path(s)).map(|i| f.theta[i])).collect();
        let (mut enough, mut best) = (f.quality.bic - self.policy.add_bic, None);
        for (settings, values) in effect.richer(&config.options, &values) {
            if !self.catalogue.can_act(&**effect, &settings, &f.model.case) {
                continue;
            }
            (self.progress)(&format!("{} in another form: {}", config.name, in_words(&settings)));
            match self.in_form(f, at, &settings, &values) {
                Ok(fitted) if fitted.quality.bic < enough => {
                    enough = fitted.quality.bic;
                    best = Some(fitted);
                }
                Err(e) if self.cancelled.stops() => return Err(e),
                // A form that cannot be fitted is no better one.
                Ok(_) | Err(_) => {}
            }
        }
        Ok(best)
    }

    /// A fit with one of its effects in another form, from these values of it.
    fn in_form(
        &self,
        f: &Fitted,
        at: usize,
        settings: &model::Options,
        values: &[f64],
    ) -> Result<Fitted, AnalysisError> {
        let name = &f.model.case.effects[at].name;
        let Some(effect) = self.catalogue.get(name) else {
            return Err(AnalysisError::Case(format!("no effect {name}")));
        };
        let mut case = (*f.model.case).clone();
        case.effects[at] = config_with(effect, settings, values);
        let model = Model::new(Arc::new(case), self.catalogue, self.how)?;
        let mut theta = transfer(&f.model, &f.theta, &model);
        for (spec, v) in effect.parameters(settings).iter().zip(values) {
            if let Some(i) = model.find(&format!("effects.{name}.{}", spec.name)) {
                theta[i] = *v;
            }
        }
        self.fit_model(model, theta, f.correction.clone(), Vec::new(), f.fit.f)
    }

    /// Configurations of effects, started from a share of the screen's amplitudes.
    pub(super) fn configs(
        &self,
        effects: &[String],
        hints: &BTreeMap<String, Finding>,
        base: &Fitted,
        share: f64,
    ) -> Vec<EffectConfig> {
        let scales = scales(&base.model, &base.theta);
        effects
            .iter()
            .filter(|e| !self.case.effects.iter().any(|c| &&c.name == e))
            .filter_map(|name| {
                if let Some(known) = base.model.case.effects.iter().find(|c| &c.name == name) {
                    return Some(known.clone());
                }
                let effect = self.catalogue.get(name)?;
                let specs = effect.parameters(&model::Options::new());
                let mut values = effect.start(&scales);
                if let Some(h) = hints.get(name) {
                    start_from(h, &specs, &mut values);
                }
                let neutral = specs.first().and_then(|s| s.neutral).unwrap_or(0.0);
                if let Some(amplitude) = values.first_mut() {
                    *amplitude = neutral + share * (*amplitude - neutral);
                }
                Some(config_of(effect, &values))
            })
            .collect()
    }
}

/// Settings as a file would give them.
fn in_words(settings: &model::Options) -> String {
    let one = |(name, value): (&String, &input::OptionValue)| format!("{name} = {value}");
    settings.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Start values from a finding: its shape, and its amplitude held inside the plausible.
fn start_from(h: &Finding, specs: &[params::ParamSpec], values: &mut [f64]) {
    for (spec, v) in specs.iter().zip(values.iter_mut()).skip(1) {
        if let Some((_, s)) = h.shape.iter().find(|(n, _)| *n == spec.key()) {
            *v = *s;
        }
    }
    let neutral = specs[0].neutral.unwrap_or(0.0);
    let plausible = (values[0] - neutral).abs();
    if let Some((_, a)) = h.amplitudes.first() {
        // A linear estimate may overshoot: never start beyond three plausible amplitudes, nor at
        // nothing.
        let size = a.abs().clamp(0.05 * plausible, 3.0 * plausible);
        values[0] =
            (neutral + size.copysign(if *a == 0.0 { 1.0 } else { *a })).clamp(specs[0].lower, specs[0].upper);
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::{Done, Now, Singles};
    use super::super::tests::unheard;
    use super::*;
    use std::fmt::Write as _;

    /// Force of a neo-Hookean strip of 10 mm² whose nominal stress relaxes with two times, pulled by 60 % and back.
    fn pulled(rate: f64) -> String {
        let (steps, turn, mu) = (40, 0.6 / rate, 0.02);
        let branches = [(1.4, 2.0), (0.8, 30.0)];
        let (mut relaxing, mut last) = ([0.0; 2], 0.0);
        let mut rows = String::from("time_s,displacement_mm,force_N\n");
        for k in 0..=2 * steps {
            let dt = turn / f64::from(steps);
            let t = dt * f64::from(k);
            let stretch = 1.0 + rate * t.min(2.0 * turn - t);
            let elastic = stretch - stretch.powi(-2);
            for (q, (g, tau)) in relaxing.iter_mut().zip(branches).filter(|_| k > 0) {
                let kept = (-dt / tau).exp();
                *q = kept * *q + g * (elastic - last) * (1.0 - kept) * tau / dt;
            }
            last = elastic;
            let force = 10.0 * mu * (elastic + relaxing.iter().sum::<f64>());
            let _ = writeln!(rows, "{t},{},{force}", 20.0 * (stretch - 1.0));
        }
        rows
    }

    fn relaxing(folder: &std::path::Path) -> input::Case {
        let test = |name: &str, rate: f64| {
            std::fs::write(folder.join(format!("{name}.csv")), pulled(rate)).expect("a record");
            format!(
                "[[tests]]\nname = \"{name}\"\nkind = \"uniaxial\"\ndata = \"{name}.csv\"\nforce_sd_N = 2e-4\n"
            )
        };
        let text = format!(
            "name = \"relaxes\"\n[geometry]\nlength_mm = 20.0\nwidth_mm = 10.0\nthickness_mm = 1.0\ncut_mm = 0.0\n\
             {}{}[mesh]\ndivisions = [2, 2, 1]\n[bulk]\nmu_kPa = 15.0\nk1_kPa = 5.0\nk2 = 0.01\ngamma_deg = 45.0\n\
             kappa = 0.3333\n",
            test("slow", 0.005),
            test("fast", 0.2)
        );
        std::fs::write(folder.join("c.toml"), text).expect("a config");
        input::read_case(&folder.join("c.toml"), &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
    }

    /// A leading set whose fit stands on the file's mesh already, as where `identify` of its model was better than the search.
    #[test]
    fn a_leading_set_is_tried_in_other_forms_wherever_its_fit_ended() {
        let folder = tempfile::tempdir().expect("a folder");
        let catalogue = effects::catalogue();
        let mut ladder =
            FeLadder::weighing(Arc::new(relaxing(folder.path())), unheard(&catalogue)).expect("a base fit");
        let set = vec!["viscoelastic".to_owned()];
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(std::slice::from_ref(&set)).expect("a fit");
        ladder.fitted_models.get_mut(&set).expect("a fit").settled = true;
        let one = ladder.fitted_models[&set].fit.f;
        let (found, posterior, models) = ladder.posterior().expect("probabilities");
        let now = Now { found, posterior, models, noise: false, leads: vec![set.clone()] };
        let mut done = Done { singles: Singles::Fitted, ..Done::default() };
        assert!(ladder.settle_leaders(&mut done, &now).expect("fits"));
        let f = &ladder.fitted_models[&set];
        assert!(
            f.settled && f.model.find("effects.viscoelastic.tau2").is_some(),
            "{:?}",
            f.model.case.effects
        );
        assert!(f.fit.f < 0.7 * one, "{} for {one}", f.fit.f);
        assert!(!ladder.settle_leaders(&mut done, &now).expect("fits"), "once is enough");
    }
}
