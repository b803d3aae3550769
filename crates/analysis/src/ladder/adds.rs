//! What each effect of a screen would add to the forces of the base model: to be drawn onto the misfit.

use super::FeLadder;
use diagnose::Screen;
use model::Channel;
use nalgebra::{DMatrix, DVector};

/// What effects would add to the forces, N.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Adds {
    /// Names in the catalogue.
    pub effects: Vec<String>,
    /// Per test: its name, and per effect one force per point of the record.
    pub tests: Vec<(String, Vec<Vec<f64>>)>,
}

impl FeLadder<'_> {
    /// Of every effect with derivatives: its columns times the estimated amplitudes, less what the base parameters can
    /// imitate (they would be fitted again), so that it compares with the misfit.
    pub fn adds(&self, screen: &Screen) -> Adds {
        let Some(base) = self.fitted_models.get(&Vec::new()) else { return Adds::default() };
        let weights = self.weights();
        // What stands at a bound does not move, in the screen as here.
        let open: Vec<usize> = (0..base.fit.at_bound.len()).filter(|&k| !base.fit.at_bound[k]).collect();
        let moves = base.fit.prediction.jacobian.as_ref().map(|j| j.select_columns(&open));
        let imitate = moves.as_ref().map(|j| weighted(j, &weights).svd(true, true));
        let mut out = Adds::default();
        let mut all: Vec<DVector<f64>> = Vec::new();
        for finding in &screen.findings {
            let candidate = self.candidates.iter().find(|c| c.effect == finding.effect);
            let Some(shape) = candidate.and_then(|c| c.shapes.get(finding.shape_index)) else { continue };
            let amplitudes =
                DVector::from_iterator(finding.amplitudes.len(), finding.amplitudes.iter().map(|a| a.1));
            if shape.columns.shape() != (weights.len(), amplitudes.len()) {
                continue;
            }
            let mut own = &shape.columns * amplitudes;
            if let (Some(svd), Some(j)) = (&imitate, &moves)
                && let Ok(step) = svd.solve(&own.component_mul(&weights), 1e-10 * svd.singular_values.max())
            {
                own -= j * step;
            }
            out.effects.push(finding.effect.clone());
            all.push(own);
        }
        let blocks = self.measured.slots.iter().zip(&self.measured.data.blocks);
        for (slot, block) in blocks.filter(|(s, _)| s.channel == Channel::Force) {
            let of = |v: &DVector<f64>| block.range.clone().map(|i| v[i]).collect();
            out.tests.push((self.case().tests[slot.test].name.clone(), all.iter().map(of).collect()));
        }
        out
    }

    /// One over the noise of every point; 0 where it takes no part in the fit.
    fn weights(&self) -> DVector<f64> {
        let blocks = &self.measured.data.blocks;
        let used = |i: usize| f64::from(u8::from(self.measured.data.is_used(i)));
        let of = |b: &inverse::Block, i: usize| used(i) / b.noise.sd_of(i - b.range.start);
        let all = blocks.iter().flat_map(|b| b.range.clone().map(move |i| of(b, i)));
        DVector::from_iterator(blocks.iter().map(|b| b.range.len()).sum(), all)
    }
}

fn weighted(jacobian: &DMatrix<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
    let mut out = jacobian.clone();
    for mut column in out.column_iter_mut() {
        column.component_mul_assign(weights);
    }
    out
}
