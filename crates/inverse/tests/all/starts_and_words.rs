//! Where further starts lie, what is said of their agreement and of sloppy directions, and what a parameter may be.
#![allow(missing_docs)]

use crate::line;
use crate::toys;

use inverse::*;
use line::*;
use nalgebra::DVector;
use params::Transform;
use std::ops::ControlFlow;
use toys::{Toy, data, quiet, truth};

#[test]
fn starts_lie_where_the_sequence_says() {
    // Base 2: 1/2, 1/4, 3/4. Base 3 (digits times 1): 1/3, 2/3, 1/9. Base 5 (digits times 3): 3/5, 1/5, 4/5.
    for (i, want) in
        [[0.5, 1.0 / 3.0, 0.6], [0.25, 2.0 / 3.0, 0.2], [0.75, 1.0 / 9.0, 0.8]].iter().enumerate()
    {
        for (x, want) in halton(i, 3).iter().zip(want) {
            close(*x, *want);
        }
    }
    close(halton(4, 3)[2], 3.0 / 25.0);
    // Further dimensions use the primes again, with digits times one more.
    let far = halton(0, 43);
    for (k, want) in [(40, 0.5), (41, 2.0 / 3.0), (42, 4.0 / 5.0)] {
        close(far[k], want);
    }
    let free = vec![
        Free::new("x", (-1.0, 3.0), Transform::Identity, 0.0),
        Free::new("y", (1.0, f64::INFINITY), Transform::Log, 5.0),
        Free::new("z", (1.0, 1e4), Transform::Log, 5.0),
    ];
    let of = |spread: Spread| starts(&free, &MultiStart { starts: 3, spread, ..MultiStart::default() });
    let within = of(Spread::Bounds);
    assert_eq!((within.len(), within[0].clone()), (3, vec![0.0, 5.0, 5.0]));
    close(within[1][0], 1.0);
    close(within[2][0], 0.0 + 0.25 * 4.0 - 1.0);
    // No upper bound: two natural scales around the start, cut at ln 1 = 0.
    let (lo, hi) = (0.0f64.max(5f64.ln() - 2.0), 5f64.ln() + 2.0);
    close(within[1][1], (lo + (hi - lo) / 3.0).exp());
    // Between both bounds, in logarithms.
    close(within[1][2], 1e4f64.powf(0.6));
    // Half a natural scale (2) around 0: from −1 to 1.
    let around = of(Spread::Around(0.5));
    close(around[1][0], 0.0);
    close(around[2][0], -0.5);
    close(around[1][1], (5f64.ln() - 0.5 + 1.0 / 3.0).exp());
}

/// A search without a step answers with the values as given, to the bit, whatever coordinate they are fitted in.
#[test]
fn a_search_without_a_step_keeps_its_start_to_the_bit() {
    let toy = Toy(5, |i: usize, p: &[f64]| (p[0] + p[1] * i as f64, vec![1.0, i as f64]));
    let d = data(&truth(&toy, &[0.2, 3.0]), NoiseModel::white(0.05));
    let options = FitOptions { max_iterations: 0, ..FitOptions::default() };
    let third = Transform::Logit { lower: 0.0, upper: 1.0 / 3.0 };
    let mut moved = 0;
    for n in 1..200 {
        let (a, b) = (f64::from(n) / 607.0, 0.1 + f64::from(n) / 7.0);
        let free = vec![
            Free::new("kappa", (0.0, 1.0 / 3.0), third, a),
            Free::new("mu", (0.0, f64::INFINITY), Transform::Log, b),
        ];
        moved += usize::from(free[1].backward(free[1].forward(b)) != b);
        assert_eq!(quiet(&toy, &d, &free, &options).theta, [a, b]);
    }
    assert!(moved > 0, "through their coordinates and back some values change");
}

#[test]
fn the_agreement_of_starts_is_a_sentence() {
    let toy = Toy(60, |i: usize, p: &[f64]| {
        let t = i as f64 / 10.0;
        ((p[0] * t).sin(), vec![t * (p[0] * t).cos()])
    });
    let d = data(&truth(&toy, &[4.0]), NoiseModel::white(0.05));
    let run = |bounds: (f64, f64), fails: bool| {
        let free = vec![Free::new("omega", bounds, Transform::Identity, 4.1)];
        let how = MultiStart { starts: 6, spread: Spread::Bounds, ..MultiStart::default() };
        let options = FitOptions::default();
        let watch: &mut dyn FnMut(usize, &Iterate) -> ControlFlow<()> = &mut |_, _| ControlFlow::Continue(());
        if fails {
            multi_start(&Picky(&toy), &d, &free, &options, &how, watch).unwrap()
        } else {
            multi_start(&toy, &d, &free, &options, &how, watch).unwrap()
        }
    };
    assert_eq!(run((3.9, 4.3), false).sentence(), "All 6 starts end at the same optimum.");
    let failing = run((3.9, 4.3), true);
    let failed = failing.ends.iter().filter(|e| e.1.is_err()).count();
    assert!(failed > 0 && failing.ended == 6 - failed);
    assert_eq!(
        failing.sentence(),
        format!("All {} starts end at the same optimum. {failed} could not start.", 6 - failed)
    );
    let some = run((0.2, 8.0), false);
    assert_eq!(
        some.sentence(),
        format!("{} of 6 starts end at the best optimum, the others at worse ones.", some.agreeing)
    );
    // Each start is the one that the list says.
    for (theta, end) in &some.ends {
        assert_eq!(&end.as_ref().unwrap().history[0].theta, theta);
    }
}

/// Cannot be computed beyond 4.18.
struct Picky<'a, P>(&'a P);

impl<P: Problem> Problem for Picky<'_, P> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        if theta[0] > 4.18 {
            Err(PredictError::NotComputable("too far".into()))
        } else {
            self.0.predict(theta, jacobian)
        }
    }
}

#[test]
fn random_numbers_are_the_published_generator_and_its_transforms() {
    // SplitMix64 (Steele, Lea & Flood 2014) from the state 1234567, which this seed becomes.
    let stream = || Random::new(6_433_677_232_918_919_796);
    let mut random = stream();
    for published in [6_457_827_717_110_365_317u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423] {
        close(random.uniform(), published as f64 / 2f64.powi(64));
    }
    // Box and Muller: two normal numbers of two uniform ones.
    let (mut uniform, mut normal) = (stream(), stream());
    for _ in 0..3 {
        let (u, v) = (uniform.uniform(), uniform.uniform());
        let radius = (-2.0 * u.ln()).sqrt();
        close(normal.normal(), radius * (std::f64::consts::TAU * v).cos());
        close(normal.normal(), radius * (std::f64::consts::TAU * v).sin());
    }
    // The record's noise: AR(1) block by block, then a factor for each column.
    let d = two_blocks();
    let (fresh, noise) = (stream().normals(12), d.simulate_noise(&mut stream()));
    let mut want = DVector::zeros(10);
    for (k, block) in d.blocks.iter().enumerate() {
        let (sd, phi) = (block.noise.sd, block.noise.ar1);
        let mut last = fresh[5 * k];
        want[5 * k] = sd * last;
        for i in 5 * k + 1..5 * k + 5 {
            last = phi * last + (1.0 - phi * phi).sqrt() * fresh[i];
            want[i] = sd * last;
        }
    }
    let columns = d.nuisance_columns();
    want += &columns[0] * fresh[10] + &columns[1] * fresh[11];
    assert!((noise - want).norm() < 1e-12);
}

fn sloppy(free: Vec<Free>, model: impl Fn(usize, &[f64]) -> (f64, Vec<f64>) + Sync) -> String {
    let toy = Toy(30, model);
    let at: Vec<f64> = free.iter().map(|f| f.start).collect();
    let d = data(&truth(&toy, &at), NoiseModel::white(1e-6));
    let end = quiet(&toy, &d, &free, &FitOptions::default());
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    u.sloppy_directions().join(" | ")
}

/// A parameter with a normal prior around its start: the only knowledge of a direction that the record does not fix.
fn believed(name: &str, start: f64, sd: f64) -> Free {
    Free::new(name, (1e-6, 1e6), Transform::Log, start).prior(start.ln(), sd)
}

#[test]
fn a_direction_is_named_by_what_moves_and_by_how_much() {
    // Only a bᵏ matters: along (k, −1) in logarithms nothing but priors of sd 1 holds.
    let power = |k: f64| {
        sloppy(vec![believed("a", 2.0, 1.0), believed("b", 3.0, 1.0)], move |i, p| {
            let y = p[0] * p[1].powf(k) * (1.0 + i as f64);
            (y, vec![y / p[0], k * y / p[1]])
        })
    };
    // (2, −1)/√5: exp(0.894) − 1 and exp(−0.447) − 1.
    assert_eq!(power(2.0), "The record hardly fixes a / b: a +145 %, b -36 % together raise χ² by only 1.");
    // (0.8, −1)/1.281: near enough to a product to say so.
    assert_eq!(
        power(0.8),
        "The record hardly fixes b / a, only b · a: b +118 %, a -46 % together raise χ² by only 1."
    );
    assert_eq!(
        power(-0.8),
        "The record hardly fixes b · a, only b / a: b +118 %, a +87 % together raise χ² by only 1."
    );
    // Three ratios of powers are seen, so that (4, 3, 2.5, 2)/5.937 is not; more than three are counted.
    let names = ["a", "b", "c", "d"];
    let four = sloppy(names.iter().map(|n| believed(n, 2.0, 2.0)).collect(), |i, p| {
        let (j, m, n) = [(0, 3.0, 4.0), (1, 2.5, 3.0), (2, 2.0, 2.5)][i % 3];
        let y = p[j].powf(m) / p[j + 1].powf(n);
        let mut slope = vec![0.0; 4];
        (slope[j], slope[j + 1]) = (m * y / p[j], -n * y / p[j + 1]);
        (y, slope)
    });
    assert_eq!(
        four,
        "The record hardly fixes 4 parameters against each other: a +285 %, b +175 %, c +132 % and 1 smaller \
         changes together raise χ² by only 1."
    );
    // One parameter alone, by the sd of its prior; no sentence below a sd of 1/2.
    let idle = |f: Free| {
        let seen = Free::new("a", (1e-6, 1e6), Transform::Log, 2.0);
        sloppy(vec![seen, f], |i, p| (p[0] * (1.0 + i as f64), vec![1.0 + i as f64, 0.0]))
    };
    let said = |change: &str| format!("The record hardly fixes idle: idle {change} raises χ² by only 1.");
    assert_eq!(idle(believed("idle", 3.0, 2.2)), said("+803 %"));
    assert_eq!(idle(believed("idle", 3.0, 2.4)), said("up more than 10-fold"));
    assert_eq!(idle(believed("idle", 3.0, 0.49)), "");
    assert_eq!(idle(believed("idle", 3.0, 0.51)), said("+67 %"));
    let plain = |at: f64| Free::new("idle", (-10.0, 10.0), Transform::Identity, at).prior(at, 5.2);
    assert_eq!(idle(plain(4.0)), said("+130 %"));
    assert_eq!(idle(plain(0.0)), said("+5.200"));
    assert_eq!(idle(plain(0.1)), said("+5.200"), "fifty times its value is no percentage");
    assert_eq!(idle(plain(4.9)), said("as far as its bound"));
}

#[test]
fn bounds_scales_and_coordinates_of_a_parameter() {
    let f = |lower: f64, upper: f64, transform: Transform| Free::new("p", (lower, upper), transform, 1.0);
    let unit = Transform::Logit { lower: 0.0, upper: 2.0 };
    let (box_, log, logit) =
        (f(-1.0, 3.0, Transform::Identity), f(1.0, 100.0, Transform::Log), f(0.0, 2.0, unit));
    assert_eq!((box_.natural_scale(9.0), log.natural_scale(9.0), logit.natural_scale(1.0)), (2.0, 1.0, 1.0));
    let open = f(f64::NEG_INFINITY, f64::INFINITY, Transform::Identity);
    assert_eq!((open.natural_scale(-7.0), open.natural_scale(0.0)), (7.0, 1.0));
    assert_eq!(open.clone().prior(0.0, 0.3).natural_scale(-7.0), 0.3);
    assert_eq!((log.bounds_z(), open.bounds_z()), ((0.0, 100f64.ln()), (f64::NEG_INFINITY, f64::INFINITY)));
    assert_eq!((box_.forward(5.0), box_.forward(-5.0), log.forward(0.5)), (3.0, -1.0, 0.0));
    assert_eq!((box_.backward(5.0), box_.backward(-5.0), box_.backward(0.5)), (3.0, -1.0, 0.5));
    assert_eq!([-1.0, -0.999, 2.999, 3.0].map(|x| box_.at_bound(x)), [true, false, false, true]);
    assert_eq!([1.0009, 1.0011, 99.89, 99.91].map(|x| log.at_bound(x)), [true, false, false, true]);
    assert_eq!([0.0019, 0.0021, 1.9979, 1.9981].map(|x| logit.at_bound(x)), [true, false, false, true]);
}

#[test]
fn a_faulty_description_is_named_with_its_fault() {
    let toy = Toy(5, line);
    let good = data(&truth(&toy, &[1.0, 2.0]), NoiseModel::white(0.5));
    let fails = |d: &Data, change: &dyn Fn(&mut Free)| {
        let mut free = free(10.0);
        change(&mut free[1]);
        fit(&toy, d, &free, &FitOptions::default(), &mut |_| ControlFlow::Continue(()))
            .map_err(|e| e.to_string())
    };
    let parameter = |change: &dyn Fn(&mut Free)| fails(&good, change).unwrap_err();
    assert_eq!(parameter(&|f| f.upper = -10.0), "parameter b: lower bound -10 is not below upper bound -10");
    assert_eq!(
        parameter(&|f| f.lower = f64::NAN),
        "parameter b: lower bound NaN is not below upper bound 10"
    );
    assert_eq!(parameter(&|f| f.start = f64::NAN), "parameter b: start value is not a finite number");
    let negative = |f: &mut Free| (f.upper, f.transform) = (0.0, Transform::Log);
    assert_eq!(parameter(&negative), "parameter b: a logarithmic coordinate needs a positive upper bound");
    for (mean, sd) in [(f64::NAN, 1.0), (0.0, 0.0), (0.0, -1.0), (0.0, f64::INFINITY)] {
        let said = parameter(&|f| f.prior = Some(Prior { mean, sd }));
        assert_eq!(said, "parameter b: prior needs a finite mean and a positive sd");
    }
    let record = |change: &dyn Fn(&mut Data)| {
        let mut d = two_blocks();
        change(&mut d);
        d.check().unwrap_err().to_string()
    };
    assert_eq!(record(&|d| d.blocks[1].range = 4..9), "block 1: starts at point 4, expected 5");
    assert_eq!(record(&|d| d.blocks[0].measured.truncate(4)), "block 0: 4 numbers for 5 points");
    assert_eq!(
        record(&|d| d.blocks[1].noise.sd = -1.0),
        "block 1: noise sd is -1, expected a positive number"
    );
    assert_eq!(
        record(&|d| d.blocks[1].noise.ar1 = -1.0),
        "block 1: ar1 is -1, expected a number between -1 and 1"
    );
    assert_eq!(
        record(&|d| d.blocks[0].measured[3] = f64::INFINITY),
        "block 0: measured value 3 is not finite"
    );
    let column = |n: usize, x: f64| DVector::from_element(n, x);
    let own = |c: DVector<f64>| record(&|d| d.blocks[1].noise.nuisance[0] = c.clone());
    assert_eq!(own(column(4, 1.0)), "block 1: a nuisance column of 4 for 5 points");
    assert_eq!(own(column(5, f64::NAN)), "block 1: a nuisance column holds a number that is not finite");
    let across = |c: DVector<f64>| record(&|d| d.nuisance[0] = c.clone());
    assert_eq!(across(column(9, 1.0)), "a nuisance column has length 9, expected 10");
    assert_eq!(
        across(column(10, f64::NAN)),
        "block (all): a nuisance column holds a number that is not finite"
    );
    assert_eq!(record(&|d| d.held_out = vec![false; 9]), "the held-out mask has length 9, expected 10");
    assert!(two_blocks().check().is_ok() && fails(&good, &|_| ()).is_ok());
    assert_eq!((two_blocks().points(), two_blocks().used_points()), (10, 9));
}
