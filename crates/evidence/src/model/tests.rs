use super::*;
use crate::Place;
use inverse::{Data, NoiseModel};
use nalgebra::DMatrix;

/// The places, lengths and forms of one size of the rest share its mass, so that a rest does not count more than none for
/// having several.
#[test]
fn on_a_few_sizes_each_counts_once() {
    let s: Vec<f64> = (0..20).map(|i| f64::from(i) / 19.0).collect();
    let parts = ["uniaxial", "tearing"].map(|t| (t.to_owned(), vec![0.01; 20], NoiseModel::white(0.01)));
    let places =
        ["uniaxial", "tearing"].map(|t| Place { test: t.into(), s: s.clone(), leg: vec![0; 20], peak: 1.0 });
    let data = Data::from_parts(parts).expect("data");
    let record = Record::new(&data, &places, 0.015).expect("a record");
    let linear = Linear {
        misfit: data.measured(),
        jacobian: DMatrix::zeros(40, 0),
        parameters: Vec::new(),
        jumps: Vec::new(),
    };
    let few = Evidence::on(&record, &linear, &RestPrior::default(), Kernel::Plain, &[0.3, 4.0])
        .expect("an evidence");
    for (support, sizes) in [(0, 1.0), (1, 2.0), (2, 2.0), (3, 2.0)] {
        let here = few.nodes.iter().filter(|n| n.support == support);
        let mass: f64 = here.map(|n| n.ln_volume.exp()).sum();
        assert!((mass - sizes).abs() < 1e-12, "{support}: {mass}");
    }
}
