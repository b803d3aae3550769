//! The search: screen, refit the best and their look-alikes, add what pays, take back what does not, try pairs
//! where one effect leaves structure, and say honestly how it ended.

mod groups;

use crate::ladder::{Hints, Ladder, Rung, pays};
use crate::verdict::{Discovery, Verdict};
use crate::{Finding, Policy, Screen};
use std::collections::{BTreeMap, BTreeSet};

/// Share of the best promise that counts as about as much.
const AS_MUCH: f64 = 0.8;

struct Search<'a, L: Ladder> {
    ladder: &'a mut L,
    policy: &'a Policy,
    known: BTreeMap<BTreeSet<String>, Option<Rung>>,
    screens: BTreeMap<BTreeSet<String>, Screen>,
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
    let screens = BTreeMap::from([(BTreeSet::new(), first.clone())]);
    let (tried, failed) = (vec![base.clone()], Vec::new());
    let mut search = Search { ladder, policy, known, screens, tried, failed, hints, progress };
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
            match self.screen(&current) {
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
            if last.explained(self.policy) || before.loses(last, self.policy.min_share_unexplained) {
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
        self.fit_all(&[effects.to_vec()]);
        self.known.get(&key(effects)).cloned().flatten()
    }

    /// Fits those sets that are not known yet, side by side.
    fn fit_all(&mut self, sets: &[Vec<String>]) {
        let mut new: Vec<Vec<String>> = Vec::new();
        for set in sets {
            let known = self.known.contains_key(&key(set)) || new.iter().any(|n| key(n) == key(set));
            if !known && self.ladder.compatible(set) {
                new.push(set.clone());
            }
        }
        if new.is_empty() || self.ladder.interrupted() {
            return;
        }
        let answers = self.ladder.fit_all(&new, &self.hints);
        for (effects, answer) in new.into_iter().zip(answers) {
            let answer = self.told(&effects, answer);
            self.known.insert(key(&effects), answer);
        }
    }

    /// Says how a fit went and keeps it for the record.
    fn told(&mut self, effects: &[String], answer: Result<Rung, L::Error>) -> Option<Rung> {
        match answer {
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
        }
    }

    /// Screens at a rung once.
    fn screen(&mut self, rung: &Rung) -> Result<Screen, L::Error> {
        if let Some(known) = self.screens.get(&key(&rung.effects)) {
            return Ok(known.clone());
        }
        let screen = self.ladder.screen(rung)?;
        self.screens.insert(key(&rung.effects), screen.clone());
        Ok(screen)
    }

    /// Whether a pair is better than one effect by enough for two names: on a record that stays
    /// unexplained nearly anything pays a little.
    fn worth_a_second(&self, one: &Rung, pair: &Rung) -> bool {
        pair.bic <= one.bic - self.policy.add_bic
            && (pair.explained(self.policy) || one.loses(pair, self.policy.min_share_unexplained))
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
            let untold =
                screen.findings.iter().filter(|f| f.refit_only && !current.effects.contains(&f.effect));
            let untold = singles(untold.map(|f| f.effect.clone()).collect());
            if let Some(other) = self.best_of(current, untold)
                && best.as_ref().is_none_or(|b| other.bic < b.bic)
            {
                best = Some(other);
            }
        }
        best
    }

    /// The best of the shortlist. Once one explains the record, only those are fitted that promised about
    /// as much: the others could not have taken its place. So those that promise about as much as the best
    /// are fitted together, then the next lot.
    fn best_single(&mut self, current: &Rung, screen: &Screen) -> Option<Rung> {
        let promise = |e: &String| screen.finding(e).map_or(0.0, |f| f.fall);
        let about_as_much = |most: f64| AS_MUCH * most;
        let (mut best, mut enough): (Option<Rung>, f64) = (None, 0.0);
        for places in [0..self.policy.refits, self.policy.refits..2 * self.policy.refits] {
            // The second half is for records that none of the first explains.
            if enough > 0.0 {
                break;
            }
            let mut left = self.shortlist(current, screen, places);
            while !left.is_empty() {
                let most = left.iter().map(promise).fold(0.0, f64::max);
                if most < enough {
                    break;
                }
                let (lot, rest) = left.into_iter().partition(|e| promise(e) >= about_as_much(most));
                left = rest;
                for rung in self.those_that_pay(current, &singles(lot)) {
                    if let ([.., name], true) = (rung.effects.as_slice(), rung.explained(self.policy)) {
                        enough = f64::max(enough, about_as_much(promise(name)));
                    }
                    best = Some(better(best, rung));
                }
            }
        }
        best
    }

    fn best_of(&mut self, current: &Rung, additions: Vec<Vec<String>>) -> Option<Rung> {
        self.those_that_pay(current, &additions).into_iter().fold(None, |best, rung| Some(better(best, rung)))
    }

    /// Fits the current model with each of the additions; those that pay for themselves.
    fn those_that_pay(&mut self, current: &Rung, additions: &[Vec<String>]) -> Vec<Rung> {
        let with = |add: &Vec<String>| current.effects.iter().chain(add).cloned().collect();
        let sets: Vec<Vec<String>> = additions.iter().map(with).collect();
        self.fit_all(&sets);
        let known = sets.iter().filter_map(|set| self.known.get(&key(set)).cloned().flatten());
        known.filter(|rung| pays(current, rung, self.policy)).collect()
    }

    /// The most significant effects by their places, and the look-alikes that explain about as much. Beyond the first
    /// `refits` only those that promise about as much as the best.
    fn shortlist(&self, current: &Rung, screen: &Screen, places: std::ops::Range<usize>) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let new = |f: &&crate::Finding| f.significant && !current.effects.contains(&f.effect);
        if current.explained(self.policy) && current.leans_on_the_mesh() {
            let best = screen.findings.iter().filter(new).map(|f| f.fall).fold(0.0, f64::max);
            let alike = screen.findings.iter().filter(new).filter(|f| f.fall >= 0.5 * best).count();
            if alike > self.policy.most_alike_leaning {
                return names;
            }
        }
        // What would not pay for itself even at twice the promise is not worth a fit.
        let least = if current.explained(self.policy) { 0.5 * current.least_fall(self.policy) } else { 0.0 };
        let mut significant: Vec<_> = screen
            .findings
            .iter()
            .filter(|f| f.significant && f.fall >= least && !current.effects.contains(&f.effect))
            .collect();
        significant.sort_by(|a, b| b.fall.total_cmp(&a.fall).then(a.effect.cmp(&b.effect)));
        // A linear promise is no more exact than that.
        let close = AS_MUCH * significant.first().map_or(0.0, |f| f.fall);
        let far_down = |i: usize, f: &Finding| i >= self.policy.refits && f.fall < close;
        for (i, f) in significant.into_iter().enumerate().take(places.end).skip(places.start) {
            if far_down(i, f) {
                break;
            }
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
            let without = |e: &String| rung.effects.iter().filter(|x| *x != e).cloned().collect();
            let sets: Vec<Vec<String>> = rung.effects.iter().map(without).collect();
            self.fit_all(&sets);
            let best = sets
                .iter()
                .filter_map(|set| self.known.get(&key(set)).cloned().flatten())
                .filter(|smaller| smaller.bic - rung.bic < self.policy.drop_bic)
                .fold(None, |best, smaller| Some(better(best, smaller)));
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
}

/// The one with the smaller BIC; the first where they are equal.
fn better(best: Option<Rung>, rung: Rung) -> Rung {
    match best {
        Some(b) if b.bic <= rung.bic => b,
        _ => rung,
    }
}

fn singles(names: Vec<String>) -> Vec<Vec<String>> {
    names.into_iter().map(|n| vec![n]).collect()
}

fn key(effects: &[String]) -> BTreeSet<String> {
    effects.iter().cloned().collect()
}

fn listed(effects: &[String]) -> String {
    if effects.is_empty() { "no effect".into() } else { effects.join(" + ") }
}
