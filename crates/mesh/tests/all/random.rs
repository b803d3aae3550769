//! Random strips: an error or a sound mesh, never a panic.

use mesh::{Outline, Profile, Sizing, Strip, nested_dissection, quality, strip};
use proptest::prelude::*;

fn sizing() -> impl Strategy<Value = Sizing> {
    prop_oneof![
        [1..12_usize, 1..24_usize, 1..4_usize].prop_map(Sizing::Divisions),
        (0.2..2.0, 0.1..1.0, 1..4_usize).prop_map(|(bulk_size, share, layers)| Sizing::Graded {
            bulk_size,
            path_size: share * bulk_size,
            layers
        }),
    ]
}

fn outline(length: f64) -> impl Strategy<Value = Option<Outline>> {
    prop::option::of(prop::collection::vec((-1.0..1.0, 1.5..8.0), 2..6)).prop_map(move |points| {
        let points = points?;
        let step = length / (points.len() - 1) as f64;
        let point = |(at, (left, right)): (usize, (f64, f64))| [step * at as f64, left, right];
        Some(Outline::new(&points.into_iter().enumerate().map(point).collect::<Vec<_>>()).unwrap())
    })
}

fn strips() -> impl Strategy<Value = Strip> {
    let sizes = (1.0..20.0, 1.0..8.0, 0.1..2.0, 0.0..1.2);
    sizes.prop_flat_map(|(length, width, thickness, cut): (f64, f64, f64, f64)| {
        let path = prop::option::of(0.02..0.98_f64);
        let profile = prop::option::of((0.1..2.0, 0.1..2.0_f64));
        let flags = [any::<bool>(), any::<bool>(), any::<bool>()];
        (path, profile, flags, sizing(), outline(length)).prop_map(
            move |(path, profile, [tear, half_height, half_thickness], sizing, outline)| Strip {
                cut: (cut - 0.2_f64).max(0.0) * width,
                path_y: path.map(|share| share * length),
                tear,
                sizing,
                half_height,
                half_thickness,
                outline,
                thickness_profile: profile.map(|(a, b)| {
                    Profile::thickness(vec![[0.0, a], [0.5 * length, b], [length, a]]).unwrap()
                }),
                ..Strip::new(length, width, thickness)
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_mesh_is_sound(strip_ in strips()) {
        let strip_ = Strip { half_height: strip_.half_height && strip_.is_symmetric(1e-9), ..strip_ };
        let Ok(mesh) = strip(&strip_) else { return Ok(()) };
        prop_assert!(quality(&mesh).min_scaled_jacobian > 0.0);
        prop_assert!((0..mesh.hexes.len()).all(|hex| mesh.hex_volume(hex) > 0.0));
        prop_assert_eq!(mesh.interfaces.is_empty(), !strip_.tear);
        let mut order = nested_dissection(&mesh);
        order.sort_unstable();
        prop_assert!(order.into_iter().eq(0..mesh.nodes.len()));
        let mut used = vec![false; mesh.nodes.len()];
        mesh.hexes.iter().flatten().for_each(|&node| used[node] = true);
        prop_assert!(used.into_iter().all(|used| used));
        if strip_.tear {
            let height = strip_.thickness_profile.as_ref().map_or(strip_.thickness, |p| p.at(mesh.path_y));
            let share = if strip_.half_thickness { 0.5 } else { 1.0 };
            let area = (mesh.path_width - mesh.cut) * height * share;
            prop_assert!((mesh.path_area() - area).abs() < 1e-9 * area);
        }
        if strip_.outline.is_none() && strip_.thickness_profile.is_none() {
            let halves = [strip_.half_height, strip_.half_thickness].into_iter().filter(|h| *h).count();
            let volume = strip_.length * strip_.width * strip_.thickness / f64::from(1 << halves);
            prop_assert!((mesh.volume() - volume).abs() < 1e-9 * volume);
        }
    }

    #[test]
    fn wild_numbers_never_panic(
        [length, width, thickness, cut, path_y, bulk_size, path_size] in prop::array::uniform7(any::<f64>()),
        divisions in prop::option::of(prop::array::uniform3(any::<usize>())),
        tear: bool,
        layers: usize,
    ) {
        let graded = Sizing::Graded { bulk_size, path_size, layers };
        let sizing = divisions.map_or(graded, Sizing::Divisions);
        let wild = Strip { cut, path_y: Some(path_y), tear, sizing, ..Strip::new(length, width, thickness) };
        let _ = strip(&wild);
        let _ = strip(&Strip { sizing, tear, ..Strip::new(10.0, 4.0, 1.0) });
        let _ = strip(&Strip { cut, path_y: Some(path_y), tear, ..Strip::new(10.0, 4.0, 1.0) });
    }
}
