//! The list of cases: what is hidden, how strong, in which protocol. Everything else is drawn from the case's seed.

use crate::foreign::Foreign;
use crate::outside::Outside;
use model::Catalogue;
use serde::{Deserialize, Serialize};

/// What is done to the strips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Protocol {
    /// Cycles at one rate, as in the paper.
    Paper,
    /// Two rates, a hold, a rest, unloadings along the tear.
    Rich,
}

/// What is hidden in a record.
#[derive(Clone, Debug, PartialEq)]
pub enum Hidden {
    /// Nothing: the base model is the truth.
    None,
    /// Effects of the catalogue with their strengths (1 is ordinary, see [`crate::amplitude`]).
    Effects(Vec<(String, f64)>),
    /// Something that no catalogue entry describes.
    Outside(Outside, f64),
    /// Something whose kind the catalogue holds, by another formula.
    Foreign(Foreign, f64),
}

/// One case of the suite.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Name of its folder; says nothing about what is hidden.
    pub name: String,
    /// Everything random in the case comes from here.
    pub seed: u64,
    /// Protocol.
    pub protocol: Protocol,
    /// What is hidden.
    pub hidden: Hidden,
    /// Autocorrelated noise instead of white.
    pub correlated: bool,
}

/// Strengths of single effects.
pub const STRENGTHS: [f64; 3] = [0.5, 1.0, 2.0];

/// Records without any effect.
const NONE: usize = 20;

/// Records per outside effect, and per foreign law.
const OUTSIDE: usize = 8;

/// Two effects at once, on different causes that a laboratory may well meet together.
const PAIRS: [(&str, &str); 15] = [
    ("viscoelastic", "compliance"),
    ("viscoelastic", "rate_dependent_strength"),
    ("mullins", "bridging"),
    ("mullins", "drift"),
    ("permanent_set", "fatigue"),
    ("viscoelastic", "residual_opening"),
    ("mullins", "misalignment"),
    ("stiffness_drift", "bridging"),
    ("fiber_damage", "viscoelastic"),
    ("drift", "rate_dependent_strength"),
    ("prestretch", "mullins"),
    ("gain", "viscoelastic"),
    ("lag", "mullins"),
    ("grip_slip", "residual_opening"),
    ("fiber_recruitment", "fatigue"),
];

/// Effects that are hidden: the catalogue without its negative controls.
pub fn hideable(catalogue: &Catalogue) -> Vec<String> {
    catalogue.iter().map(|e| e.card()).filter(|c| !c.negative_control).map(|c| c.name.to_owned()).collect()
}

/// The whole suite of one first seed, always the same: of the product's catalogue, not the generator's.
pub fn suite(catalogue: &Catalogue, first_seed: u64) -> Vec<Spec> {
    let both = [Protocol::Paper, Protocol::Rich];
    let mut list: Vec<(Protocol, Hidden)> = Vec::new();
    for effect in hideable(catalogue) {
        for strength in STRENGTHS {
            list.extend(both.map(|p| (p, Hidden::Effects(vec![(effect.clone(), strength)]))));
        }
    }
    list.extend((0..NONE).map(|i| (both[i % 2], Hidden::None)));
    for (i, (a, b)) in PAIRS.iter().enumerate() {
        // Pairs need what tells effects apart: two thirds rich.
        let protocol = both[usize::from(i % 3 != 0)];
        list.push((protocol, Hidden::Effects(vec![((*a).into(), 1.5), ((*b).into(), 1.5)])));
    }
    let (first, later) = Outside::ALL.split_at(Outside::FIRST);
    let strength = |i: usize| if i < OUTSIDE / 2 { 1.0 } else { 2.0 };
    let outside = |outside: &Outside| {
        let outside = *outside;
        (0..OUTSIDE).map(move |i| (both[i % 2], Hidden::Outside(outside, strength(i))))
    };
    list.extend(first.iter().flat_map(outside));
    // Later additions stand at the end, lest a case change its number. The same pairs, stronger: at 1.5 one of the two
    // is often for the others to imitate.
    for (a, b) in &PAIRS {
        list.push((Protocol::Rich, Hidden::Effects(vec![((*a).into(), 2.0), ((*b).into(), 2.0)])));
    }
    list.extend(later.iter().flat_map(outside));
    for foreign in Foreign::ALL {
        list.extend((0..OUTSIDE).map(|i| (both[i % 2], Hidden::Foreign(foreign, strength(i)))));
    }
    list.into_iter()
        .enumerate()
        .map(|(i, (protocol, hidden))| Spec {
            name: format!("case-{:03}", i + 1),
            seed: first_seed + i as u64,
            protocol,
            hidden,
            correlated: (i / 2) % 2 == 1,
        })
        .collect()
}

/// In an order that goes through the suite again and again, in steps of its golden section: what is there when a study is stopped is a
/// sample of it.
pub fn spread(specs: &[Spec]) -> Vec<&Spec> {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let mut all: Vec<(f64, &Spec)> =
        specs.iter().enumerate().map(|(i, s)| ((i as f64 * golden).fract(), s)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(_, s)| s).collect()
}

impl Hidden {
    /// In words, for tables.
    pub fn words(&self) -> Vec<String> {
        match self {
            Self::None => Vec::new(),
            Self::Effects(list) => list.iter().map(|e| e.0.clone()).collect(),
            Self::Outside(o, _) => vec![o.word().to_owned()],
            Self::Foreign(f, _) => vec![f.word().to_owned()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whenever it is stopped, every kind and each protocol has about its share of what was asked.
    #[test]
    fn a_study_that_is_stopped_is_a_sample() {
        let all = suite(&effects::catalogue(), 1);
        let order = spread(&all);
        let mut names: Vec<&str> = order.iter().map(|s| s.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all.len());
        let rich = |s: &&Spec| s.protocol == Protocol::Rich;
        let single = |s: &&Spec| matches!(&s.hidden, Hidden::Effects(e) if e.len() == 1);
        let outside = |s: &&Spec| matches!(s.hidden, Hidden::Outside(..));
        let foreign = |s: &&Spec| matches!(s.hidden, Hidden::Foreign(..));
        for some in [24, 46, 92, 180] {
            for kind in [&rich as &dyn Fn(&&Spec) -> bool, &single, &outside, &foreign] {
                let share = |n: usize, there: usize| there as f64 / n as f64;
                let (here, of_all) = (
                    share(some, order[..some].iter().copied().filter(|s| kind(s)).count()),
                    share(all.len(), all.iter().filter(kind).count()),
                );
                assert!((here - of_all).abs() < 0.08, "of {some} {here}, of all {of_all}");
            }
        }
    }
}
