//! What the manual says in numbers is what the program does.
#![allow(missing_docs)]

use evidence::{CREDIBLE, SetPrior, WRONG_NAME};

#[test]
fn the_page_about_names_gives_the_numbers_that_decide() {
    let page = include_str!("../../../docs/book/src/explanation/names.md").replace('\n', " ");
    let percent = |share: f64| format!("{} %", 100.0 * share);
    let p = SetPrior::of_catalogue(22);
    for said in [
        format!("costs {WRONG_NAME} times"),
        format!("hold {}", percent(CREDIBLE)),
        format!("a probability above {}", percent(1.0 - 1.0 / WRONG_NAME)),
        format!("{} effects are expected", p.expected),
        format!("{} of records", percent(p.beyond)),
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
