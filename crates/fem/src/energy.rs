//! The energy ledger: where the external work went.

use crate::hex8;
use crate::interface;
use crate::problem::{LocalParams, Problem};
use crate::state::{History, State, gather4, gather8};
use crate::system::System;
use constitutive::{Context, Energy};

/// Energies of the whole specimen at a converged step, N·mm, since the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// ∫ F du_actuator.
    pub external_work: f64,
    /// Stored in the bulk.
    pub stored: f64,
    /// Lost in the bulk.
    pub dissipated_bulk: f64,
    /// Stored in the tear path, recoverable on its secants.
    pub cohesive_recoverable: f64,
    /// Lost in the tear path: φ(δ_max) − ½ t_max δ_max and what effects add.
    pub cohesive_dissipated: f64,
    /// Stored and lost in the load train.
    pub rig: f64,
    /// Work of stiffness that changes in time.
    pub parametric: f64,
    /// Set free in jumps at a held actuator, by the path integral.
    pub released_in_jumps: f64,
}

impl Ledger {
    /// External work minus everything it is known to have become.
    pub fn gap(&self) -> f64 {
        self.external_work
            - (self.stored
                + self.dissipated_bulk
                + self.cohesive_recoverable
                + self.cohesive_dissipated
                + self.rig
                + self.parametric
                + self.released_in_jumps)
    }
}

/// Bulk and interface energies at a converged state: (bulk, path), whole specimen.
pub fn internal(
    problem: &Problem,
    local: &LocalParams<f64>,
    system: &System,
    ctx: &Context,
    old: &History,
    state: &State,
) -> (Energy, Energy) {
    let m = problem.multiplicity;
    let nh = problem.bulk_history();
    let mut bulk = Energy::default();
    for (e, h) in problem.body.hexes.iter().enumerate() {
        let geo = &system.geometry()[e];
        let f = hex8::mean_dilatation_gradients(geo, &gather8(&state.u, h));
        for q in 0..hex8::POINTS {
            let at = (e * hex8::POINTS + q) * nh;
            let e = problem.bulk.energies(
                ctx,
                &f[q],
                &local.bulk,
                &old.bulk[at..at + nh],
                &state.history.bulk[at..at + nh],
            );
            bulk.stored += m * geo.volumes[q] * e.stored;
            bulk.dissipated += m * geo.volumes[q] * e.dissipated;
        }
    }
    (bulk, of_path(problem, local, ctx, old, state))
}

/// Energies of the tear path at a converged state, whole specimen, N·mm.
pub fn of_path(
    problem: &Problem,
    local: &LocalParams<f64>,
    ctx: &Context,
    old: &History,
    state: &State,
) -> Energy {
    let m = problem.multiplicity;
    let mut path_energy = Energy::default();
    if let Some(path) = &problem.path {
        let nh = problem.path_history();
        for (e, el) in problem.body.cohesive.iter().enumerate() {
            let ctx = problem.path_context(ctx, e);
            let x = el.lower.map(|n| problem.body.nodes[n]);
            let lower = gather4(&state.u, &el.lower);
            // A mirrored model carries half the path's energy: the multiplicity counts two halves.
            let (points, share) = match &el.upper {
                Some(upper) => (interface::openings(&x, &lower, &gather4(&state.u, upper), path.rule), 1.0),
                None => {
                    let down = lower.map(|v| [v[0], -v[1], v[2]]);
                    (interface::openings(&x, &down, &lower, path.rule), 0.5)
                }
            };
            for (q, (opening, area)) in points.iter().enumerate() {
                let at = (e * interface::POINTS + q) * nh;
                let en = path.law.energies(
                    &ctx[q],
                    opening,
                    &local.path[e][q],
                    &old.path[at..at + nh],
                    &state.history.path[at..at + nh],
                );
                path_energy.stored += m * share * area * en.stored;
                path_energy.dissipated += m * share * area * en.dissipated;
            }
        }
    }
    path_energy
}
