//! The model of one test: its problem at given parameter values, its camera, its pool of solvers.

use super::BuildError;
use crate::camera::Camera;
use crate::effect::{Mount, Sensor, Shape};
use fem::{MountField, Problem, ShapeField, System};
use input::Test;
use mesh::Mesh;
use std::sync::{Arc, Mutex};

/// Specimen and sensor effects with their parameters.
type Shapes = Vec<(Arc<dyn Shape>, Vec<usize>)>;
type Mounts = Vec<(Arc<dyn Mount>, Vec<usize>)>;
type Sensors = Vec<(Arc<dyn Sensor>, Vec<usize>)>;

/// The model of one test.
pub struct TestModel {
    /// The test as the case describes it.
    pub test: Test,
    /// Its mesh.
    pub mesh: Mesh,
    /// Index of the test in the case.
    pub index: usize,
    pub(super) template: Problem,
    pub(super) shapes: Shapes,
    pub(super) mounts: Mounts,
    pub(crate) sensors: Sensors,
    pub(super) pool: Mutex<Vec<System>>,
}

impl TestModel {
    /// The problem at parameter values θ: nodes moved, clamp turned.
    pub fn problem(&self, theta: &[f64]) -> Problem {
        let mut p = self.template.clone();
        let pick = |ids: &[usize]| ids.iter().map(|&i| theta[i]).collect::<Vec<f64>>();
        if !self.shapes.is_empty() {
            self.move_nodes(&mut p, &pick);
        }
        if !self.mounts.is_empty() {
            let mut supports = (*p.supports).clone();
            let share = if self.mesh.half_height { 0.5 } else { 1.0 };
            for (mount, ids) in &self.mounts {
                let mut fields: Vec<Vec<(usize, f64)>> = vec![Vec::new(); ids.len()];
                for &n in self.mesh.set("top").unwrap_or_default() {
                    let (offset, by) = mount.offset(self.mesh.nodes[n][0], &pick(ids));
                    if let Some(s) = &mut supports[3 * n + 1] {
                        s.mount += share * offset;
                    }
                    for (f, d) in fields.iter_mut().zip(by) {
                        f.push((3 * n + 1, share * d));
                    }
                }
                p.mount.extend(ids.iter().zip(fields).map(|(&param, field)| MountField { param, field }));
            }
            p.supports = Arc::new(supports);
        }
        p
    }

    fn move_nodes(&self, p: &mut Problem, pick: &dyn Fn(&[usize]) -> Vec<f64>) {
        let mut body = (*p.body).clone();
        for (shape, ids) in &self.shapes {
            let values = pick(ids);
            let mut fields: Vec<Vec<[f64; 3]>> = vec![vec![[0.0; 3]; body.nodes.len()]; ids.len()];
            for (n, x) in body.nodes.iter_mut().enumerate() {
                let (to, by) = shape.position(*x, &values);
                *x = to;
                for (f, d) in fields.iter_mut().zip(by) {
                    f[n] = d;
                }
            }
            p.shape.extend(ids.iter().zip(fields).map(|(&param, field)| ShapeField { param, field }));
        }
        p.body = Arc::new(body);
    }

    /// Whether the problem's geometry depends on θ.
    pub fn moves_nodes(&self) -> bool {
        !self.shapes.is_empty()
    }

    /// Whether the bulk remembers (so that tests of a piece follow each other).
    pub fn has_memory(&self) -> bool {
        !self.template.bulk.history().is_empty()
    }

    /// Whether any law looks at time.
    pub fn rate_dependent(&self) -> bool {
        self.template.rate_dependent()
    }

    /// Whether load train or bulk remember how far they were moved, whenever that was: their answer has corners at turns.
    pub fn remembers_turns(&self) -> bool {
        let play = self.template.takeup.iter().any(|l| !l.law.history().is_empty());
        play || (self.has_memory() && !self.template.bulk.rate_dependent())
    }

    /// The camera of this test.
    pub fn camera(&self, areas: usize) -> Camera {
        Camera::new(&self.mesh, areas)
    }

    /// Unknowns of the finite-element problem.
    pub fn unknowns(&self) -> usize {
        self.template.supports.iter().filter(|s| s.is_none()).count()
    }

    /// Takes a solver from the pool, or makes one; its geometry is set to the problem's.
    ///
    /// # Errors
    /// [`BuildError::Fem`].
    pub fn take_system(&self, problem: &Problem) -> Result<System, BuildError> {
        let kept = self.pool.lock().map_or_else(|p| p.into_inner().pop(), |mut p| p.pop());
        match kept {
            Some(mut s) => {
                if self.moves_nodes() {
                    s.set_geometry(problem);
                }
                Ok(s)
            }
            None => System::new(problem)
                .map_err(|source| BuildError::Fem { test: self.test.name.clone(), source }),
        }
    }

    /// Gives a solver back.
    pub fn give_back(&self, system: System) {
        if let Ok(mut pool) = self.pool.lock() {
            pool.push(system);
        }
    }
}
