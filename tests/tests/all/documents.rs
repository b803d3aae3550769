//! What the manual says in numbers is what the program does.
#![allow(missing_docs)]

use diagnose::{LEANS, Policy};

#[test]
fn the_page_about_names_gives_the_thresholds_of_the_search() {
    let page = include_str!("../../../docs/book/src/explanation/names.md").replace('\n', " ");
    let p = Policy::default();
    let percent = |share: f64| format!("{} %", 100.0 * share);
    assert!(
        (p.min_share_unexplained, p.tie_bic, p.held_out_fall) == (0.5, p.drop_bic, 0.0),
        "in words there"
    );
    for said in [
        format!("a false-discovery rate of {}", p.fdr),
        format!("a fall of χ² of {} at least", p.min_fall),
        format!("The first {} are refitted", p.refits),
        format!("lower BIC by {}", p.add_bic),
        format!("take {} of what χ² has", percent(p.min_share)),
        format!("lower χ² by {}.", p.min_fall_explained),
        format!("By {} where", p.min_fall_leaning),
        format!("a reduced χ² above {LEANS} without"),
        format!("more than {} effects promise half", p.most_alike_leaning),
        format!("less than {} of BIC", p.drop_bic),
        format!("At most {} effects", p.max_effects),
        format!("reduced χ² is at most {}, or within {} of", p.explained_chi2, p.explained_sigmas),
        format!("(p above {:e})", p.structure_p),
        format!("within {} of BIC", p.tie_bic),
        format!("within {} of χ²", p.separate_chi2),
    ] {
        assert!(page.contains(&said), "not in names.md: {said}");
    }
}

/// A how-to whose program does not run is worse than none: what the pages show are the examples that are compiled.
#[test]
fn the_how_tos_show_the_examples_word_for_word() {
    for (page, example) in [
        (
            include_str!("../../../docs/adding-a-law.md"),
            include_str!("../../../crates/effects/examples/own_laws.rs"),
        ),
        (
            include_str!("../../../docs/adding-an-experiment.md"),
            include_str!("../../../crates/effects/examples/own_experiment.rs"),
        ),
        (
            include_str!("../../../docs/adding-an-effect.md"),
            include_str!("../../../crates/effects/examples/own_effect.rs"),
        ),
    ] {
        assert!(page.contains(example), "{}", example.lines().next().unwrap_or_default());
    }
}
