//! Strain, stretch, stress and true measures become displacement and force by the dimensions of the strip.

use crate::common::{Look, read, told};

#[test]
fn a_strain_needs_a_length_and_a_stress_an_area() {
    let rows = Look::PLAIN.table();
    let message = told(&format!("Time [s],Stretch,Stress [kPa]\n{rows}"), &[]);
    for needed in ["the length of the specimen", "the width", "the thickness", "--geometry strip.toml"] {
        assert!(message.contains(needed), "{message}");
    }
    let nominal = read("t [s],Stretch,Stress [kPa]\n0,1,0\n1,1.1,10\n2,1.2,20\n", &[("geometry", "")]);
    // 10 kPa on 6 mm x 0.8 mm; 10 mm long.
    assert!((nominal.tests[0].full.force[1] - 0.048).abs() < 1e-12);
    assert!((nominal.tests[0].full.displacement[2] - 2.0).abs() < 1e-12);
    let cauchy = read("t [s],Stretch,True stress [kPa]\n0,1,0\n1,1.1,10\n2,1.2,24\n", &[("geometry", "")]);
    assert!((cauchy.tests[0].full.force[2] - 0.024 * 4.8 / 1.2).abs() < 1e-12);
    assert!(cauchy.done.iter().any(|d| d.contains("true (Cauchy) stress")), "{:?}", cauchy.done);
    let hencky = read("t [s],True strain [1],Load [N]\n0,0,0\n1,0.1,1\n2,0.2,2\n", &[("geometry", "")]);
    assert!((hencky.tests[0].full.displacement[2] - 10.0 * (0.2_f64.exp() - 1.0)).abs() < 1e-12);
}

/// True stress refers to the strip as it is: its area follows from the stretch, of a strain or of the displacement.
#[test]
fn a_true_stress_needs_the_stretch() {
    let text = "t [s],Extension [mm],Cauchy stress [kPa]\n0,0,0\n1,1,10\n2,2,24\n";
    let test = &read(text, &[("geometry", "")]).tests[0];
    assert!((test.full.force[2] - 0.024 * 4.8 / 1.2).abs() < 1e-12, "{:?}", test.full.force);
    let message = told(text, &[]);
    assert!(message.contains("a true stress instead of a force needs the length"), "{message}");
    let nominal = told(&text.replace("Cauchy stress", "Stress"), &[]);
    assert!(nominal.contains("the width") && !nominal.contains("the length"), "{nominal}");
}

#[test]
fn true_strains_go_by_many_names() {
    for name in ["True strain", "Logarithmic strain", "Hencky strain", "Wahre Dehnung"] {
        let text = format!("t [s],{name} [1],Load [N]\n0,0,0\n1,0.1,1\n2,0.2,2\n");
        let test = &read(&text, &[("geometry", "")]).tests[0];
        let expected = 10.0 * (0.2_f64.exp() - 1.0);
        assert!((test.full.displacement[2] - expected).abs() < 1e-12, "{name}: {:?}", test.full.displacement);
    }
}
