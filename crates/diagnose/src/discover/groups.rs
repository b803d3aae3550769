//! Who else may stand for an effect that was found.

use super::{Search, key};
use crate::ladder::{Ladder, Rung};

impl<L: Ladder> Search<'_, L> {
    /// For each effect found: itself, and every rival that does as well in its place, or that promised more and was never
    /// fitted well enough to be judged, or that the records cannot tell from it.
    pub(super) fn groups(&mut self, last: &Rung) -> Vec<Vec<String>> {
        last.effects.iter().map(|e| self.group(last, e)).collect()
    }

    fn group(&mut self, last: &Rung, effect: &str) -> Vec<String> {
        let mut group = vec![effect.to_owned()];
        let rest: Vec<String> = last.effects.iter().filter(|e| *e != effect).cloned().collect();
        let Some(without) = self.fit(&rest) else { return group };
        if self.ladder.interrupted() {
            return group;
        }
        let Ok(screen) = self.screen(&without) else { return group };
        self.remember(&screen);
        let own = screen.finding(effect).map_or(0.0, |f| f.fall);
        let alike = screen.finding(effect).map_or(Vec::new(), |f| f.look_alikes.clone());
        let mut rivals: Vec<_> = screen
            .findings
            .iter()
            .filter(|f| !last.effects.contains(&f.effect))
            .filter(|f| {
                f.fall >= self.policy.min_fall
                    && (alike.contains(&f.effect) || f.fall >= 0.8 * own - self.policy.separate_chi2)
                    || f.refit_only
            })
            .collect();
        rivals.sort_by(|a, b| b.fall.total_cmp(&a.fall).then(a.effect.cmp(&b.effect)));
        let names: Vec<String> = rivals.into_iter().take(6).map(|f| f.effect.clone()).collect();
        let with = |name: &String| rest.iter().chain([name]).cloned().collect();
        let sets: Vec<Vec<String>> = names.iter().map(with).collect();
        self.fit_all(&sets);
        for (name, set) in names.into_iter().zip(sets) {
            let rung = self.known.get(&key(&set)).cloned().flatten();
            let told = screen.finding(&name).filter(|f| !f.refit_only).map_or(0.0, |f| f.fall);
            if told > own && own > 0.0 && never_arrived(rung.as_ref(), &without) {
                group.push(name);
                continue;
            }
            let Some(rung) = rung else { continue };
            let as_good =
                rung.bic <= last.bic + self.policy.tie_bic || self.fits_as_well(&rung, last, &without);
            if as_good && (rung.explained(self.policy) || !last.explained(self.policy)) {
                group.push(name);
            }
        }
        self.add_untold(&mut group, last, &without, &rest);
        group
    }

    /// Rivals that the records lack the means to exclude: those that stand beside the effect, and those that take as much in
    /// its place as would have made them a name.
    fn add_untold(&mut self, group: &mut Vec<String>, last: &Rung, without: &Rung, rest: &[String]) {
        for name in self.ladder.untold(&group[0]) {
            if group.contains(&name) {
                continue;
            }
            let beside = last.effects.contains(&name);
            let instead: Vec<String> = rest.iter().chain([&name]).cloned().collect();
            let fall = without.chi2_total - last.chi2_total;
            let takes_most =
                |r: Rung| without.chi2_total - r.chi2_total >= self.policy.min_share_unexplained * fall;
            if beside || self.fit(&instead).is_some_and(takes_most) {
                group.push(name);
            }
        }
    }

    /// Where noise explains the records without either effect, a rival's further parameters are no evidence
    /// against it: it is told apart only by a fit that is worse.
    fn fits_as_well(&self, rival: &Rung, last: &Rung, without: &Rung) -> bool {
        without.explained(self.policy)
            && without.chi2_total - rival.chi2_total >= self.policy.min_fall_explained
            && rival.chi2_total <= last.chi2_total + self.policy.separate_chi2
    }
}

/// Whether a fit refutes nothing: it ended no better than the model that it holds as a special case, or nowhere.
fn never_arrived(rung: Option<&Rung>, without: &Rung) -> bool {
    rung.is_none_or(|r| r.chi2_total >= without.chi2_total)
}
