//! A small catalogue for the tests of this crate.
#![allow(dead_code)]

use input::{
    EffectRegistry, ExperimentRegistry, LawRegistry, LawSite, OptionKind, OptionSpec, OptionValue, TestKind,
};
use params::{ParamSpec, Quantity};
use std::collections::BTreeMap;

/// Four effects: one with options, two that exclude each other, one for a named test.
pub struct Catalogue;

impl LawRegistry for Catalogue {
    fn law_names(&self, site: LawSite) -> Vec<String> {
        laws::registry().law_names(site)
    }

    fn law_options(&self, site: LawSite, law: &str) -> Vec<OptionSpec> {
        laws::registry().law_options(site, law)
    }

    fn law_parameters(
        &self,
        site: LawSite,
        law: &str,
        options: &BTreeMap<String, OptionValue>,
    ) -> Option<Vec<ParamSpec>> {
        laws::registry().law_parameters(site, law, options)
    }
}

impl ExperimentRegistry for Catalogue {
    fn kinds(&self) -> Vec<TestKind> {
        experiments::registry().kinds()
    }
}

impl EffectRegistry for Catalogue {
    fn names(&self) -> Vec<&str> {
        vec!["viscoelastic", "compliance", "slack", "gain"]
    }

    fn parameters(&self, effect: &str) -> Option<Vec<ParamSpec>> {
        let spec = ParamSpec::new;
        Some(match effect {
            "viscoelastic" => vec![
                spec("g", "g", Quantity::Dimensionless, (0.0, 0.95), 0.1, "share of the relaxing stress")
                    .neutral(0.0),
                spec("tau", "τ", Quantity::Time, (1e-3, 1e6), 10.0, "relaxation time"),
            ],
            "compliance" => {
                vec![spec("c", "C", Quantity::Compliance, (0.0, 100.0), 0.01, "compliance").neutral(0.0)]
            }
            "slack" => vec![spec("u0", "u0", Quantity::Length, (0.0, 10.0), 0.05, "slack").neutral(0.0)],
            "gain" => vec![spec("g", "g", Quantity::Dimensionless, (-0.5, 0.5), 0.0, "gain").neutral(0.0)],
            _ => return None,
        })
    }

    fn excludes(&self, effect: &str) -> Vec<String> {
        if effect == "slack" { vec!["compliance".to_owned()] } else { Vec::new() }
    }

    fn options(&self, effect: &str) -> Vec<OptionSpec> {
        let option = |name: &str, kind, default| OptionSpec {
            name: name.to_owned(),
            kind,
            default,
            description: name.to_owned(),
        };
        match effect {
            "viscoelastic" => {
                let integer = OptionKind::Integer { min: 1, max: 4 };
                vec![option("branches", integer, Some(OptionValue::Integer(1)))]
            }
            "gain" => vec![option("test", OptionKind::Test, None)],
            _ => Vec::new(),
        }
    }
}

/// A specimen without records, as text to which a test can append.
pub const STRIP: &str = "\
name = \"strip\"
[geometry]
length_mm = 10.0
width_mm = 6.0
thickness_mm = 0.8
cut_mm = 1.0
[[tests]]
kind = \"uniaxial\"
protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }, { hold_s = 60.0 }]
[[tests]]
kind = \"tearing\"
protocol = [{ to_mm = 4.0, rate_mm_per_s = 0.05 }]
";
