//! The clamped sheet on three meshes, each halved in its plane: both forces against Richardson's limit, and that against the
//! homogeneous sheet.
//!
//! At the end of a clamp the stress is singular, as ahead of a cut (displacements go with √r), so forces converge with the
//! first power of the element size, whatever the element.

use crate::common::run;

/// Forces along y and x at the end, N, of a sheet of 10 × 8 × 1.2 mm that is pulled by so much (mm).
fn forces(ends: &str, to: f64, bricks: usize) -> [f64; 2] {
    let text = format!(
        "name = \"sheet\"\n[geometry]\nlength_mm = 10.0\nwidth_mm = 8.0\nthickness_mm = 1.2\n\
         [[tests]]\nkind = \"biaxial\"\nends = \"{ends}\"\nratio_x = 0.8\n\
         protocol = [{{ to_mm = {to}, rate_mm_per_s = 0.05 }}]\n[mesh]\ndivisions = [{bricks}, {bricks}, 2]\n\
         [bulk]\nmu_kPa = 5.1\nk1_kPa = 38.8\nk2 = 8.0\ngamma_deg = 30.0\nkappa = 0.15\n\
         [solver]\nstep_mm = 0.5\n"
    );
    let test = run(&text);
    let last = |values: &[f64]| values[values.len() - 1];
    [last(&test.force), last(&test.across[1])]
}

/// Observed order, limit, and how far each of three values is from it, as a share. Element sizes are halved.
fn richardson([coarse, middle, fine]: [f64; 3]) -> (f64, f64, [f64; 3]) {
    let order = ((coarse - middle) / (middle - fine)).log2();
    let limit = fine + (fine - middle) / (order.exp2() - 1.0);
    (order, limit, [coarse, middle, fine].map(|f| f / limit - 1.0))
}

/// Both forces converge, with about the first power of the size. Multiples of ten bricks along an edge put nodes at the
/// ends of its clamp, the middle 0.6.
fn converge(to: f64) {
    const BRICKS: [usize; 3] = [20, 40, 80];
    let (free, held) = (forces("sliding", to, 1), BRICKS.map(|n| forces("clamped", to, n)));
    for axis in [0, 1] {
        let values = held.map(|f| f[axis]);
        let (order, limit, errors) = richardson(values);
        println!(
            "{to} mm, force {}: {values:.5?} N on {BRICKS:?} bricks, order {order:.2}, limit {limit:.5} N ({:+.0} % of the \
             homogeneous {:.5}), off by {:.1} {:.1} {:.1} %",
            ["y", "x"][axis],
            100.0 * (limit / free[axis] - 1.0),
            free[axis],
            100.0 * errors[0],
            100.0 * errors[1],
            100.0 * errors[2]
        );
        assert!((0.75..1.5).contains(&order), "{order}");
        assert!(errors[0] > errors[1] && errors[1] > errors[2] && errors[2] > 0.0, "{errors:?}");
        assert!((limit / free[axis] - 1.0).abs() > 0.05, "clamps are seen: {limit} and {} N", free[axis]);
    }
}

#[test]
fn a_clamped_sheet_at_small_stretch_converges() {
    converge(0.5);
}

/// Fibres that stiffen carry the singular stress far: some ten times the error.
#[test]
fn a_clamped_sheet_of_stiffening_fibres_converges_slowly() {
    converge(1.5);
}
