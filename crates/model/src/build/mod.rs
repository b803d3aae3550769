//! From a case to models of its tests: meshes, supports, laws, parameters.

mod builder;
mod place;
mod test_model;
mod turned;

pub(crate) use place::at_key;
pub use test_model::TestModel;

use crate::catalogue::Catalogue;
use crate::effect::{Bulk, Effect, Site};
use builder::Builder;
use constitutive::{Cohesion, StartGrid};
use input::Case;
use params::Parameter;
use std::sync::Arc;
use thiserror::Error;

/// Why a model could not be built.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BuildError {
    /// The mesh.
    #[error("{place}test {test}: {source}")]
    Mesh {
        /// Where the key stands that it is about, as `file:line:column: error: `; empty for a case that no file gave.
        place: String,
        /// Test.
        test: String,
        /// What the mesher says.
        source: mesh::MeshError,
    },
    /// The finite-element problem.
    #[error("test {test}: {source}")]
    Fem {
        /// Test.
        test: String,
        /// What is wrong.
        source: fem::FemError,
    },
    /// What fits into no memory and no time, or more areas than elements; with its place.
    #[error("{0}")]
    TooLarge(String),
    /// An effect that is not in the catalogue.
    #[error("unknown effect `{0}`")]
    UnknownEffect(String),
    /// Something in the case that no model can be made of.
    #[error("{0}")]
    Case(String),
}

/// An effect in this model.
pub(crate) struct Active {
    pub effect: Arc<dyn Effect>,
    /// θ indices of its parameters.
    pub params: Vec<usize>,
    pub options: crate::effect::Options,
    /// Takes no part: it is neutral, and the model was asked to be the base's to the bit.
    pub idle: bool,
}

/// The laws of a model without its effects.
#[derive(Clone)]
pub(crate) struct BaseLaws {
    pub bulk: Bulk,
    /// Scales of the interface law.
    pub cohesion: Option<Arc<dyn Cohesion>>,
    /// Whether the strip's mirror planes are planes of symmetry of the bulk.
    pub mirrors: bool,
    /// θ indices of the interface law's parameters in the first area; empty without a tear path.
    pub path: Vec<usize>,
}

/// The model of a specimen: one parameter vector, one model per test.
pub struct Model {
    /// The case it was built from.
    pub case: Arc<Case>,
    /// All parameters θ, hidden ones included, in the order of the parameter vector.
    pub parameters: Vec<Parameter>,
    /// Models of the tests, in the order of the case.
    pub tests: Vec<TestModel>,
    pub(crate) active: Vec<Active>,
    pub(crate) base: BaseLaws,
}

/// How a model is discretised, beyond what the case says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretisation {
    /// Every element cut into this many along each axis.
    pub split: usize,
    /// Element sizes multiplied by this.
    pub coarsen: f64,
    /// Keep the half-height model although an effect breaks the mirror: exact to first order at
    /// the effect's neutral value (a clamp turned by θ against the other is ±θ/2 to the middle).
    pub neutral_halves: bool,
    /// Effects at their neutral value take no part: the model is that without them to the last bit. Not for a
    /// model whose derivatives by them are wanted.
    pub idle_neutral: bool,
}

impl Default for Discretisation {
    fn default() -> Self {
        Self { split: 1, coarsen: 1.0, neutral_halves: false, idle_neutral: false }
    }
}

/// What is known of a model before it is meshed.
pub(crate) struct Outlook {
    /// Size of each test's mesh.
    pub counts: Vec<mesh::Count>,
    /// Free parameters.
    pub free: usize,
    /// Entries of the bulk's history at a point.
    pub bulk_history: usize,
}

/// Looks ahead to a model without meshing it.
///
/// # Errors
/// [`BuildError`] naming the test.
pub(crate) fn outlook(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    how: Discretisation,
) -> Result<Outlook, BuildError> {
    let builder = Builder::new(case, catalogue, how.idle_neutral)?;
    let half_height = builder.half_height(how);
    let count = |test: &input::Test| {
        let experiment = builder::experiment_of(catalogue, test)?;
        let strip = experiment.strip(&builder.setting(case, test, half_height, how));
        strip.and_then(|s| mesh::count(&s)).map_err(|source| BuildError::mesh(case, &test.name, source))
    };
    Ok(Outlook {
        counts: case.tests.iter().map(count).collect::<Result<_, _>>()?,
        free: builder.parameters.iter().filter(|p| p.free).count(),
        bulk_history: builder.bulk_history(),
    })
}

/// Whether what the tissue remembers can be carried over from each test to the next.
fn one_piece(case: &Case, tests: &[TestModel]) -> Result<(), BuildError> {
    for pair in tests.windows(2) {
        let [before, after] = [&pair[0], &pair[1]];
        let inherits = after.has_memory() && !after.test.fresh_piece;
        let alike = before.test.kind.layout == after.test.kind.layout
            && before.mesh.hexes.len() == after.mesh.hexes.len();
        if inherits && !alike {
            return Err(BuildError::Case(format!(
                "{}test {}: the tissue remembers, and the piece is meshed otherwise than in test {}; \
                 give `fresh_piece = true`, or leave the effect out",
                at_key(case, "tests", "kind"),
                after.test.name,
                before.test.name
            )));
        }
    }
    Ok(())
}

impl Model {
    /// Builds the models of all tests of a case.
    ///
    /// # Errors
    /// [`BuildError`] naming the test.
    pub fn new(case: Arc<Case>, catalogue: &Catalogue, how: Discretisation) -> Result<Self, BuildError> {
        let mut builder = Builder::new(&case, catalogue, how.idle_neutral)?;
        let half_height = builder.half_height(how);
        let tests = case
            .tests
            .iter()
            .enumerate()
            .map(|(index, test)| builder.test(&case, catalogue, test, index, half_height, how))
            .collect::<Result<Vec<_>, _>>()?;
        one_piece(&case, &tests)?;
        let Builder { parameters, active, base, .. } = builder;
        Ok(Self { parameters, active, base, tests, case })
    }

    /// Present parameter values θ.
    pub fn theta(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }

    /// Index of the parameter at a path.
    pub fn find(&self, path: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.path == path)
    }

    /// Indices of the free parameters.
    pub fn free(&self) -> Vec<usize> {
        (0..self.parameters.len()).filter(|&i| self.parameters[i].free).collect()
    }

    /// Indices of the free parameters of one site.
    pub fn free_on(&self, site: Site) -> Vec<usize> {
        self.free().into_iter().filter(|&i| self.site_of(i) == site).collect()
    }

    /// Which tests have a record.
    pub fn recorded(&self) -> Vec<bool> {
        self.tests.iter().map(|t| t.test.record.is_some()).collect()
    }

    /// Whether a parameter is only carried for the law's sake and shown to nobody.
    pub fn is_hidden(&self, index: usize) -> bool {
        let p = &self.parameters[index];
        p.spec.internal && !p.free
    }

    /// The bulk law without its effects; its parameters are the first of the parameter vector.
    pub fn bulk_law(&self) -> &Bulk {
        &self.base.bulk
    }

    /// Values from which a search for the bulk may start, as its law offers them; indices are those of θ.
    pub fn starts(&self) -> Option<StartGrid> {
        self.base.bulk.offers().bulk.and_then(|b| b.starts)
    }

    /// Opening δc at which an area (from 0) reaches its strength, mm, and its derivatives by (Gc, σc); `None` without
    /// a tear path.
    pub fn critical_opening(&self, area: usize, theta: &[f64]) -> Option<(f64, [f64; 2])> {
        let params = self.path_parameters(area, theta)?;
        self.base.cohesion.as_ref().map(|c| c.delta_c(&params))
    }

    /// Opening at which the softening zone ends, over δc; `None` without a tear path.
    pub(crate) fn softening_end(&self, theta: &[f64]) -> Option<f64> {
        let params = self.path_parameters(0, theta)?;
        self.base.cohesion.as_ref().map(|c| c.softening_end(&params))
    }

    /// The interface law's parameters in an area (from 0), without those of effects.
    fn path_parameters(&self, area: usize, theta: &[f64]) -> Option<Vec<f64>> {
        let at = |(k, i): (usize, &usize)| theta[if k < cohesive::LAMBDA { i + area } else { *i }];
        (!self.base.path.is_empty()).then(|| self.base.path.iter().enumerate().map(at).collect())
    }

    /// The site a parameter acts on.
    pub fn site_of(&self, index: usize) -> Site {
        match self.active.iter().find(|a| a.params.contains(&index)) {
            Some(a) => a.effect.card().site,
            None if self.parameters[index].path.starts_with("bulk.") => Site::Bulk,
            None => Site::Interface,
        }
    }

    /// Whether a parameter is an effect's.
    pub fn is_of_effect(&self, index: usize) -> bool {
        self.active.iter().any(|a| a.params.contains(&index))
    }

    /// Names of the effects in the model.
    pub fn effects(&self) -> Vec<String> {
        self.active.iter().map(|a| a.effect.card().name.to_owned()).collect()
    }

    /// Number of areas along the tear path.
    pub fn areas(&self) -> usize {
        self.case.interface.areas
    }
}
