//! Outlines, thickness profiles, and what is refused.

use approx::assert_relative_eq;
use mesh::{MeshError, Outline, Profile, Sizing, Strip, count, quality, strip};

/// A dog bone: 8 mm wide at the ends, 4 mm in the middle, 0.5 mm off the axis.
fn dog_bone() -> Outline {
    Outline::new(&[[0.0, -1.5, 6.5], [5.0, 0.5, 4.5], [10.0, -1.5, 6.5]]).unwrap()
}

fn base() -> Strip {
    Strip { cut: 1.0, tear: true, ..Strip::new(10.0, 4.0, 1.0) }
}

fn message(strip_: Strip) -> String {
    strip(&strip_).expect_err("should be refused").to_string()
}

#[test]
fn an_outline_shapes_the_strip() {
    for sizing in [Sizing::default(), Sizing::Divisions([8, 20, 2])] {
        let shaped = Strip { outline: Some(dog_bone()), sizing, ..base() };
        let mesh = strip(&shaped).unwrap();
        assert_relative_eq!(mesh.volume(), 60.0, max_relative = 1e-9);
        assert_relative_eq!(mesh.path_area(), 3.0, max_relative = 1e-9);
        assert_relative_eq!(mesh.path_width, 4.0, max_relative = 1e-12);
        assert_relative_eq!(mesh.interfaces[0].x[0], 1.0, max_relative = 1e-12);
        let tip = mesh.interfaces[0].lower[0];
        assert_relative_eq!(mesh.nodes[tip][0], 1.5, max_relative = 1e-12);
        let left = mesh.set("mouth_top").unwrap()[0];
        assert_relative_eq!(mesh.nodes[left][0], -1.5, max_relative = 1e-12);
        assert!(quality(&mesh).min_scaled_jacobian > 0.8);
        let half = strip(&Strip { half_height: true, ..shaped }).unwrap();
        assert_relative_eq!(half.volume(), 30.0, max_relative = 1e-9);
    }
}

#[test]
fn a_thickness_profile_scales_z() {
    let profile = Profile::thickness(vec![[0.0, 2.0], [10.0, 1.0]]).unwrap();
    let shaped = Strip { thickness_profile: Some(profile), ..base() };
    let mesh = strip(&shaped).unwrap();
    assert_relative_eq!(mesh.volume(), 60.0, max_relative = 1e-9);
    assert_relative_eq!(mesh.path_area(), 4.5, max_relative = 1e-9);
    let half = strip(&Strip { half_thickness: true, ..shaped.clone() }).unwrap();
    assert_relative_eq!(half.volume(), 30.0, max_relative = 1e-9);
    assert!(!shaped.is_symmetric(0.5));
    let said = message(Strip { half_height: true, ..shaped });
    assert_eq!(
        said,
        "a half-height mesh needs a thickness profile symmetric about y = 5 mm, but it differs by 1 mm"
    );
}

#[test]
fn symmetry_is_recognised() {
    assert!(dog_bone().is_symmetric(10.0, 1e-12));
    let off = Outline::new(&[[0.0, 0.0, 4.0], [3.0, 0.2, 4.0], [10.0, 0.0, 4.0]]).unwrap();
    assert!(!off.is_symmetric(10.0, 0.05) && off.is_symmetric(10.0, 0.2));
    assert!(base().is_symmetric(0.0));
    assert!(!Strip { path_y: Some(4.0), ..base() }.is_symmetric(1.0));
    assert!(Strip { outline: Some(dog_bone()), ..base() }.is_symmetric(1e-9));
}

#[test]
fn bad_outlines_are_refused() {
    let outline = |points: &[[f64; 3]]| Outline::new(points).expect_err("should be refused").to_string();
    assert!(outline(&[[0.0, 0.0, 4.0]]).contains("point 2 is missing"));
    assert!(outline(&[[0.0, 0.0, 4.0], [1.0, f64::NAN, 4.0]]).contains("point 2 is missing or not finite"));
    assert!(outline(&[[0.0, 0.0, 4.0], [0.0, 0.0, 4.0]]).contains("point 2 is at y = 0 mm after y = 0 mm"));
    assert!(outline(&[[0.0, 0.0, 4.0], [9.0, 5.0, 4.0]]).contains("at y = 9 mm left is 5 mm, right 4 mm"));
    assert!(outline(&[]).contains("at least 2 points"));
    assert!(Profile::thickness(vec![[0.0, 1.0], [9.0, 0.0]]).is_err());
    let short = Outline::new(&[[0.0, 0.0, 4.0], [9.0, 0.0, 4.0]]).unwrap();
    let said = message(Strip { outline: Some(short), ..base() });
    assert_eq!(said, "the outline covers y = 0 … 9 mm, but the strip is y = 0 … 10 mm");
    let narrow = Outline::new(&[[0.0, 0.0, 0.5], [10.0, 0.0, 0.5]]).unwrap();
    let said = message(Strip { outline: Some(narrow), ..base() });
    assert!(said.contains("width 0.5 mm of the outline on the tear path"), "{said}");
}

#[test]
fn bad_numbers_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        assert!(message(Strip { length: bad, ..base() }).starts_with("length must be"));
        assert!(message(Strip { width: bad, ..base() }).starts_with("width must be"));
        assert!(message(Strip { thickness: bad, ..base() }).starts_with("thickness must be"));
        let sizing = Sizing::Graded { bulk_size: bad, path_size: 0.1, layers: 2 };
        assert!(message(Strip { sizing, ..base() }).starts_with("bulk_size must be"));
        let sizing = Sizing::Graded { bulk_size: 0.4, path_size: bad, layers: 2 };
        assert!(message(Strip { sizing, ..base() }).starts_with("path_size must be"));
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(message(Strip { cut: bad, ..base() }).starts_with("cut must be"));
    }
    for bad in [0.0, -1.0, 10.0, 11.0, f64::NAN] {
        assert!(message(Strip { path_y: Some(bad), ..base() }).contains("must lie inside the strip"));
    }
    let said = message(Strip { cut: 7.5, width: 6.0, ..base() });
    assert_eq!(said, "cut 7.5 mm must be smaller than the width 6 mm");
}

#[test]
fn bad_sizes_are_refused() {
    let sized = |sizing| message(Strip { sizing, ..base() });
    assert!(sized(Sizing::Divisions([8, 0, 2])).contains("along y, but 0"));
    assert!(sized(Sizing::Divisions([1, 20, 2])).contains("x = 1 mm (the tip of the cut)"));
    assert!(sized(Sizing::Divisions([usize::MAX; 3])).contains("elements; at most 2000000"));
    assert!(sized(Sizing::Graded { bulk_size: 1e-6, path_size: 1e-6, layers: 1 }).contains("at most"));
    assert!(sized(Sizing::Graded { bulk_size: 0.4, path_size: 0.1, layers: 0 }).contains("along z"));
    assert!(sized(Sizing::Graded { bulk_size: 0.4, path_size: 0.1, layers: usize::MAX }).contains("at most"));
    assert!(
        sized(Sizing::Graded { bulk_size: 0.05, path_size: 0.1, layers: 2 }).contains("0.05 mm must not")
    );
    let odd = Strip { sizing: Sizing::Divisions([8, 21, 2]), half_height: true, ..base() };
    assert!(message(odd).contains("even number of elements along y, but 21"));
    let off = message(Strip { path_y: Some(4.0), half_height: true, ..base() });
    assert!(off.contains("in the middle, y = 5 mm, but it is at y = 4 mm"), "{off}");
    let thin = message(Strip { cut: 1e-3, ..base() });
    assert!(thin.contains("x = 0.001 mm leaves an element of 0.001 mm beside one of 0.09998 mm"), "{thin}");
}

#[test]
fn elements_that_are_not_meshed_do_not_count() {
    let sizing = Sizing::Graded { bulk_size: 0.01, path_size: 0.01, layers: 8 };
    // 1000 × 400 × 8 elements.
    let whole = Strip { sizing, ..base() };
    assert!(message(whole.clone()).contains("at most 2000000"));
    for half in [Strip { half_height: true, ..whole.clone() }, Strip { half_thickness: true, ..whole }] {
        let n = count(&half).unwrap().elements;
        assert_eq!(n.iter().product::<usize>(), 1000 * 400 * 8 / 2, "{n:?}");
    }
}

#[test]
fn a_folded_element_is_named() {
    // Edges that run almost along x shear the elements flat: all alike, or the more the farther right.
    for (last, columns) in [([10.0, 9e7, 9.0e7 + 1.0], 0..8), ([10.0, 0.0, 9e7], 7..8)] {
        let steep = Outline::new(&[[0.0, 0.0, 1.0], [5.0, 0.0, 1.0], last]).unwrap();
        let shaped =
            Strip { outline: Some(steep), cut: 0.2, sizing: Sizing::Divisions([8, 20, 2]), ..base() };
        match strip(&shaped) {
            Err(MeshError::Degenerate { element, place: [x, y, z], .. }) => {
                assert!(columns.contains(&x) && (10..20).contains(&y) && z < 2, "{x} {y} {z}");
                assert_eq!(element, (8 * y + x) * 2 + z);
            }
            other => panic!("expected a degenerate element, got {other:?}"),
        }
    }
}
