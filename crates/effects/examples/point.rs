//! Cost of the tangent of each bulk effect against the plain law.
use model::{Action, Options, Piece};
use std::sync::Arc;
use std::time::Instant;
fn main() {
    let cat = effects::catalogue();
    let base: Arc<dyn constitutive::PointLaw<9>> = Arc::new(hgo::Hgo::default());
    let f = [0.93, 0.02, 0.0, 0.05, 1.12, 0.01, 0.0, 0.0, 0.96];
    let base_p = [0.005, 1.0, 30.0, 0.7, 0.2, 0.1, 0.0];
    let time = |law: &dyn constitutive::PointLaw<9>, p: &[f64], name: &str| {
        let h: Vec<f64> = law.history().iter().map(|h| h.initial).collect();
        let mut new = h.clone();
        let ctx = constitutive::Context { dt: 0.1, time: 1.0, path_position: 0.5 };
        let n = 20000;
        let t = Instant::now();
        let mut s = 0.0;
        for _ in 0..n {
            s += constitutive::tangent_by_jets_9(law, &ctx, std::hint::black_box(&f), p, &h, &mut new).0[4];
        }
        let jets = t.elapsed().as_secs_f64() / n as f64 * 1e9;
        let t = Instant::now();
        let mut given = false;
        for _ in 0..n {
            if let Some(r) = law.analytic_tangent(&ctx, std::hint::black_box(&f), p, &h, &mut new) {
                s += r.0[4];
                given = true;
            }
        }
        let analytic = t.elapsed().as_secs_f64() / n as f64 * 1e9;
        println!("{name:20} jets {jets:7.0} ns, analytic {given} {analytic:7.0} ns {s:.1e}");
    };
    time(&*base, &base_p, "hgo");
    for name in
        ["mullins", "viscoelastic", "fiber_damage", "permanent_set", "stiffness_drift", "fiber_recruitment"]
    {
        let e = cat.get(name).unwrap();
        let piece = Piece { length: 10.0, width: 6.0, thickness: 1.0, cut: 1.0 };
        if let Action::Bulk(wrap) = e.act(&Options::new(), &piece) {
            let law = wrap(base.clone());
            let mut p = base_p.to_vec();
            p.extend(e.parameters(&Options::new()).iter().map(|s| s.start));
            time(&*law, &p, name);
        }
    }
}
