//! Load-train, specimen and sensor effects, and the cards of all.
// Steps, their traces and their predecessors go by one index.
#![allow(clippy::needless_range_loop)]

use crate::battery;

use battery::*;
use constitutive::{Context, Jet, Law, PointLaw};
use input::{EffectRegistry, ExperimentRegistry};
use model::{Action, Effect, Options, Sample, Screening};
use std::sync::Arc;

fn link(effect: &dyn Effect) -> Option<Arc<dyn PointLaw<1>>> {
    match effect.act(&Options::new(), &PIECE) {
        Action::Train(law) | Action::TakeUp(law) => Some(law),
        _ => None,
    }
}

fn pulls() -> Steps<1> {
    [0.0, 0.13, 0.4, 0.2, 0.05, 0.52, 0.7, 0.31, -0.02, 0.9]
        .into_iter()
        .enumerate()
        .map(|(i, x)| (Context { dt: 1.0, time: i as f64, path_position: 0.5 }, [x]))
        .collect()
}

/// What a screen and a fit begin with lies where a search goes.
#[test]
fn shapes_and_starts_are_within_the_bounds_of_a_search() {
    for e in effects() {
        let specs = e.parameters(&Options::new());
        for values in e.shapes(&SCALES).into_iter().chain([e.start(&SCALES)]) {
            assert_eq!(values.len(), specs.len(), "{}", e.card().name);
            for (spec, v) in specs.iter().zip(values) {
                let inside = (spec.lower..=spec.upper).contains(&v) || spec.neutral == Some(v);
                assert!(inside, "{}: {} = {v}, {} to {}", e.card().name, spec.name, spec.lower, spec.upper);
            }
        }
    }
}

#[test]
fn neutral_links_do_nothing_to_the_bit() {
    for e in effects() {
        let Some(law) = link(&*e) else { continue };
        let take_up = matches!(e.act(&Options::new(), &PIECE), Action::TakeUp(_));
        for own in e.shapes(&SCALES) {
            for ((_, [x]), [answer]) in pulls().iter().zip(drive(&*law, &own, &pulls()).force) {
                if take_up {
                    assert_eq!(answer.to_bits(), x.to_bits(), "{}", e.card().name);
                } else {
                    assert_eq!(answer, 0.0, "{}", e.card().name);
                }
            }
        }
    }
}

#[test]
fn links_are_differentiated_through_their_history() {
    for e in effects() {
        let Some(law) = link(&*e) else { continue };
        let typical = active(&*e);
        let shapes =
            e.shapes(&SCALES).into_iter().filter(|_| matches!(e.card().screening, Screening::Score(_)));
        // At rest play is at a switch: it begins a little pulled.
        let mut pulls = pulls();
        pulls[0].1[0] = 0.01;
        for own in shapes.chain([typical.clone()]) {
            for k in 0..own.len() {
                for along in [0.0, 0.3] {
                    let h = 1e-4 * typical[k].abs().max(1e-3);
                    let error = column_error(&*law, &own, &pulls, k, &[along], h);
                    assert!(error < 1e-5, "{} parameter {k} at {own:?}: {error:e}", e.card().name);
                }
            }
        }
    }
}

#[test]
fn links_lose_energy_and_never_give_it() {
    for name in ["compliance", "grip_slip"] {
        let law = link(&*named(name)).unwrap();
        let own = active(&*named(name));
        let steps = refine(&pulls(), 400);
        let t = drive(&*law, &own, &steps);
        let (mut work, mut last) = (0.0, 0.0);
        for s in 1..steps.len() {
            // Work of the force on the elongation.
            work += 0.5 * (steps[s].1[0] + steps[s - 1].1[0]) * (t.force[s][0] - t.force[s - 1][0]);
            let e = law.energies(&steps[s].0, &steps[s].1, &own, &t.history[s - 1], &t.history[s]);
            assert!((work - e.stored - e.dissipated).abs() < 1e-4, "{name}: {work} {e:?}");
            assert!(e.dissipated >= last, "{name}");
            last = e.dissipated;
        }
    }
}

#[test]
fn slack_begins_at_zero_rises_always_and_ends_in_the_dead_travel() {
    let law = link(&*named("slack")).unwrap();
    let at = |u: f64, u0: f64, toe: f64| {
        let p = [Jet::<1>::constant(u0), Jet::constant(toe)];
        Law::<Jet<1>, 1>::respond(&*law, &Context::default(), &[Jet::variable(u, 0)], &p, &[], &mut []).force
            [0]
    };
    for toe in [0.1, 0.25, 2.0] {
        for u0 in [1e-9, 0.05, 0.5] {
            assert_eq!(at(0.0, u0, toe).re, 0.0);
            for u in [-0.01, 0.0, 0.01, 0.3, 10.0] {
                let s = at(u, u0, toe);
                assert!(s.re.is_finite() && s.eps[0] >= 0.0 && s.eps[0] <= 1.0, "{u} {u0} {toe} {s:?}");
            }
            assert!(at(u0, u0, toe).eps[0] > 0.49);
        }
        // Continuous in u0 at the neutral value.
        assert!((at(0.3, 1e-9, toe).re - 0.3).abs() < 1e-8);
    }
    // The form another program wrote its practice records with: w = u0/4.
    let (u, u0, w) = (0.2f64, 0.08f64, 0.02f64);
    let theirs = w * ((1.0 + ((u - u0) / w).exp()) / (1.0 + (-u0 / w).exp())).ln();
    assert!((at(u, u0, 0.25).re - theirs).abs() < 1e-14);
}

fn samples() -> Vec<Sample> {
    let kinds = experiments::registry().kinds();
    (0..2usize)
        .map(|i| (kinds[i], i))
        .flat_map(|(kind, test)| {
            [0.0, 3.0, 250.0].map(|time| Sample {
                time,
                displacement: 0.4,
                speed: 0.05,
                acceleration: -0.8,
                kind,
                test,
            })
        })
        .collect()
}

#[test]
fn sensors_are_exact_at_neutral_and_differentiated() {
    for e in effects() {
        let Action::Sensor(sensor) = e.act(&Options::new(), &PIECE) else { continue };
        let name = e.card().name;
        let neutral = e.shapes(&SCALES).remove(0);
        assert_eq!(sensor.delay(&neutral).0, 0.0, "{name}");
        for at in samples() {
            for force in [0.31, 0.0, -0.0, -0.2] {
                let r = sensor.reading(&at, force, &neutral);
                assert_eq!(r.value.to_bits(), force.to_bits(), "{name}");
                assert_eq!(r.slope, 1.0, "{name}");
            }
            let own = active(&*e);
            let r = sensor.reading(&at, 0.31, &own);
            assert_eq!(r.by_param.len(), own.len(), "{name}");
            for k in 0..own.len() {
                let h = 1e-6;
                let (mut up, mut down) = (own.clone(), own.clone());
                up[k] += h;
                down[k] -= h;
                let d = (sensor.reading(&at, 0.31, &up).value - sensor.reading(&at, 0.31, &down).value)
                    / (2.0 * h);
                assert!((d - r.by_param[k]).abs() < 1e-7, "{name}: {d} {}", r.by_param[k]);
                let delay = (sensor.delay(&up).0 - sensor.delay(&down).0) / (2.0 * h);
                assert!((delay - sensor.delay(&own).1[k]).abs() < 1e-7, "{name}");
            }
            let slope =
                (sensor.reading(&at, 0.32, &own).value - sensor.reading(&at, 0.30, &own).value) / 0.02;
            assert!((slope - r.slope).abs() < 1e-9, "{name}");
        }
    }
}

#[test]
fn negative_controls_on_the_sensor_stay_tiny_at_their_bounds() {
    for name in ["inertia", "self_weight"] {
        let e = named(name);
        let Action::Sensor(sensor) = e.act(&Options::new(), &PIECE) else { panic!("{name}") };
        let upper: Vec<f64> = e.parameters(&Options::new()).iter().map(|p| p.upper).collect();
        for at in samples() {
            let off = (sensor.reading(&at, 0.1, &upper).value - 0.1).abs();
            assert!(off < 1e-3 * SCALES.peak_force, "{name}: {off}");
        }
    }
}

#[test]
fn shapes_and_mounting_are_smooth_and_turn_no_element_over() {
    let points = [[0.0, 0.0, 0.0], [0.4, 2.0, 0.8], [1.0, 5.0, 0.4], [3.3, 7.0, 0.8], [6.0, 10.0, 0.8]];
    for e in effects() {
        let name = e.card().name;
        let specs = e.parameters(&Options::new());
        match e.act(&Options::new(), &PIECE) {
            Action::Shape(shape) => {
                for p in points {
                    assert_eq!(shape.position(p, &[0.0]).0, p, "{name}: neutral");
                    let (own, h) = (active(&*e)[0], 1e-6);
                    let (up, down) = (shape.position(p, &[own + h]).0, shape.position(p, &[own - h]).0);
                    let by = shape.position(p, &[own]).1[0];
                    for i in 0..3 {
                        assert!(((up[i] - down[i]) / (2.0 * h) - by[i]).abs() < 1e-8, "{name}");
                    }
                }
                for bound in [specs[0].lower, specs[0].upper] {
                    let x = |x: f64, z: f64| shape.position([x, 1.0, z], &[bound]).0;
                    for i in 0..60 {
                        let (a, b) = (0.1 * i as f64, 0.1 * (i + 1) as f64);
                        assert!(x(b, 0.8)[0] > x(a, 0.8)[0], "{name}: folded at {a}");
                        assert!(x(a, 0.8)[2] > x(a, 0.0)[2], "{name}: flat at {a}");
                    }
                }
            }
            Action::Mount(mount) => {
                for p in points {
                    assert_eq!(mount.offset(p[0], &[0.0]).0, 0.0, "{name}");
                    let (own, h) = (active(&*e)[0], 1e-6);
                    let d = (mount.offset(p[0], &[own + h]).0 - mount.offset(p[0], &[own - h]).0) / (2.0 * h);
                    assert!((d - mount.offset(p[0], &[own]).1[0]).abs() < 1e-8, "{name}");
                }
            }
            _ => {}
        }
    }
}

#[test]
fn cards_are_complete_and_agree_with_each_other() {
    let all = effects();
    let card = |name: &str| all.iter().find(|e| e.card().name == name).map(|e| e.card());
    const NEEDS: [&str; 6] =
        ["pause or two rates", "unloading", "tearing", "two tests", "clamped ends", "a flat sheet"];
    for e in &all {
        let c = e.card();
        for text in [c.name, c.summary, c.law, c.reference, c.separated_by, c.ordinary] {
            assert!(text.len() > 2 && !text.contains("  \n"), "{}: empty field", c.name);
        }
        assert!(!c.shows_in.is_empty(), "{}", c.name);
        assert!(c.needs.iter().all(|n| NEEDS.contains(n)), "{}", c.name);
        for other in c.look_alikes {
            let back = card(other).unwrap_or_else(|| panic!("{}: look-alike {other} is no effect", c.name));
            assert!(back.look_alikes.contains(&c.name), "{} and {other} must name each other", c.name);
        }
        for other in c.excludes {
            assert!(card(other).is_some_and(|b| b.excludes.contains(&c.name)), "{} and {other}", c.name);
        }
        let names: std::collections::BTreeSet<_> = all.iter().map(|e| e.card().name).collect();
        assert_eq!(names.len(), all.len());
    }
    let controls: Vec<_> = all.iter().filter(|e| e.card().negative_control).map(|e| e.card().name).collect();
    assert_eq!(controls, ["inertia", "crack_friction", "self_weight"]);
}

#[test]
fn starts_and_shapes_lie_in_bounds_and_shapes_are_neutral() {
    let tiny = model::Scales {
        peak_force: 1e-3,
        uniaxial_peak: 1e-4,
        displacement: 0.05,
        uniaxial_displacement: 0.02,
        duration: 3.0,
        sampling: 0.01,
        energy: 1e-6,
        delta_c: 0.001,
        sigma_c: 1e-3,
        opening_rate: 1e-5,
        fibre_strain: 0.01,
    };
    let large = model::Scales {
        peak_force: 500.0,
        uniaxial_peak: 300.0,
        displacement: 60.0,
        uniaxial_displacement: 40.0,
        duration: 2e5,
        sampling: 60.0,
        energy: 20.0,
        delta_c: 35.0,
        sigma_c: 40.0,
        opening_rate: 20.0,
        fibre_strain: 5.0,
    };
    for e in effects() {
        let specs = e.parameters(&Options::new());
        let name = e.card().name;
        assert!(specs[0].neutral.is_some(), "{name}: the amplitude has a neutral value");
        for scales in [SCALES, tiny, large] {
            let inside = |v: &[f64]| {
                v.len() == specs.len() && v.iter().zip(&specs).all(|(v, s)| *v >= s.lower && *v <= s.upper)
            };
            let start = e.start(&scales);
            assert!(inside(&start), "{name}: start {start:?}");
            assert_ne!(Some(start[0]), specs[0].neutral, "{name}: a start is no neutral amplitude");
            let shapes = e.shapes(&scales);
            assert!((1..=6).contains(&shapes.len()), "{name}");
            for (i, s) in shapes.iter().enumerate() {
                assert!(inside(s), "{name}: shape {s:?}");
                assert_eq!(Some(s[0]), specs[0].neutral, "{name}");
                assert!(shapes[..i].iter().all(|o| o != s), "{name}: shape {s:?} twice at {scales:?}");
            }
        }
        for s in &specs {
            assert!(
                s.lower < s.upper && s.start >= s.lower && s.start <= s.upper && !s.description.is_empty(),
                "{name}.{}",
                s.name
            );
        }
    }
}

/// The bounds hold what another program's practice records were made with.
#[test]
fn bounds_hold_the_magnitudes_of_the_practice_records() {
    let holds = |effect: &str, values: &[f64]| {
        let specs = named(effect).parameters(&Options::new());
        for (v, s) in values.iter().zip(&specs) {
            assert!(*v >= s.lower && *v <= s.upper, "{effect}.{} = {v}", s.name);
        }
    };
    holds("viscoelastic", &[0.19, 4.4]);
    holds("mullins", &[1.0 / 4.6, 1.26e-5, 0.3]);
    holds("bridging", &[0.0218, 2.54]);
    holds("compliance", &[1.0 / 3.03]);
    holds("grip_slip", &[1.0 / 0.69, 0.076]);
    holds("slack", &[0.0788, 0.25]);
    holds("drift", &[-1.39e-4]);
    holds("rate_dependent_strength", &[0.0141, 1.29e-3]);
    holds("thickness_taper", &[0.65]);
}

#[test]
fn the_reader_sees_every_effect_and_the_page_shows_it() {
    let catalogue = effects::catalogue();
    let page = effects::card_text::markdown(&catalogue);
    for name in catalogue.names() {
        assert!(page.contains(&format!("\n## {name}\n")), "{name}");
        for p in EffectRegistry::parameters(&catalogue, name).unwrap() {
            assert!(page.contains(&format!("`{}`", p.key())), "{name}.{}", p.name);
        }
        assert!(effects::card_text::terminal(&**catalogue.get(name).unwrap()).contains(name));
    }
    assert!(!page.contains("  ,") && !page.contains("NaN"));
}

#[test]
fn more_branches_bring_more_parameters() {
    let e = named("viscoelastic");
    let mut options = Options::new();
    options.insert("branches".into(), input::OptionValue::Integer(3));
    let names: Vec<String> = e.parameters(&options).iter().map(|p| p.name.to_string()).collect();
    assert_eq!(names, ["g", "tau", "g2", "tau2", "g3", "tau3"]);
    let Action::Bulk(wrap) = e.act(&options, &PIECE) else { panic!() };
    let law = wrap(Arc::new(hgo::Hgo::default()));
    assert_eq!(law.parameters().len(), 7 + 6);
    assert_eq!(law.history().len(), 18 + 6 + 6 + 1);
    let params = [&TISSUE[..], &[0.2, 3.0, 0.1, 30.0, 0.0, 100.0]].concat();
    let steps = stretching(1);
    assert!(column_error(&*law, &params, &steps, 7 + 3, &[0.0; 9], 1e-3) < 1e-5);
}
