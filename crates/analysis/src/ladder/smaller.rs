//! Smaller sets from where larger ones ended.

use super::catalogue::{Done, Now};
use super::fit::INSIGNIFICANT;
use super::{FeLadder, Fitted, named};
use crate::columns::transfer;
use crate::identify::AnalysisError;
use model::Model;
use rayon::prelude::*;

/// A set of effects, and one without one of them.
pub(super) type Pair = (Vec<String>, Vec<String>);

impl FeLadder<'_> {
    /// The sets without one effect of a leading one, each once more from the values where that ended. A fit beside a further effect
    /// may find an optimum that the fit without it did not, with that effect at its neutral value: it would be named for what the
    /// others explain alone.
    pub(super) fn begin_smaller_again(&mut self, done: &mut Done, now: &Now) -> bool {
        let open: Vec<Pair> = self.smaller_than_leaders(now).filter(|p| !done.smaller.contains(p)).collect();
        let this = &*self;
        let found: Vec<Option<Fitted>> = open
            .par_iter()
            .map(|(larger, smaller)| this.fitted_where(larger, smaller).ok().flatten())
            .collect();
        for ((_, smaller), found) in open.iter().zip(found) {
            let before = self.fitted_models.get(smaller).map_or(f64::INFINITY, |f| f.fit.f);
            if let Some(f) = found.filter(|f| f.fit.f < before - INSIGNIFICANT) {
                self.fitted_models.insert(smaller.clone(), f);
                // What was seen of it was seen elsewhere.
                self.screened.remove(smaller);
                done.seen.remove(smaller);
                done.formed.remove(smaller);
            }
        }
        done.smaller.extend(open.iter().cloned());
        !open.is_empty()
    }

    fn smaller_than_leaders<'a>(&'a self, now: &'a Now) -> impl Iterator<Item = Pair> + 'a {
        let without = |larger: &'a Vec<String>| {
            larger.iter().map(move |e| {
                let smaller: Vec<String> = larger.iter().filter(|x| *x != e).cloned().collect();
                (larger.clone(), smaller)
            })
        };
        let fit = |set: &Vec<String>| self.fitted_models.get(set).map(|f| f.fit.f);
        let worse = move |(larger, smaller): &Pair| {
            fit(larger).zip(fit(smaller)).is_some_and(|(l, s)| s > l + INSIGNIFICANT)
        };
        now.leads.iter().filter(|s| s.len() > 1).flat_map(without).filter(worse)
    }

    /// A set fitted from where a larger one ended. `None`: one of them is not fitted, or another law's values say nothing of its own.
    fn fitted_where(&self, larger: &[String], smaller: &[String]) -> Result<Option<Fitted>, AnalysisError> {
        let (Some(end), Some(first)) = (self.fitted_models.get(larger), self.fitted_models.get(smaller))
        else {
            return Ok(None);
        };
        let laws = |f: &Fitted| (f.model.case.bulk.law.clone(), f.model.case.interface.law.clone());
        if laws(end) != laws(first) {
            return Ok(None);
        }
        (self.progress)(&format!("{}: once more from where {} ended", named(smaller), named(larger)));
        let model = Model::new(first.model.case.clone(), self.catalogue, self.how)?;
        let theta = transfer(&end.model, &end.theta, &model);
        let states = self.guesses(end, &model);
        self.fit_model(model, theta, end.correction.clone(), states, first.fit.f).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;

    /// A set whose own fit went astray comes to what a larger one found, whose further effect takes nothing; once.
    #[test]
    fn a_set_comes_to_what_a_larger_one_found() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let [one, two] =
            [vec!["mullins".to_owned()], FeLadder::key(&["mullins".to_owned(), "drift".to_owned()])];
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(std::slice::from_ref(&one)).expect("a fit");
        ladder.fit_sets(std::slice::from_ref(&two)).expect("a fit");
        let right = ladder.fitted_models[&one].fit.f;
        let astray = ladder.fitted_models.get_mut(&one).expect("a fit");
        // From its own values no run comes through.
        astray.theta.fill(f64::NAN);
        astray.fit.f = 1e3 * right;
        ladder.screened.insert(one.clone(), Vec::new());
        let (found, posterior, models) = ladder.posterior().expect("probabilities");
        let now = Now { found, posterior, models, noise: true, leads: vec![two.clone()] };
        let mut done = Done::default();
        done.seen.insert(one.clone());
        assert!(ladder.begin_smaller_again(&mut done, &now));
        let again = ladder.fitted_models[&one].fit.f;
        assert!(again < 1.5 * right, "{again} for {right}");
        assert!(!ladder.screened.contains_key(&one) && !done.seen.contains(&one));
        assert!(!ladder.begin_smaller_again(&mut done, &now), "once");
        // What is no worse than the larger set has nothing to learn from it, and a set alone nothing to leave out.
        let mut done = Done::default();
        ladder.fitted_models.get_mut(&one).expect("a fit").fit.f = 0.0;
        assert!(ladder.smaller_than_leaders(&now).all(|(_, smaller)| smaller != one));
        let alone = Now { leads: vec![one, Vec::new()], ..now };
        assert!(!ladder.begin_smaller_again(&mut done, &alone));
    }
}
