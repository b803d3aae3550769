//! Rivals of what leads, looked at on the file's mesh before an effect is named.

use super::FeLadder;
use super::catalogue::{Done, Now};
use crate::identify::AnalysisError;
use evidence::Judged;

impl FeLadder<'_> {
    /// Single effects that gain over the base model and are not far behind what leads, once on the file's mesh. On the search's
    /// they are put right at the base only: the farther a fit goes from there, the less that says of it, and what leads stands
    /// on the file's mesh itself.
    pub(super) fn settle_rivals(&mut self, done: &mut Done, now: &Now) -> Result<bool, AnalysisError> {
        let open = self.rivals(done, now);
        self.settle_once(&open)?;
        done.seen.extend(open.iter().cloned());
        Ok(!open.is_empty())
    }

    fn rivals(&self, done: &Done, now: &Now) -> Vec<Vec<String>> {
        let fitted = || now.models.iter().filter(|m| m.fitted);
        let best = fitted().map(Judged::ln_z).fold(f64::NEG_INFINITY, f64::max);
        let base = fitted().filter(|m| m.effects.is_empty()).map(Judged::ln_z);
        let base = base.fold(f64::NEG_INFINITY, f64::max);
        let near = |z: f64| z > base && z > best - evidence::HOPELESS;
        fitted()
            .filter(|m| m.effects.len() == 1 && near(m.ln_z()) && !done.seen.contains(&m.effects))
            .filter(|m| self.fitted_models.get(&m.effects).is_some_and(|f| !f.settled))
            .map(|m| m.effects.clone())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;

    fn one(effect: &str) -> Vec<String> {
        vec![effect.to_owned()]
    }

    /// What gains over the base model and is not far behind is looked at on the file's mesh, once; it counts from there, but is
    /// not at its end.
    #[test]
    fn rivals_are_looked_at_on_the_files_mesh_once() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        ladder.columns_at(&[]).expect("columns");
        let sets = ["compliance", "drift", "slack", "mullins"].map(one);
        ladder.fit_sets(&sets).expect("fits");
        let (found, posterior, _) = ladder.posterior().expect("probabilities");
        let judged = |set: &[String], ln_z: f64| Judged::from_numbers(set, ln_z, -700.0);
        let [near, no_gain, far, leads] = &sets;
        let now = |base: f64| Now {
            found: found.clone(),
            posterior: posterior.clone(),
            models: vec![
                judged(&[], base),
                judged(near, -11.0),
                judged(no_gain, -20.5),
                judged(far, -13.0),
                judged(leads, 0.0),
                judged(&one("lag"), -1.0),
            ],
            noise: true,
            leads: vec![leads.clone()],
        };
        ladder.fitted_models.get_mut(leads).expect("a fit").settled = true;
        let mut done = Done::default();
        assert_eq!(ladder.rivals(&done, &now(-20.0)), std::slice::from_ref(near));
        // Where the base model is no worse, a fit stands where it is put right.
        assert!(ladder.rivals(&done, &now(-10.0)).is_empty());
        // As if the search's mesh had misjudged it.
        let fit = &mut ladder.fitted_models.get_mut(near).expect("a fit").fit;
        let right = std::mem::replace(&mut fit.f, 1e9);
        assert!(ladder.settle_rivals(&mut done, &now(-20.0)).expect("a step"));
        let seen = &ladder.fitted_models[near];
        assert!(seen.fit.f <= 1.01 * right && !seen.settled, "{} for {right}", seen.fit.f);
        assert!(!ladder.settle_rivals(&mut done, &now(-20.0)).expect("nothing to do"));
    }
}
