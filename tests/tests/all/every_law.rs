//! Every law of the registry from a file to a fit: a small strip is simulated and its parameters are found again.

use analysis::{Control, NoJournal, SimulateControl, identify, simulate};
use input::{Case, LawRegistry, LawSite};
use std::fs;
use std::path::Path;
use std::sync::Arc;

const STRIP: &str = "\
name = \"strip\"
[geometry]
length_mm = 6.0
width_mm = 4.0
thickness_mm = 0.8
cut_mm = 1.0
[mesh]
divisions = [4, 4, 1]
";

/// A law, its keys, and parameters with truth and start.
type Law = (&'static str, &'static str, &'static [(&'static str, f64, f64)]);

/// The bulk of each law: truth (file unit), and start of the fit for what is free.
const BULK: [Law; 6] = [
    ("hgo", "gamma_deg = 40.0\nkappa = 0.2\nk2 = 3.0\n", &[("mu_kPa", 12.0, 18.0), ("k1_kPa", 60.0, 40.0)]),
    ("neo_hooke", "", &[("mu_kPa", 30.0, 50.0)]),
    ("yeoh", "c3_kPa = 4.0\n", &[("c1_kPa", 10.0, 15.0), ("c2_kPa", 8.0, 4.0)]),
    ("ogden", "", &[("mu1_kPa", 20.0, 35.0), ("alpha1", 7.0, 4.0)]),
    (
        "four_fiber",
        "gamma_deg = 40.0\nk2 = 2.0\nk1_axial_kPa = 10.0\nk2_axial = 1.0\nk2_circ = 1.0\nk1_kPa = 30.0\n",
        &[("mu_kPa", 12.0, 18.0), ("k1_circ_kPa", 40.0, 25.0)],
    ),
    (
        "holzapfel_ogden",
        "b = 2.0\nb_f = 2.0\na_s_kPa = 4.0\nb_s = 2.0\na_fs_kPa = 1.0\nb_fs = 2.0\n",
        &[("a_kPa", 20.0, 30.0), ("a_f_kPa", 15.0, 10.0)],
    ),
];

/// Reads a case made of parts, in a folder that is left to the caller.
fn case(folder: &Path, text: &str) -> Arc<Case> {
    let file = folder.join("case.toml");
    fs::write(&file, text).expect("written");
    Arc::new(input::read_case(&file, &effects::catalogue()).unwrap_or_else(|e| panic!("{e}\n{text}")))
}

/// The forward run of a truth, as records beside it: `<test>.csv`, with a ripple of 0.2 % of the peak as noise.
fn records(folder: &Path, truth: &str) {
    let control = SimulateControl { progress: &|_, _| (), cancelled: &|| false };
    let done = simulate(case(folder, truth), &effects::catalogue(), &control).expect("it runs");
    for t in &done.tests {
        assert!(t.failure.is_none(), "{truth}: {:?}", t.failure);
        let peak = t.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let mut text = String::from("time_s,displacement_mm,force_N\n");
        let mut seed = 0x9E37_79B9_7F4A_7C15u64;
        for ((time, u), f) in t.time.iter().zip(&t.displacement).zip(&t.force) {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            let noise = ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0) * 0.0035 * peak;
            text.push_str(&format!("{time},{u},{}\n", f + if *u == 0.0 { 0.0 } else { noise }));
        }
        fs::write(folder.join(format!("{}.csv", t.name)), text).expect("written");
    }
}

const SOLVER: &str = "[solver]\nstep_mm = 0.04\n";

fn lines(free: &[(&str, f64, f64)], pick: impl Fn(&(&str, f64, f64)) -> f64) -> String {
    free.iter().map(|p| format!("{} = {:?}\n", p.0, pick(p))).collect()
}

/// Holds every number of a block at its value.
fn held(block: &str) -> String {
    let line = |l: &str| match l.split_once(" = ") {
        Some((key, value)) => format!("{key} = {{ value = {value}, fixed = true }}\n"),
        None => format!("{l}\n"),
    };
    block.lines().map(line).collect()
}

fn found_again(fit: Arc<Case>, truth: &[(&str, f64)]) {
    let control = Control { progress: &|_| (), cancelled: &|| false, journal: &NoJournal };
    let done = identify(fit, &effects::catalogue(), &control).expect("a fit");
    for (path, value) in truth {
        let at = done.model.find(path).unwrap_or_else(|| panic!("no {path}"));
        let found = done.theta[at];
        println!("  {path}: {value} found as {found:.6}");
        assert!((found / value - 1.0).abs() < 0.05, "{path}: {value} found as {found}");
    }
}

fn bulk_law(name: &str) {
    let (law, other, free) = BULK.into_iter().find(|l| l.0 == name).expect("a law with values");
    println!("{law}");
    let folder = tempfile::tempdir().expect("a folder");
    let bulk = |values: String, other: &str| format!("[bulk]\nlaw = \"{law}\"\n{other}{values}");
    let test = |what: &str| format!("[[tests]]\nkind = \"uniaxial\"\n{what}\n");
    let protocol = test("protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]");
    records(folder.path(), &format!("{STRIP}{protocol}{}{SOLVER}", bulk(lines(free, |p| p.1), other)));
    let data = test("data = \"uniaxial.csv\"");
    let fit = format!("{STRIP}{data}{}", bulk(lines(free, |p| p.2), &held(other)));
    let fit = case(folder.path(), &fit);
    let unit = |key: &str| if key.ends_with("_kPa") { 1e-3 } else { 1.0 };
    let truth: Vec<(String, f64)> =
        free.iter().map(|p| (format!("bulk.{}", p.0.trim_end_matches("_kPa")), p.1 * unit(p.0))).collect();
    let truth: Vec<(&str, f64)> = truth.iter().map(|(p, v)| (p.as_str(), *v)).collect();
    found_again(fit, &truth);
}

fn interface_law(law: &str, shape: &str) {
    println!("{law}");
    let folder = tempfile::tempdir().expect("a folder");
    let bulk = |word: &str| format!("[bulk]\nlaw = \"neo_hooke\"\nmu_kPa = {word}\n");
    let tear = |gc: f64, sigma_c: f64| {
        format!("[interface]\nlaw = \"{law}\"\ngc_N_per_mm = {gc}\nsigma_c_MPa = {sigma_c}\n{shape}")
    };
    let test = |what: &str| format!("[[tests]]\nkind = \"tearing\"\n{what}\n");
    let protocol = "protocol = [{ to_mm = 3.0, rate_mm_per_s = 0.05 }, { to_mm = 2.0, rate_mm_per_s = 0.05 }, \
                    { to_mm = 7.0, rate_mm_per_s = 0.05 }]";
    let mesh = STRIP.replace("[4, 4, 1]", "[12, 4, 1]");
    records(folder.path(), &format!("{mesh}{}{}{}{SOLVER}", test(protocol), bulk("60.0"), tear(0.06, 0.03)));
    let data = test("data = \"tearing.csv\"");
    let fit = format!("{mesh}{data}{}{}", bulk("{ value = 60.0, fixed = true }"), tear(0.09, 0.022));
    let truth = [("interface.area[1].gc", 0.06), ("interface.area[1].sigma_c", 0.03)];
    found_again(case(folder.path(), &fit), &truth);
}

#[test]
fn hgo() {
    bulk_law("hgo");
}

#[test]
fn neo_hooke() {
    bulk_law("neo_hooke");
}

#[test]
fn yeoh() {
    bulk_law("yeoh");
}

#[test]
fn ogden() {
    bulk_law("ogden");
}

#[test]
fn four_fiber() {
    bulk_law("four_fiber");
}

#[test]
fn holzapfel_ogden() {
    bulk_law("holzapfel_ogden");
}

#[test]
fn exponential() {
    interface_law("exponential", "");
}

#[test]
fn bilinear() {
    interface_law("bilinear", "rise = 0.2\n");
}

#[test]
fn trapezoidal() {
    interface_law("trapezoidal", "rise = 0.2\nplateau = 0.3\n");
}

#[test]
fn ppr() {
    interface_law("ppr", "alpha = 3.0\npeak_at = 0.2\n");
}

#[test]
fn no_law_of_the_registry_is_left_out() {
    let registry = laws::registry();
    assert_eq!(registry.law_names(LawSite::Bulk), BULK.map(|l| l.0));
    assert_eq!(registry.law_names(LawSite::Interface), ["exponential", "bilinear", "trapezoidal", "ppr"]);
}

/// Whatever a file asks of a law that the law does not offer is said with its place.
#[test]
fn what_a_law_lacks_is_said_where_it_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let test = "[[tests]]\nkind = \"tearing\"\nprotocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }]\n";
    let told = |rest: &str| {
        let file = folder.path().join("case.toml");
        fs::write(&file, format!("{STRIP}{test}{rest}")).expect("written");
        let faults = input::read_case(&file, &effects::catalogue()).expect_err("an error").to_string();
        faults.replace(&format!("{}/", folder.path().display()), "")
    };
    for (rest, said) in [
        (
            "[bulk]\nlaw = \"neo_hooke\"\n[effects.fiber_damage]\na = 0.2\n",
            "case.toml:14:10: error: effect `fiber_damage` cannot act on this model: law `neo_hooke` has no fibre families",
        ),
        (
            "[bulk]\nlaw = \"yeoh\"\n[effects.viscoelastic]\nrelaxing = \"fibres\"\n",
            "case.toml:14:10: error: effect `viscoelastic` cannot act on this model: law `yeoh` has no fibre families",
        ),
        (
            "[interface]\nlaw = \"ppr\"\n[effects.law_shape]\nn = 1.2\n",
            "effect `law_shape` cannot act on this model: law `ppr` has no exponential curve of traction against opening",
        ),
        (
            "[bulk]\nlaw = \"yeoh\"\n[identify]\npriors.bulk.gamma_deg = { mean = 40, relative_sd = 0.5 }\n",
            "case.toml:15:13: error: law `yeoh` has no `gamma`",
        ),
    ] {
        let faults = told(rest);
        assert!(faults.contains(said), "{faults}");
    }
}
