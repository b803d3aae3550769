//! A cheap model put right by an expensive one at an anchor, in value and jacobian ([`crate::fit_mapped`]).

use crate::{Free, PredictError, Prediction, Problem};
use nalgebra::{DMatrix, DVector};

/// The cheap model, equal to the expensive one at the anchor to first order.
pub struct Mapped<'a> {
    cheap: &'a dyn Problem,
    free: &'a [Free],
    anchor: DVector<f64>,
    shift: DVector<f64>,
    /// Difference of the jacobians by z, n × p.
    slope: DMatrix<f64>,
    valid: Option<Vec<bool>>,
    /// The expensive model at the anchor, where every fit of the map begins, with the jacobian that steps are taken by.
    there: Option<(Vec<f64>, Prediction)>,
}

fn transformed(free: &[Free], theta: &[f64]) -> DVector<f64> {
    DVector::from_iterator(free.len(), free.iter().zip(theta).map(|(f, &x)| f.forward(x)))
}

/// Points that both predictions hold for smooth.
fn both(a: Option<&Vec<bool>>, b: Option<&Vec<bool>>) -> Option<Vec<bool>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.iter().zip(b).map(|(a, b)| *a && *b).collect()),
        (one, other) => one.or(other).cloned(),
    }
}

impl<'a> Mapped<'a> {
    /// The map at `theta`, where the expensive model predicts `expensive` (with its jacobian). Points at which either
    /// model jumps keep the cheap model's slope.
    ///
    /// # Errors
    /// [`PredictError`] when the cheap model cannot be computed there.
    pub fn at(
        cheap: &'a dyn Problem,
        free: &'a [Free],
        theta: &[f64],
        expensive: &Prediction,
    ) -> Result<Self, PredictError> {
        let own = cheap.predict(theta, true)?;
        let valid = both(expensive.valid.as_ref(), own.valid.as_ref());
        let mut slope = match (&expensive.jacobian, &own.jacobian) {
            (Some(f), Some(c)) => f - c,
            _ => DMatrix::zeros(own.values.len(), free.len()),
        };
        for (k, f) in free.iter().enumerate() {
            slope.column_mut(k).scale_mut(f.transform.slope(theta[k]));
        }
        let jumps = valid.iter().flatten().enumerate().filter(|(_, v)| !**v);
        jumps.for_each(|(i, _)| slope.row_mut(i).fill(0.0));
        let shift = &expensive.values - &own.values;
        let mut map =
            Self { cheap, free, anchor: transformed(free, theta), shift, slope, valid, there: None };
        let there = map.put_right(theta, own);
        map.there = Some((theta.to_vec(), there));
        Ok(map)
    }

    /// The cheap model's prediction as the map's.
    fn put_right(&self, theta: &[f64], mut p: Prediction) -> Prediction {
        p.values += &self.shift + &self.slope * (transformed(self.free, theta) - &self.anchor);
        if let Some(j) = &mut p.jacobian {
            for (k, f) in self.free.iter().enumerate() {
                let slope = f.transform.slope(theta[k]);
                if slope != 0.0 {
                    j.column_mut(k).axpy(1.0 / slope, &self.slope.column(k), 1.0);
                }
            }
        }
        p.valid = both(p.valid.as_ref(), self.valid.as_ref());
        p
    }
}

impl Problem for Mapped<'_> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        match &self.there {
            Some((at, p)) if at == theta => Ok(p.clone()),
            _ => Ok(self.put_right(theta, self.cheap.predict(theta, jacobian)?)),
        }
    }
}
