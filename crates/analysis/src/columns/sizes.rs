//! Sizes of a case, from which starts and shape grids are taken.

use model::{Model, Scales};

/// Sizes from which starts and shape grids are taken.
pub fn scales(model: &Model, theta: &[f64]) -> Scales {
    let mut s = Scales {
        peak_force: 0.0,
        uniaxial_peak: 0.0,
        displacement: 0.0,
        uniaxial_displacement: 0.0,
        duration: 0.0,
        sampling: 1.0,
        energy: 0.0,
        delta_c: 0.5,
        sigma_c: 0.2,
        opening_rate: 0.05,
        fibre_strain: 0.1,
    };
    let mut speed = 0.05;
    for t in &model.tests {
        let Some(r) = &t.test.record else { continue };
        let peak = r.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let far = r.displacement.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        s.peak_force = s.peak_force.max(peak);
        s.displacement = s.displacement.max(far);
        if !t.test.kind.tears {
            s.uniaxial_peak = s.uniaxial_peak.max(peak);
            s.uniaxial_displacement = s.uniaxial_displacement.max(far);
        }
        let duration = r.time[r.time.len() - 1] - r.time[0];
        s.duration = s.duration.max(duration);
        s.sampling = duration / r.time.len() as f64;
        let mut speeds: Vec<f64> = (1..r.time.len())
            .map(|i| ((r.displacement[i] - r.displacement[i - 1]) / (r.time[i] - r.time[i - 1])).abs())
            .collect();
        speeds.sort_by(f64::total_cmp);
        speed = speeds[speeds.len() / 2].max(1e-9);
    }
    if s.uniaxial_peak == 0.0 {
        (s.uniaxial_peak, s.uniaxial_displacement) = (s.peak_force, s.displacement);
    }
    let g = &model.case.geometry;
    // Energy of the uniaxial test per volume: half of peak force times displacement is an upper
    // bound for a stiffening curve; a third is typical.
    s.energy = s.uniaxial_peak * s.uniaxial_displacement / (3.0 * g.length * g.width * g.thickness);
    s.opening_rate = speed;
    let stretch = 1.0 + s.uniaxial_displacement / g.length;
    s.fibre_strain = (stretch * stretch - 1.0) * 0.5;
    let middle = model.areas().div_ceil(2);
    if let Some((delta_c, _)) = model.critical_opening(middle - 1, theta) {
        s.delta_c = delta_c;
    }
    if let Some(i) = model.find(&format!("interface.area[{middle}].sigma_c")) {
        s.sigma_c = theta[i];
    }
    s
}
