use super::*;

fn law() -> Exported {
    Exported {
        specimen: "a\nb -- \"c\"".into(),
        run: "runs/a".into(),
        effects: vec!["viscoelastic".into()],
        mu: 0.005,
        k1: 0.9,
        k2: 20.0,
        gamma: 0.6,
        kappa: 0.2,
        d: 0.1,
        areas: vec![[0.15, 0.08]],
        forces: vec![[1.1, 0.01], [1.2, 0.09]],
    }
}

#[test]
fn what_was_not_run_says_so_and_names_stay_in_their_comment() {
    for (program, ending) in [(Program::Abaqus, "inp"), (Program::Febio, "feb"), (Program::Felupe, "py")] {
        let (end, text) = deck(program, &law());
        assert_eq!(end, ending);
        assert_eq!(text.contains("NOT RUN THERE"), program != Program::Felupe);
        assert!(text.contains("NOT IN HERE") && text.contains("viscoelastic") && text.contains("Gc = 0.15"));
        assert!(!text.contains("a\nb"), "a name ends no comment");
    }
    // A comment of XML ends at the first pair of dashes.
    let feb = deck(Program::Febio, &law()).1;
    let comment = feb.split_once("<!--").and_then(|(_, rest)| rest.split_once("-->")).map_or("", |c| c.0);
    assert!(!comment.is_empty() && !comment.contains("--"), "{comment}");
}

#[test]
fn each_program_gets_the_law_in_its_own_constants() {
    let abaqus = deck(Program::Abaqus, &law()).1;
    assert!(abaqus.contains("\n0.0025, 0.1, 0.9, 20.0, 0.2\n"), "C10 = mu/2, D, k1, k2, kappa");
    let febio = deck(Program::Febio, &law()).1;
    assert!(febio.contains("<c>0.005</c>") && febio.contains("<k>20.0</k>"), "c = mu, k = 2/D");
    assert!(febio.contains(&format!("<gamma>{:?}</gamma>", 0.6f64.to_degrees())));
}
