//! Counts, places and numbers of rectangular strips.

use approx::assert_relative_eq;
use mesh::{Mesh, MeshError, Sizing, Strip, area_of, quality, refine, strip};

/// The strip of the peers' curves: 8 × 20 × 2 elements on 4 × 10 × 1 mm, cut 1 mm.
fn peers(tear: bool) -> Strip {
    Strip { cut: 1.0, tear, sizing: Sizing::Divisions([8, 20, 2]), ..Strip::new(10.0, 4.0, 1.0) }
}

fn graded(tear: bool) -> Strip {
    Strip { cut: 1.0, tear, ..Strip::new(10.0, 6.0, 0.8) }
}

fn count(mesh: &Mesh, set: &str) -> usize {
    mesh.set(set).unwrap_or_else(|| panic!("no set {set}")).len()
}

fn lines(mesh: &Mesh, axis: usize) -> Vec<f64> {
    let mut all: Vec<f64> = mesh.nodes.iter().map(|node| node[axis]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[test]
fn counts_of_the_peers_mesh() {
    let mesh = strip(&peers(true)).unwrap();
    assert_eq!(mesh.nodes.len(), 9 * 21 * 3 + 27);
    assert_eq!(mesh.columns.len(), mesh.nodes.len());
    assert_eq!(mesh.hexes.len(), 320);
    assert_eq!(mesh.interfaces.len(), 12);
    assert_eq!(mesh.grid, [9, 21, 3]);
    assert_relative_eq!(mesh.volume(), 40.0, max_relative = 1e-12);
    assert_relative_eq!(mesh.path_area(), 3.0, max_relative = 1e-12);
    assert_relative_eq!(quality(&mesh).min_scaled_jacobian, 1.0, max_relative = 1e-12);
    assert_relative_eq!(quality(&mesh).aspect_max, 1.0, max_relative = 1e-12);
    assert_eq!(mesh.elements_per_length(2.0), Some(4.0));
    let sets = ["bottom", "top", "path_lower", "path_upper", "left", "left_mid", "mouth_top"];
    let expected = [27, 27, 27, 27, 66, 6, 3];
    assert_eq!(sets.map(|set| count(&mesh, set)), expected);
    assert_eq!(mesh.set("mid_height"), None);
}

#[test]
fn the_tear_path_is_doubled_and_its_quads_match() {
    for strip_ in [peers(true), graded(true), Strip { path_y: Some(3.7), ..graded(true) }] {
        let mesh = strip(&strip_).unwrap();
        let (lower, upper) = (mesh.set("path_lower").unwrap(), mesh.set("path_upper").unwrap());
        for (&l, &u) in lower.iter().zip(upper) {
            assert!(l != u && mesh.nodes[l] == mesh.nodes[u] && mesh.columns[l] == mesh.columns[u]);
            assert_eq!(mesh.nodes[l][1], mesh.path_y);
        }
        for quad in &mesh.interfaces {
            let upper = quad.upper.unwrap();
            assert_eq!(quad.lower.map(|n| mesh.nodes[n]), upper.map(|n| mesh.nodes[n]));
            let [a, b, _, d] = quad.lower.map(|n| mesh.nodes[n]);
            let normal_y = (b[2] - a[2]) * (d[0] - a[0]) - (b[0] - a[0]) * (d[2] - a[2]);
            assert!(normal_y > 0.0);
            assert_eq!(quad.x, [a[0], d[0]]);
            // The lower side belongs to an element below, the upper side to one above.
            let below = |nodes: [usize; 4], sign: f64| {
                let hex = mesh.hexes.iter().position(|hex| nodes.iter().all(|n| hex.contains(n)));
                let centre = mesh.corners(hex.unwrap()).iter().map(|c| c[1]).sum::<f64>() / 8.0;
                sign * (centre - mesh.path_y) < 0.0
            };
            assert!(below(quad.lower, 1.0) && below(upper, -1.0));
        }
        assert_eq!(mesh.interfaces[0].x[0], strip_.cut);
    }
}

#[test]
fn intact_and_torn_share_numbers() {
    for make in [peers, graded] {
        let (intact, torn) = (strip(&make(false)).unwrap(), strip(&make(true)).unwrap());
        assert!(intact.interfaces.is_empty());
        assert_eq!(intact.grid, torn.grid);
        assert_eq!(intact.hexes.len(), torn.hexes.len());
        assert_eq!(intact.nodes[..], torn.nodes[..intact.nodes.len()]);
        for hex in 0..intact.hexes.len() {
            assert_eq!(intact.corners(hex), torn.corners(hex));
        }
    }
}

#[test]
fn node_lines_lie_at_the_cut_and_on_the_path() {
    let divisions = Sizing::Divisions([7, 9, 2]);
    for sizing in [divisions, Sizing::default()] {
        for path_y in [None, Some(4.1)] {
            let strip_ = Strip { sizing, path_y, cut: 1.23, tear: true, ..Strip::new(10.0, 4.0, 1.0) };
            let mesh = strip(&strip_).unwrap();
            assert!(lines(&mesh, 0).contains(&1.23));
            assert!(lines(&mesh, 1).contains(&path_y.unwrap_or(5.0)));
            assert_relative_eq!(mesh.path_area(), 2.77, max_relative = 1e-12);
            assert_relative_eq!(mesh.volume(), 40.0, max_relative = 1e-12);
        }
    }
}

#[test]
fn halves_are_the_full_mesh_restricted() {
    for make in [peers, graded] {
        for tear in [false, true] {
            let full = strip(&make(tear)).unwrap();
            for (half_height, half_thickness) in [(true, false), (false, true), (true, true)] {
                let half = strip(&Strip { half_height, half_thickness, ..make(tear) }).unwrap();
                let inside = |hex: &usize| {
                    let corners = full.corners(*hex);
                    let mean = |axis: usize| corners.iter().map(|c| c[axis]).sum::<f64>() / 8.0;
                    (!half_height || mean(1) > full.path_y) && (!half_thickness || mean(2) > 0.0)
                };
                let restricted: Vec<usize> = (0..full.hexes.len()).filter(inside).collect();
                assert_eq!(restricted.len(), half.hexes.len());
                for (hex, &of_full) in restricted.iter().enumerate() {
                    assert_eq!(half.corners(hex), full.corners(of_full));
                }
                let share = if half_thickness { 2.0 } else { 1.0 };
                assert_relative_eq!(half.path_area() * share, full.path_area(), max_relative = 1e-12);
                assert!(half.interfaces.iter().all(|q| q.upper.is_none() == half_height));
            }
        }
    }
}

#[test]
fn sets_of_the_quarter_mesh() {
    for tear in [false, true] {
        let mesh = strip(&Strip { half_height: true, half_thickness: true, ..peers(tear) }).unwrap();
        assert_eq!(mesh.grid, [9, 11, 2]);
        let sets = ["mid_height", "mid_thickness", "top", "mouth_top", "left_mid", "right_mid"];
        assert_eq!(sets.map(|set| count(&mesh, set)), [18, 99, 18, 2, 2, 2]);
        for absent in ["bottom", "mouth_bottom", "path_lower"] {
            assert_eq!(mesh.set(absent), None);
        }
        for &node in mesh.set("mid_height").unwrap() {
            assert_eq!(mesh.nodes[node][1], 5.0);
        }
        for &node in mesh.set("mid_thickness").unwrap() {
            assert_eq!(mesh.nodes[node][2], 0.0);
        }
        assert!(mesh.set_names().count() >= 8);
    }
    let one_layer = Strip { half_thickness: true, sizing: Sizing::Divisions([8, 20, 3]), ..peers(false) };
    assert_eq!(strip(&one_layer).unwrap().grid[2], 3);
}

#[test]
fn graded_lines_are_fine_at_the_path_and_symmetric() {
    let mesh = strip(&graded(true)).unwrap();
    let sizes = |axis: usize| -> Vec<f64> { lines(&mesh, axis).windows(2).map(|w| w[1] - w[0]).collect() };
    let (x, y) = (sizes(0), sizes(1));
    assert!(x.iter().chain(&y).all(|&size| size < 0.4 + 1e-9 && size > 0.0999));
    assert_eq!(x.iter().filter(|size| (*size - 0.1).abs() < 1e-9).count(), 50);
    assert!(x.windows(2).all(|s| s[1] < s[0] * (1.0 + 1e-9) && s[0] < 1.34 * s[1]));
    for (a, b) in y.iter().zip(y.iter().rev()) {
        assert_relative_eq!(*a, *b, max_relative = 1e-9);
    }
    let upper = &y[y.len() / 2..];
    assert_relative_eq!(upper[0], 0.1, max_relative = 1e-9);
    assert!(upper.windows(2).all(|s| s[1] > s[0] * (1.0 - 1e-9) && s[1] < 1.34 * s[0]));
    assert!(upper[upper.len() - 1] > 0.35);
}

#[test]
fn areas_at_their_borders() {
    for m in [1, 6, 7, 10] {
        for area in 0..m {
            let border = 1.0 + 3.0 * area as f64 / m as f64;
            assert_eq!(area_of(border, 1.0, 4.0, m), area);
            assert_eq!(area_of(border + 1e-6, 1.0, 4.0, m), area);
            assert_eq!(area_of(border - 1e-6, 1.0, 4.0, m), area.saturating_sub(1));
        }
        assert_eq!(area_of(4.0, 1.0, 4.0, m), m - 1);
        assert_eq!(area_of(99.0, 1.0, 4.0, m), m - 1);
        assert_eq!(area_of(-1.0, 1.0, 4.0, m), 0);
    }
    assert_eq!(area_of(2.0, 1.0, 4.0, 0), 0);
    let mesh = strip(&peers(true)).unwrap();
    let areas: Vec<usize> = (0..12).map(|quad| mesh.area(quad, 3)).collect();
    assert_eq!(areas, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]);
}

#[test]
fn refined_meshes_are_nested() {
    let moved = Strip { cut: 1.1, ..peers(true) };
    let halved = Strip { half_height: true, half_thickness: true, ..graded(true) };
    for strip_ in [peers(true), moved, graded(true), graded(false), halved] {
        let (coarse, fine) = (strip(&strip_).unwrap(), strip(&refine(&strip_, 3)).unwrap());
        assert_eq!(fine.hexes.len(), 27 * coarse.hexes.len());
        assert_eq!(fine.interfaces.len(), 9 * coarse.interfaces.len());
        for axis in 0..3 {
            let thirds: Vec<f64> = lines(&fine, axis).into_iter().step_by(3).collect();
            assert_eq!(thirds, lines(&coarse, axis));
        }
        assert_relative_eq!(fine.path_area(), coarse.path_area(), max_relative = 1e-12);
    }
    assert_eq!(refine(&graded(true), 0), graded(true));
    assert_eq!(refine(&refine(&graded(true), 2), 3), refine(&graded(true), 6));
    assert!(strip(&refine(&graded(true), usize::MAX)).is_err());
}

#[test]
fn a_single_element_is_an_intact_strip() {
    let one = Strip { sizing: Sizing::Divisions([1, 1, 1]), ..Strip::new(1.0, 1.0, 1.0) };
    let mesh = strip(&one).unwrap();
    assert_eq!((mesh.hexes.len(), mesh.nodes.len()), (1, 8));
    assert_eq!(mesh.set("left_mid"), None);
    let torn = strip(&Strip { tear: true, ..one });
    assert!(matches!(torn, Err(MeshError::TooFewDivisions { axis: 'y', .. })));
}
