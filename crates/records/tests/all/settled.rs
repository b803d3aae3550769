//! Signs, offsets and slack: seen and proposed, changed only when asked.

use crate::common::{HEAD, read};
use records::{Import, Test};

#[test]
fn signs_and_offsets_are_proposed_and_changed_only_when_asked() {
    let rows: String = (0..60)
        .map(|i| format!("{i},{},{}\n", -3.0 - f64::from(i) / 10.0, -0.5 - f64::from(i * i) / 100.0))
        .collect();
    let text = format!("{HEAD}{rows}");
    let plain = read(&text, &[]);
    let flags: Vec<&str> = plain.tests[0].proposals.iter().map(|p| p.flag.as_str()).collect();
    assert_eq!(flags, ["--flip displacement", "--flip force", "--zero", "--tare"]);
    assert_eq!((plain.tests[0].full.displacement[0], plain.tests[0].full.force[0]), (-3.0, -0.5));
    let done = read(&text, &[("flip", ""), ("zero", ""), ("tare", "")]);
    let test = &done.tests[0];
    assert!(test.proposals.is_empty(), "{:?}", test.proposals);
    assert_eq!((test.full.displacement[0], test.full.force[0], test.done.len()), (0.0, 0.0, 4));
    assert!((test.full.displacement[59] - 5.9).abs() < 1e-12 && (test.full.force[59] - 34.81).abs() < 1e-12);
    let slack: String =
        (0..60).map(|i| format!("{i},{},{}\n", f64::from(i) / 10.0, f64::from((i - 20).max(0)))).collect();
    let slack = read(&format!("{HEAD}{slack}"), &[]);
    assert!(slack.tests[0].proposals[0].why.contains("slack"), "{:?}", slack.tests[0].proposals);
}

/// Rows from functions of their number.
fn rows(count: i32, displacement: impl Fn(f64) -> f64, force: impl Fn(f64) -> f64) -> String {
    let row = |i: i32| format!("{i},{},{}\n", displacement(f64::from(i)), force(f64::from(i)));
    format!("{HEAD}{}", (0..count).map(row).collect::<String>())
}

fn only(read: Import) -> Test {
    read.tests.into_iter().next().expect("a test")
}

fn flags(test: &Test) -> Vec<&str> {
    test.proposals.iter().map(|p| p.flag.as_str()).collect()
}

/// `--flip` alone turns what runs to negative values; with a name it turns that, whatever it looks like.
#[test]
fn a_named_sign_is_turned_whatever_it_looks_like() {
    let pulled = rows(60, |i| i, |i| 2.0 * i);
    for (said, u, f) in
        [("", 59.0, 118.0), ("force", 59.0, -118.0), ("displacement", -59.0, 118.0), ("both", -59.0, -118.0)]
    {
        let test = only(read(&pulled, &[("flip", said)]));
        assert_eq!((test.full.displacement[59], test.full.force[59]), (u, f), "{said:?}");
    }
    let pushed = rows(60, |i| -i, |i| -2.0 * i);
    let test = only(read(&pushed, &[("flip", "force")]));
    assert_eq!((test.full.displacement[59], test.full.force[59]), (-59.0, 118.0));
    assert_eq!(flags(&test), ["--flip displacement"]);
}

/// What is taken off the force is the mean before the motion, and what is left does not hide the slack.
#[test]
fn a_preload_is_the_mean_at_rest_and_hides_no_slack() {
    let jitter = |i: f64| if i % 2.0 == 0.0 { 2.0 } else { 2.2 };
    let text = rows(80, |i| (i - 20.0).max(0.0) / 10.0, |i| jitter(i) + 4.0 * (i - 50.0).max(0.0));
    let plain = only(read(&text, &[]));
    assert_eq!(flags(&plain), ["--tare", ""]);
    assert!(
        plain.proposals[0].why.contains("the force before the motion is 2.09524 N"),
        "{:?}",
        plain.proposals
    );
    let tared = only(read(&text, &[("tare", "")]));
    assert_eq!(flags(&tared), [""]);
    assert!(tared.proposals[0].why.contains("no force over the first 3.1 mm"), "{:?}", tared.proposals);
    assert!((tared.full.force[0] + 0.2 / 2.1).abs() < 1e-9, "{}", tared.full.force[0]);
}

/// Few rows far apart are no slack, nor is a long rest before the motion.
#[test]
fn what_carries_as_soon_as_it_moves_is_not_slack() {
    assert_eq!(flags(&only(read(&rows(5, |i| i, |i| 3.0 * i), &[]))), [""; 0]);
    let rest = rows(60, |i| (i - 30.0).max(0.0), |i| 3.0 * (i - 30.0).max(0.0));
    assert_eq!(flags(&only(read(&rest, &[]))), [""; 0]);
}

/// The same along x, whose signs only `--flip` alone or for both turns.
#[test]
fn a_second_axis_is_settled_by_the_same_flags() {
    let row = |i: i32| {
        let t = f64::from(i);
        format!("{i},{t},{},{},{}\n", 2.0 * t, -4.0 - 0.5 * t, -1.0 - 3.0 * t)
    };
    let body: String = (0..60).map(row).collect();
    let text = format!("time_s,displacement_mm,force_N,displacement_x_mm,force_x_N\n{body}");
    let along_x = |said: &[(&str, &str)]| {
        let test = only(read(&text, &[&[("two-axes", "")], said].concat()));
        let [Some(u), Some(f)] = &test.full.across else { panic!("no second axis") };
        let proposed: Vec<String> = flags(&test).into_iter().map(str::to_owned).collect();
        ([u[0], u[59], f[0], f[59]], proposed, test.done)
    };
    let (values, proposed, done) = along_x(&[]);
    assert_eq!(values, [-4.0, -33.5, -1.0, -178.0]);
    assert!(proposed == ["--flip", "--flip", "--zero"] && done.is_empty(), "{proposed:?} {done:?}");
    assert_eq!(along_x(&[("flip", "force")]).0, [-4.0, -33.5, -1.0, -178.0]);
    for said in ["", "both"] {
        let both = along_x(&[("flip", said)]);
        assert_eq!(both.0, [4.0, 33.5, 1.0, 178.0], "{said:?}");
    }
    let (values, proposed, done) = along_x(&[("flip", ""), ("zero", ""), ("tare", "")]);
    assert_eq!(values, [0.0, 29.5, 0.0, 177.0]);
    assert!(proposed.is_empty(), "{proposed:?}");
    assert!(done.iter().any(|d| d == "1 N taken off the force along x (--tare)"), "{done:?}");
}
