//! The search: screen, refit the best and their look-alikes, add what pays, take back what does not, try pairs
//! where one effect leaves structure, and say honestly how it ended.

use crate::ladder::{Hints, Ladder, Rung, pays};
use crate::verdict::{Discovery, Verdict};
use crate::{Policy, Screen};
use std::collections::{BTreeMap, BTreeSet};

struct Search<'a, L: Ladder> {
    ladder: &'a mut L,
    policy: &'a Policy,
    known: BTreeMap<BTreeSet<String>, Option<Rung>>,
    tried: Vec<Rung>,
    failed: Vec<(Vec<String>, String)>,
    hints: Hints,
    progress: &'a mut dyn FnMut(&str),
}

/// Searches the catalogue. `progress` is told in sentences what happens.
///
/// # Errors
/// The ladder's error when the base model cannot be fitted or screened.
pub fn discover<L: Ladder>(
    ladder: &mut L,
    policy: &Policy,
    progress: &mut dyn FnMut(&str),
) -> Result<Discovery, L::Error> {
    let hints = Hints::new();
    let base = ladder.fit(&[], &hints)?;
    let mut first = ladder.screen(&base)?;
    let known = BTreeMap::from([(BTreeSet::new(), Some(base.clone()))]);
    let mut search =
        Search { ladder, policy, known, tried: vec![base.clone()], failed: Vec::new(), hints, progress };
    let (rungs, last_screen) = search.climb(base, &first);
    let interrupted = search.ladder.interrupted();
    let last = rungs.last().cloned();
    let found = last.as_ref().map_or(Vec::new(), |r| r.effects.clone());
    let groups = last.as_ref().map_or(Vec::new(), |r| search.groups(r));
    let explained = last.is_some_and(|r| r.explained(policy));
    let verdict = match (explained, found.is_empty()) {
        (false, _) => Verdict::Unexplained,
        (true, true) => Verdict::NothingMissing,
        (true, false) if groups.iter().any(|g| g.len() > 1) => Verdict::Ambiguous,
        (true, false) => Verdict::Explained,
    };
    let (tried, failed) = (search.tried, search.failed);
    if verdict == Verdict::NothingMissing {
        first.set_aside_significant();
    }
    Ok(Discovery {
        ladder: rungs,
        tried,
        failed,
        screen: first,
        last_screen,
        found,
        groups,
        verdict,
        interrupted,
    })
}

impl<L: Ladder> Search<'_, L> {
    /// Adds and takes away until nothing pays; the accepted models and the last screen.
    fn climb(&mut self, base: Rung, first: &Screen) -> (Vec<Rung>, Screen) {
        let mut rungs = vec![base.clone()];
        let mut visited: BTreeSet<BTreeSet<String>> = BTreeSet::from([BTreeSet::new()]);
        let (mut current, mut screen) = (base, first.clone());
        while current.effects.len() < self.policy.max_effects && !self.ladder.interrupted() {
            self.remember(&screen);
            let Some(next) = self.best_step(&current, &screen) else { break };
            let next = self.prune(next);
            if !visited.insert(key(&next.effects)) {
                break;
            }
            (self.progress)(&format!(
                "{} is kept: χ² {:.2}.",
                listed(&next.effects),
                next.reduced_chi2_total()
            ));
            current = next;
            rungs.push(current.clone());
            match self.ladder.screen(&current) {
                Ok(s) => screen = s,
                Err(e) => {
                    self.failed.push((current.effects.clone(), format!("screen: {e}")));
                    break;
                }
            }
        }
        self.abstain(&mut rungs);
        (rungs, screen)
    }

    /// Where the record stays unexplained, only effects that took a large share of the excess keep their name:
    /// the rest may just bend towards what the catalogue does not hold.
    fn abstain(&mut self, rungs: &mut Vec<Rung>) {
        while let [.., before, last] = rungs.as_slice() {
            let gain = before.chi2_total - last.chi2_total;
            if last.explained(self.policy) || gain >= self.policy.min_share_unexplained * before.excess() {
                break;
            }
            (self.progress)(&format!("{} explains too little to be named.", listed(&last.effects)));
            rungs.pop();
        }
    }

    fn remember(&mut self, screen: &Screen) {
        for f in &screen.findings {
            self.hints.insert(f.effect.clone(), f.clone());
        }
    }

    /// Fits a set once; `None` where that is impossible.
    fn fit(&mut self, effects: &[String]) -> Option<Rung> {
        if let Some(known) = self.known.get(&key(effects)) {
            return known.clone();
        }
        if self.ladder.interrupted() || !self.ladder.compatible(effects) {
            return None;
        }
        let answer = match self.ladder.fit(effects, &self.hints) {
            Ok(rung) => {
                (self.progress)(&format!(
                    "With {}: χ² {:.2}, BIC {:.0}.",
                    listed(effects),
                    rung.reduced_chi2_total(),
                    rung.bic
                ));
                self.tried.push(rung.clone());
                Some(rung)
            }
            Err(e) => {
                (self.progress)(&format!("With {}: no fit ({e}).", listed(effects)));
                self.failed.push((effects.to_vec(), e.to_string()));
                None
            }
        };
        self.known.insert(key(effects), answer.clone());
        answer
    }

    /// Whether a pair is better than one effect by enough for two names: on a record that stays
    /// unexplained nearly anything pays a little.
    fn worth_a_second(&self, one: &Rung, pair: &Rung) -> bool {
        let gain = one.chi2_total - pair.chi2_total;
        pair.bic <= one.bic - self.policy.add_bic
            && (pair.explained(self.policy) || gain >= self.policy.min_share_unexplained * one.excess())
    }

    /// The best single effect that pays; where it leaves structure, a pair if that is better by `add_bic`.
    fn best_step(&mut self, current: &Rung, screen: &Screen) -> Option<Rung> {
        let mut best = self.best_single(current, screen);
        let done = |r: &Option<Rung>, policy: &Policy| r.as_ref().is_some_and(|r| r.explained(policy));
        let open = !done(&best, self.policy) && !current.explained(self.policy);
        if open && current.effects.len() + 2 <= self.policy.max_effects {
            let pairs = self.pair_shortlist(current, screen);
            if let Some(pair) = self.best_of(current, pairs)
                && best.as_ref().is_none_or(|b| self.worth_a_second(b, &pair))
            {
                best = Some(pair);
            }
        }
        if !done(&best, self.policy) && !current.explained(self.policy) {
            let untold: Vec<Vec<String>> = screen
                .findings
                .iter()
                .filter(|f| f.refit_only && !current.effects.contains(&f.effect))
                .map(|f| vec![f.effect.clone()])
                .collect();
            if let Some(other) = self.best_of(current, untold)
                && best.as_ref().is_none_or(|b| other.bic < b.bic)
            {
                best = Some(other);
            }
        }
        best
    }

    /// The best of the shortlist. Once one explains the record, only those are fitted that promised about
    /// as much: the others could not have taken its place.
    fn best_single(&mut self, current: &Rung, screen: &Screen) -> Option<Rung> {
        let promise = |e: &str| screen.finding(e).map_or(0.0, |f| f.fall);
        let (mut best, mut enough): (Option<Rung>, f64) = (None, 0.0);
        for name in self.shortlist(current, screen) {
            if promise(&name) < enough {
                continue;
            }
            let rung = self.best_of(current, vec![vec![name.clone()]]);
            if rung.as_ref().is_some_and(|r| r.explained(self.policy)) {
                enough = f64::max(enough, 0.8 * promise(&name));
            }
            if let Some(r) = rung
                && best.as_ref().is_none_or(|b| r.bic < b.bic)
            {
                best = Some(r);
            }
        }
        best
    }

    fn best_of(&mut self, current: &Rung, additions: Vec<Vec<String>>) -> Option<Rung> {
        let mut best: Option<Rung> = None;
        for add in additions {
            let set: Vec<String> = current.effects.iter().cloned().chain(add).collect();
            let Some(rung) = self.fit(&set) else { continue };
            if pays(current, &rung, self.policy) && best.as_ref().is_none_or(|b| rung.bic < b.bic) {
                best = Some(rung);
            }
        }
        best
    }

    /// The most significant effects, and the look-alikes that explain about as much.
    fn shortlist(&self, current: &Rung, screen: &Screen) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let new = |f: &&crate::Finding| f.significant && !current.effects.contains(&f.effect);
        let least = if current.explained(self.policy) {
            let best = screen.findings.iter().filter(new).map(|f| f.fall).fold(0.0, f64::max);
            let alike = screen.findings.iter().filter(new).filter(|f| f.fall >= 0.5 * best).count();
            if alike > self.policy.most_alike_explained {
                return names;
            }
            // What would not pay for itself even at twice the promise is not worth a fit.
            0.5 * self.policy.min_fall_explained
        } else {
            0.0
        };
        let mut significant: Vec<_> = screen
            .findings
            .iter()
            .filter(|f| f.significant && f.fall >= least && !current.effects.contains(&f.effect))
            .collect();
        significant.sort_by(|a, b| b.fall.total_cmp(&a.fall).then(a.effect.cmp(&b.effect)));
        for f in significant.into_iter().take(self.policy.refits) {
            let alike = f.look_alikes.iter().filter(|e| {
                screen.finding(e).is_some_and(|o| o.fall >= self.policy.min_fall || o.refit_only)
            });
            for name in std::iter::once(&f.effect).chain(alike) {
                if !names.contains(name) && !current.effects.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        names
    }

    /// Pairs that promise clearly more than the best single effect.
    fn pair_shortlist(&self, current: &Rung, screen: &Screen) -> Vec<Vec<String>> {
        let new = |e: &str| !current.effects.iter().any(|c| c == e);
        let single = screen.findings.iter().filter(|f| new(&f.effect)).map(|f| f.fall).fold(0.0, f64::max);
        let level = self.policy.pair_alpha / screen.pairs.len().max(1) as f64;
        screen
            .pairs
            .iter()
            .filter(|p| new(&p.a) && new(&p.b))
            .filter(|p| p.joint_fall >= single + self.policy.add_bic && p.p_value <= level)
            .take(self.policy.pair_refits)
            .map(|p| vec![p.a.clone(), p.b.clone()])
            .collect()
    }

    /// Takes away every effect without which BIC is hardly worse, the least useful first.
    fn prune(&mut self, mut rung: Rung) -> Rung {
        while rung.effects.len() > 1 {
            let mut best: Option<Rung> = None;
            for e in rung.effects.clone() {
                let rest: Vec<String> = rung.effects.iter().filter(|x| **x != e).cloned().collect();
                let Some(without) = self.fit(&rest) else { continue };
                let useless = without.bic - rung.bic < self.policy.drop_bic;
                if useless && best.as_ref().is_none_or(|b| without.bic < b.bic) {
                    best = Some(without);
                }
            }
            match best {
                Some(b) => {
                    (self.progress)(&format!("{} is enough.", listed(&b.effects)));
                    rung = b;
                }
                None => break,
            }
        }
        rung
    }

    /// For each effect found: itself, and every rival that does as well in its place.
    fn groups(&mut self, last: &Rung) -> Vec<Vec<String>> {
        last.effects.iter().map(|e| self.group(last, e)).collect()
    }

    fn group(&mut self, last: &Rung, effect: &str) -> Vec<String> {
        let mut group = vec![effect.to_owned()];
        let rest: Vec<String> = last.effects.iter().filter(|e| *e != effect).cloned().collect();
        let Some(without) = self.fit(&rest) else { return group };
        if self.ladder.interrupted() {
            return group;
        }
        let Ok(screen) = self.ladder.screen(&without) else { return group };
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
        for name in names {
            let mut set = rest.clone();
            set.push(name.clone());
            let Some(rung) = self.fit(&set) else { continue };
            let as_good = rung.bic <= last.bic + self.policy.tie_bic;
            if as_good && (rung.explained(self.policy) || !last.explained(self.policy)) {
                group.push(name);
            }
        }
        group
    }
}

fn key(effects: &[String]) -> BTreeSet<String> {
    effects.iter().cloned().collect()
}

fn listed(effects: &[String]) -> String {
    if effects.is_empty() { "no effect".into() } else { effects.join(" + ") }
}
