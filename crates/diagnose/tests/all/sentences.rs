//! What is said to a user: every kind of sentence, whole, with the numbers that belong in it.
#![allow(missing_docs)]

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
    }
}

#[test]
fn a_finding_is_one_of_four_sentences() {
    let say = |f: &Finding| words::finding(f, &Policy::default());
    let f = finding();
    assert_eq!(say(&f), "drift would take away 25 % of χ² (p = 2e-9), with g ≈ 0.123, tau ≈ 12.5.");
    let alike = Finding { look_alikes: ["a", "b", "c"].map(String::from).to_vec(), ..f.clone() };
    assert!(say(&alike).ends_with(" These records cannot tell it from a, b or c."), "{}", say(&alike));
    let indistinguishable = |fall: f64| Finding { refit_only: true, fall, ..f.clone() };
    assert_eq!(
        say(&indistinguishable(9.9)),
        "drift: its derivative at neutral does not tell; a short refit decides."
    );
    assert_eq!(say(&indistinguishable(10.0)), say(&f));
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
    assert!(say(&Finding { p_estimated: Some(3e-12), ..f.clone() }).contains("(p = 3e-12)"));
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
