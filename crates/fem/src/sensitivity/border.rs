//! Closing the border: train, grip and actuator answer for what the free unknowns leave open.

use super::{Chunk, Stage};
use crate::equilibrium::Border;
use crate::system::NONE;
use constitutive::{Jet, Law, PointLaw};

impl<const W: usize> Chunk<W>
where
    dyn PointLaw<9>: Law<Jet<W>, 9>,
    dyn PointLaw<3>: Law<Jet<W>, 3>,
    dyn PointLaw<1>: Law<Jet<W>, 1>,
{
    pub(super) fn total_u(
        &self,
        stage: &Stage,
        border: &Border,
        solution: &[f64],
        d_grip: &[f64; W],
    ) -> Vec<Jet<W>> {
        let n = stage.system.unknowns;
        let mut u = self.mount_jets(&stage.state.u);
        for (dof, &eq) in stage.system.equation.iter().enumerate() {
            for c in 0..self.seeds.len() {
                if eq != NONE {
                    u[dof].eps[c] = solution[c * n + eq] + border.response[eq] * d_grip[c];
                } else if let Some(p) = self.problem.supports[dof] {
                    u[dof].eps[c] += p.grip * d_grip[c];
                }
            }
        }
        u
    }

    /// du_grip, du_actuator and dF per column, from the linearised train and control.
    pub(super) fn close_border(
        &self,
        stage: &Stage,
        border: &Border,
        solution: &[f64],
    ) -> ([f64; W], [f64; W], [f64; W]) {
        let n = stage.system.unknowns;
        let m = self.problem.multiplicity;
        let force = Jet::<W>::constant(stage.state.force);
        let mut e_jet = Jet::<W>::constant(0.0);
        let (mut slope, mut at) = (0.0, 0);
        for (link, (p, plain)) in
            self.problem.train.iter().zip(self.local.train.iter().zip(&self.plain.train))
        {
            let nh = link.law.history().len();
            let old = &self.train[at..at + nh];
            let mut new = old.to_vec();
            e_jet += Law::<Jet<W>, 1>::respond(&*link.law, &stage.ctx, &[force], p, old, &mut new).force[0];
            let plain_old: Vec<f64> = old.iter().map(|h| h.re).collect();
            let mut plain_new = plain_old.clone();
            slope += constitutive::tangent_by_jets_1(
                &*link.law,
                &stage.ctx,
                &[force.re],
                plain,
                &plain_old,
                &mut plain_new,
            )
            .1[0][0];
            at += nh;
        }
        let at_rest = Jet::constant(stage.state.actuator);
        let (train, mut after) = (&self.train, self.train.clone());
        let s_jet = self.problem.take_up(at_rest, stage.path_from(), &self.local.takeup, train, &mut after);
        let (old, takeup): (Vec<f64>, _) = (self.train.iter().map(|h| h.re).collect(), &self.plain.takeup);
        let at = (stage.state.actuator, stage.path_from());
        let (_, s_slope) = crate::equilibrium::take_up(&self.problem, takeup, at, &old, &mut old.clone());
        let (mut d_grip, mut d_act, mut d_force) = ([0.0; W], [0.0; W], [0.0; W]);
        let opening = |x: &[f64]| -> f64 { stage.system.opening.iter().map(|&(eq, w)| w * x[eq]).sum() };
        for c in 0..self.seeds.len() {
            let y = &solution[c * n..(c + 1) * n];
            let along: f64 = stage.system.grip_column.iter().zip(y).map(|(a, b)| a * b).sum();
            let held = m * (self.force_partial[c] + along); // dF at a held grip
            // (1 + e' k) du_g = s_θ + s' du_a − e_θ − e' F_θ
            let lhs = 1.0 + slope * border.stiffness;
            let rhs = s_jet.eps[c] - e_jet.eps[c] - slope * held;
            (d_grip[c], d_act[c]) = match stage.arc {
                None => (rhs / lhs, 0.0),
                Some([tu, tw]) => {
                    let per_grip = tu * lhs / s_slope + tw * opening(&border.response);
                    let g = (tu * rhs / s_slope - tw * opening(y)) / per_grip;
                    (g, (lhs * g - rhs) / s_slope)
                }
            };
            d_force[c] = held + border.stiffness * d_grip[c];
        }
        (d_grip, d_act, d_force)
    }

    pub(super) fn carry_train(&mut self, stage: &Stage, d_force: &[f64; W]) {
        let force = Jet::<W> { re: stage.state.force, eps: *d_force };
        let mut at = 0;
        for (link, p) in self.problem.train.iter().zip(&self.local.train) {
            let nh = link.law.history().len();
            let old = self.train[at..at + nh].to_vec();
            Law::<Jet<W>, 1>::respond(
                &*link.law,
                &stage.ctx,
                &[force],
                p,
                &old,
                &mut self.train[at..at + nh],
            );
            at += nh;
        }
        let (old, at_rest) = (self.train.clone(), Jet::constant(stage.state.actuator));
        self.problem.take_up(at_rest, stage.path_from(), &self.local.takeup, &old, &mut self.train);
    }
}
