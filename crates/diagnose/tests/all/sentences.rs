//! What is said to a user: every kind of sentence, whole, with the numbers that belong in it.
#![allow(missing_docs)]

use crate::tables;

use diagnose::atlas::SegmentMisfit;
use diagnose::dependence::Dependence;
use diagnose::*;

fn finding() -> Finding {
    Finding {
        effect: "drift".into(),
        amplitudes: vec![("g".into(), 0.1234)],
        std_errors: vec![0.01],
        shape: vec![("tau".into(), 12.5)],
        shape_index: 0,
        fall: 50.0,
        expected_fall: 0.25,
        p_value: 2e-9,
        p_estimated: None,
        p_bonferroni: 2e-9,
        q_value: 1e-8,
        visibility: 0.5,
        snr: 3.21,
        visible: true,
        significant: true,
        look_alikes: vec![],
        refit_only: false,
        set_aside: false,
    }
}

#[test]
fn a_finding_is_one_of_five_sentences() {
    let say = |f: &Finding| words::finding(f, &Policy::default());
    let f = finding();
    assert_eq!(say(&f), "drift would take away 25 % of χ² (p = 2e-9), with g ≈ 0.123, tau ≈ 12.5.");
    let alike = Finding { look_alikes: ["a", "b", "c"].map(String::from).to_vec(), ..f.clone() };
    assert!(say(&alike).ends_with(" These records cannot tell it from a, b or c."), "{}", say(&alike));
    let aside = Finding { set_aside: true, ..f.clone() };
    assert_eq!(
        say(&aside),
        "drift would take away 25 % of χ² (p = 2e-9): as little as the error of the mesh may do. A small amount of it \
         cannot be excluded."
    );
    let untold = |fall: f64| Finding { refit_only: true, fall, ..f.clone() };
    assert_eq!(say(&untold(9.9)), "drift: its derivative at neutral does not tell; a short refit decides.");
    assert_eq!(say(&untold(10.0)), say(&f));
    let faint = Finding { significant: false, p_value: 0.0421, ..f.clone() };
    assert_eq!(say(&faint), "drift is not called for (p = 0.042), though a plausible amount would show.");
    let blind = Finding { visible: false, ..faint.clone() };
    assert!(
        say(&blind)
            .starts_with("drift cannot be seen in these records: a plausible amount shows at 3.2 noise")
    );
    // Three digits, in powers of ten where they would be lost.
    for (x, said) in [(0.0, "0"), (1e-3, "0.00100"), (-9e-4, "-9.00e-4"), (9999.0, "9999"), (-1e4, "-1.00e4")]
    {
        let f = Finding { amplitudes: vec![("g".into(), x)], shape: vec![], ..f.clone() };
        assert!(say(&f).ends_with(&format!("with g ≈ {said}.")), "{}", say(&f));
    }
    assert!(say(&Finding { p_value: 1e-3, ..faint.clone() }).contains("(p = 0.001)"));
    assert!(say(&Finding { p_value: 1e-300, ..f.clone() }).contains("(p < 1e-99)"));
    assert!(say(&Finding { p_value: 9e-4, ..faint.clone() }).contains("(p = 9e-4)"));
    // The noise as estimated is what is said; where it alone would call the effect, so is the conservative one.
    let both = |p_estimated: f64, p_value: f64| {
        say(&Finding { p_estimated: Some(p_estimated), p_value, ..faint.clone() })
    };
    assert_eq!(
        both(0.0421, 0.05),
        "drift is not called for (p = 0.042; 0.050 if the noise is as correlated as these records allow), though a \
         plausible amount would show."
    );
    assert!(both(0.05, 0.2).contains("(p = 0.050), though"), "{}", both(0.05, 0.2));
    assert!(both(0.01, 0.04).contains("(p = 0.010), though"), "{}", both(0.01, 0.04));
    let sure = |set_aside: bool| Finding { p_estimated: Some(3e-12), set_aside, ..f.clone() };
    assert!([true, false].iter().all(|&aside| say(&sure(aside)).contains("(p = 3e-12)")));
}

fn rung(effects: &[&str], chi2: f64) -> Rung {
    let (freedom, reduced_chi2) = (100.0, chi2 / 100.0);
    Rung { points: 100, freedom, reduced_chi2, rms: 0.1, bic: chi2, ..tables::rung(effects, chi2, 3) }
}

fn ended(verdict: Verdict, found: &[&str], last: f64) -> Discovery {
    let screen = Screen { findings: vec![], pairs: vec![], chi2: 400.0, freedom: 100 };
    let found: Vec<String> = found.iter().map(|f| (*f).to_owned()).collect();
    let groups = found.iter().map(|f| vec![f.clone(), format!("{f}'")]).collect();
    let ladder = vec![rung(&[], 400.0), rung(&[], last)];
    let (tried, failed, last_screen) = (ladder.clone(), vec![], screen.clone());
    Discovery { ladder, tried, failed, screen, last_screen, found, groups, verdict, interrupted: false }
}

#[test]
fn a_verdict_says_what_was_found_and_what_is_left() {
    let say = |d: &Discovery| words::verdict(d, &Policy::default());
    let explained = ended(Verdict::Explained, &["a", "b"], 105.0);
    assert_eq!(
        say(&explained),
        "Missing were a and b: with them reduced χ² falls from 4.00 to 1.05, and no rival does as well."
    );
    assert_eq!(
        say(&ended(Verdict::Ambiguous, &["a", "b"], 105.0)),
        "The record is explained (reduced χ² from 4.00 to 1.05), but not uniquely: missing was a or a', and b or b', \
         which these records cannot tell apart."
    );
    assert!(say(&ended(Verdict::Explained, &["a"], 105.0)).starts_with("Missing was a: with it reduced"));
    for verdict in [Verdict::Explained, Verdict::Ambiguous] {
        let mut leaning = ended(verdict, &["a"], 105.0);
        leaning.ladder[1].reduced_chi2 = 38.6;
        let said = say(&leaning);
        assert!(
            said.contains("(reduced χ² 38.6 with the noise alone): a finer mesh may show more."),
            "{said}"
        );
    }
    assert!(say(&ended(Verdict::Unexplained, &["a", "b"], 250.0)).starts_with("a and b help (reduced"));
    let open = ended(Verdict::Unexplained, &["a"], 250.0);
    let helps = "a helps (reduced χ² from 4.00 to 2.50) but does not explain the record: something else is missing \
                 that the catalogue does not hold.";
    assert_eq!(say(&open), helps);
    let mut smooth = open.clone();
    smooth.ladder[1].structure_p = 1e-7;
    assert_eq!(say(&smooth), format!("{helps} What is left is smooth, not noise."));
    smooth.interrupted = true;
    assert!(say(&smooth).ends_with(" The search was stopped before its end."));
    smooth.verdict = Verdict::Explained;
    assert!(!say(&smooth).contains("smooth"), "only what is unexplained is left over");
    assert!(
        say(&ended(Verdict::Unexplained, &[], 250.0))
            .ends_with("reduced χ² 2.50, and no effect pays for itself.")
    );
    let mut nothing = ended(Verdict::NothingMissing, &[], 95.0);
    assert_eq!(say(&nothing), "Nothing is missing: the misfit is noise (reduced χ² 0.95).");
    nothing.screen.findings =
        vec![finding(), Finding { visible: false, effect: "creep".into(), ..finding() }];
    assert!(
        say(&nothing).ends_with(" Whether there is creep these records cannot say."),
        "{}",
        say(&nothing)
    );
}

fn misfit(segment: &str, share: f64, sign: char) -> SegmentMisfit {
    SegmentMisfit {
        segment: segment.into(),
        points: 10,
        share,
        rms: 0.1,
        mean: 0.0,
        sign,
        autocorrelation: 0.0,
        durbin_watson: 2.0,
        runs_p: 0.5,
    }
}

#[test]
fn the_place_of_a_misfit_is_its_three_largest_shares_from_a_tenth_on() {
    let rows = |shares: [f64; 5]| {
        let names = ["a", "b", "c", "d", "e"];
        let signs = ['+', '-', '0', '0', '0'];
        (0..5).map(|k| misfit(names[k], shares[k], signs[k])).collect::<Vec<_>>()
    };
    assert_eq!(
        words::place(&rows([0.2, 0.4, 0.1, 0.05, 0.25])),
        "The misfit sits in b (40 %, measured below the model), e (25 %) and a (20 %, measured above the model)."
    );
    assert_eq!(
        words::place(&rows([0.09, 0.81, 0.1, 0.0, 0.0])),
        "The misfit sits in b (81 %, measured below the model) and c (10 %)."
    );
    assert_eq!(words::place(&rows([0.09; 5])), "The misfit is spread over all segments.");
}

#[test]
fn a_dependence_is_named_when_it_is_sure_and_counts() {
    let row = |variable: &str, share_beyond: f64, p_value: f64| Dependence {
        variable: variable.into(),
        share_alone: 0.5,
        share_beyond,
        p_value,
    };
    let rows =
        [row("rate", 0.3, 1e-5), row("time", 0.2, 1e-3), row("force", 0.019, 1e-9), row("cycle", 0.02, 1e-9)];
    assert_eq!(
        words::depends(&rows),
        "The misfit depends on rate (30 % beyond the others) and cycle (2 % beyond the others)."
    );
    assert_eq!(words::depends(&rows[1..3]), "No single variable explains the misfit beyond the others.");
}
