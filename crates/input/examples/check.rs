//! Reads specimens and configs and prints what is resolved, with a catalogue of names only:
//! `cargo run -p input --example check -- FILE…`

use input::{
    EffectRegistry, ExperimentRegistry, LawRegistry, LawSite, OptionSpec, OptionValue, TestKind, read_case,
    resolved_toml,
};
use params::{ParamSpec, Quantity};
use std::collections::BTreeMap;
use std::path::Path;

struct Catalogue;

const NAMES: [&str; 22] = [
    "viscoelastic",
    "mullins",
    "permanent_set",
    "fiber_recruitment",
    "fiber_damage",
    "stiffness_drift",
    "law_shape",
    "bridging",
    "rate_dependent_strength",
    "fatigue",
    "residual_opening",
    "heterogeneity",
    "compliance",
    "grip_slip",
    "slack",
    "misalignment",
    "thickness_taper",
    "cut_length",
    "prestretch",
    "drift",
    "gain",
    "lag",
];

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
        NAMES.to_vec()
    }

    fn parameters(&self, effect: &str) -> Option<Vec<ParamSpec>> {
        let amplitude = ParamSpec::new("a", "a", Quantity::Dimensionless, (0.0, 10.0), 0.1, "amplitude");
        NAMES.contains(&effect).then(|| vec![amplitude])
    }
}

fn main() {
    for file in std::env::args().skip(1) {
        match read_case(Path::new(&file), &Catalogue) {
            Ok(case) => {
                case.warnings.iter().for_each(|w| eprintln!("{w}"));
                let text = resolved_toml(&case);
                let again = std::env::temp_dir().join("fct-input-check.toml");
                let same = std::fs::write(&again, &text).is_ok()
                    && read_case(&again, &Catalogue).is_ok_and(|again| again.same_input(&case));
                println!("{text}\n# {file}: reads back {}", if same { "equal" } else { "DIFFERENT" });
            }
            Err(diagnostics) => eprintln!("{diagnostics}\n"),
        }
    }
}
