//! The state of a body between steps.

use crate::hex8;
use crate::interface;
use crate::problem::Problem;

/// Displacements, forces and history at a converged step.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Nodal displacements, 3 per node, mm.
    pub u: Vec<f64>,
    /// Mean stress times volume of each brick, N·mm: none of the unknowns, but where Newton's method begins.
    pub pressure: Vec<f64>,
    /// Distance the clamps moved apart, mm.
    pub grip: f64,
    /// Actuator displacement, mm.
    pub actuator: f64,
    /// Force on the load train, N (whole specimen).
    pub force: f64,
    /// Clock, s.
    pub time: f64,
    /// History of all laws.
    pub history: History,
}

/// Memory of all points.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct History {
    /// Bulk: element, point, entry.
    pub bulk: Vec<f64>,
    /// Interface: element, point, entry.
    pub path: Vec<f64>,
    /// Load train, then take-ups: link, entry.
    pub train: Vec<f64>,
}

impl History {
    /// Virgin tissue.
    pub fn virgin(problem: &Problem) -> Self {
        let repeat = |specs: Vec<constitutive::HistorySpec>, points: usize| {
            let one: Vec<f64> = specs.iter().map(|h| h.initial).collect();
            one.repeat(points)
        };
        Self {
            bulk: repeat(problem.bulk.history(), problem.body.hexes.len() * hex8::POINTS),
            path: problem.path.as_ref().map_or_else(Vec::new, |p| {
                repeat(p.law.history(), problem.body.cohesive.len() * interface::POINTS)
            }),
            train: problem
                .train
                .iter()
                .chain(&problem.takeup)
                .flat_map(|l| l.law.history())
                .map(|h| h.initial)
                .collect(),
        }
    }
}

impl State {
    /// Undeformed, virgin.
    pub fn virgin(problem: &Problem) -> Self {
        Self {
            u: vec![0.0; 3 * problem.body.nodes.len()],
            pressure: vec![0.0; problem.body.hexes.len()],
            grip: 0.0,
            actuator: 0.0,
            force: 0.0,
            time: 0.0,
            history: History::virgin(problem),
        }
    }
}

/// Where Newton's method begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// Nodal displacements, 3 per node, mm.
    pub u: Vec<f64>,
    /// Mean stress times volume of each brick, N·mm.
    pub pressure: Vec<f64>,
}

impl Guess {
    /// Σ wᵢ gᵢ of guesses on one mesh; none of none.
    pub fn combined(of: &[(f64, &Self)]) -> Option<Self> {
        let sum = |part: fn(&Self) -> &Vec<f64>, n: usize| {
            let mut all = vec![0.0; n];
            for (w, g) in of {
                for (a, b) in all.iter_mut().zip(part(g)) {
                    *a += w * b;
                }
            }
            all
        };
        let first = of.first()?.1;
        Some(Self { u: sum(|g| &g.u, first.u.len()), pressure: sum(|g| &g.pressure, first.pressure.len()) })
    }
}

impl State {
    /// Displacements and pressures, for a guess at another state.
    pub fn guess(&self) -> Guess {
        Guess { u: self.u.clone(), pressure: self.pressure.clone() }
    }

    /// Takes a guess as start.
    pub fn start_from(&mut self, guess: Guess) {
        (self.u, self.pressure) = (guess.u, guess.pressure);
    }
}

/// Displacements of the eight nodes of a brick.
pub fn gather8(u: &[f64], nodes: &[usize; 8]) -> [[f64; 3]; 8] {
    nodes.map(|n| [u[3 * n], u[3 * n + 1], u[3 * n + 2]])
}

/// Displacements of four nodes.
pub fn gather4(u: &[f64], nodes: &[usize; 4]) -> [[f64; 3]; 4] {
    nodes.map(|n| [u[3 * n], u[3 * n + 1], u[3 * n + 2]])
}
