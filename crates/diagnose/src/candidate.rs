//! What is screened: effects as columns, one block per shape.

use inverse::Whitened;
use nalgebra::DMatrix;

/// Which values an amplitude may take, relative to neutral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Either side.
    Both,
    /// Above neutral only.
    Positive,
    /// Below neutral only.
    Negative,
}

impl Side {
    /// Whether an amplitude (deviation from neutral) is admissible.
    pub fn admits(self, a: f64) -> bool {
        match self {
            Self::Both => true,
            Self::Positive => a >= 0.0,
            Self::Negative => a <= 0.0,
        }
    }
}

/// One amplitude of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitude {
    /// Parameter name in answers: `g`.
    pub name: String,
    /// Admissible side of neutral.
    pub side: Side,
    /// A plausible deviation from neutral, unit of the amplitude: decides whether the record could see it.
    pub plausible: f64,
    /// Largest deviations below and above neutral that the law admits (both ≥ 0): what an estimate beyond them
    /// promises cannot be had.
    pub limits: (f64, f64),
}

impl Amplitude {
    /// The share (0 to 1) of an estimate that the law admits.
    pub fn admitted(&self, estimate: f64) -> f64 {
        let limit = if estimate < 0.0 { self.limits.0 } else { self.limits.1 };
        if estimate.abs() > limit { limit / estimate.abs() } else { 1.0 }
    }
}

/// The columns of an effect at one set of its shape parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeColumns {
    /// Shape parameters and values, empty when the effect has none: `[("tau_s", 12.0)]`.
    pub parameters: Vec<(String, f64)>,
    /// d(prediction)/d(amplitude) at neutral, one column per amplitude. Full length n when raw; rows of
    /// [`Whitened`] when whitened.
    pub columns: DMatrix<f64>,
}

/// An effect to be screened.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Name in the catalogue.
    pub effect: String,
    /// Its amplitudes; several are tested jointly.
    pub amplitudes: Vec<Amplitude>,
    /// Grid of shapes, neighbours next to each other; a single entry for an effect without shape.
    pub shapes: Vec<ShapeColumns>,
    /// The derivative at neutral does not tell: the screen's answer is a hint, a short refit decides.
    /// Columns may then be secants, or missing (`shapes` empty).
    pub refit_only: bool,
}

impl Candidate {
    /// An effect with one amplitude and no shape.
    pub fn simple(effect: &str, side: Side, plausible: f64, column: nalgebra::DVector<f64>) -> Self {
        let columns = DMatrix::from_columns(&[column]);
        Self {
            effect: effect.to_owned(),
            amplitudes: vec![Amplitude {
                name: effect.to_owned(),
                side,
                plausible,
                limits: (f64::INFINITY, f64::INFINITY),
            }],
            shapes: vec![ShapeColumns { parameters: Vec::new(), columns }],
            refit_only: false,
        }
    }

    /// The same with whitened columns.
    pub fn whiten(&self, white: &Whitened) -> Self {
        let mut out = self.clone();
        for shape in &mut out.shapes {
            let columns: Vec<_> =
                shape.columns.column_iter().map(|c| white.column(&c.into_owned())).collect();
            shape.columns = DMatrix::from_columns(&columns);
        }
        out
    }
}
