//! What is to be meshed: a strip, its cut and the element sizes.

use crate::{MeshError, Outline, Profile};

/// The largest number of elements that is meshed.
pub const MOST_ELEMENTS: usize = 2_000_000;

/// Element sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sizing {
    /// Elements along x, y, z, uniform over the **full** strip, before any halving. Where no uniform line falls on
    /// the tip of the cut or on the tear path, the nearest line inside the strip is moved there.
    Divisions([usize; 3]),
    /// Fine at the tear path, growing geometrically away from it.
    Graded {
        /// Largest element size, far from the path, mm.
        bulk_size: f64,
        /// Element size on the path ahead of the cut, mm.
        path_size: f64,
        /// Elements through the full thickness.
        layers: usize,
    },
}

impl Default for Sizing {
    /// The paper's 0.4 and 0.1 mm, two layers.
    fn default() -> Self {
        Self::Graded { bulk_size: 0.4, path_size: 0.1, layers: 2 }
    }
}

/// A strip: 0 ≤ x ≤ width (the cut starts at x = 0), 0 ≤ y ≤ length (load), |z| ≤ thickness/2. Lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Along the load, mm.
    pub length: f64,
    /// Across the load, mm. With an outline, the outline's width on the tear path takes its place.
    pub width: f64,
    /// Thickness, mm. With a thickness profile, the profile takes its place.
    pub thickness: f64,
    /// Initial cut from the left edge on the tear path, mm; 0 = none. A node line lies at its tip even when intact,
    /// so that both tests of a specimen share one grid.
    pub cut: f64,
    /// Height of the tear path, mm; `None` = length/2.
    pub path_y: Option<f64>,
    /// Torn: nodes doubled on the tear path, cohesive quads ahead of the cut. Otherwise intact.
    pub tear: bool,
    /// Element sizes.
    pub sizing: Sizing,
    /// Every element of `sizing` is cut into this many along each axis, see [`refine`]; 0 counts as 1.
    pub split: usize,
    /// Mesh only length/2 ≤ y ≤ length; the tear path is then the mirror.
    pub half_height: bool,
    /// Mesh only z ≥ 0; an odd number of layers is rounded up to ceil(layers/2) in the half.
    pub half_thickness: bool,
    /// Edges of a strip that is not a rectangle.
    pub outline: Option<Outline>,
    /// Thickness against y.
    pub thickness_profile: Option<Profile>,
}

impl Strip {
    /// An intact full rectangle with default element sizes.
    pub fn new(length: f64, width: f64, thickness: f64) -> Self {
        Self {
            length,
            width,
            thickness,
            cut: 0.0,
            path_y: None,
            tear: false,
            sizing: Sizing::default(),
            split: 1,
            half_height: false,
            half_thickness: false,
            outline: None,
            thickness_profile: None,
        }
    }

    /// Height of the tear path, mm.
    pub fn path_y(&self) -> f64 {
        self.path_y.unwrap_or(0.5 * self.length)
    }

    /// Width on the tear path, mm.
    pub fn path_width(&self) -> f64 {
        self.outline.as_ref().map_or(self.width, |outline| outline.width(self.path_y()))
    }

    /// Whether the tear path lies at mid-height.
    pub fn is_centred(&self) -> bool {
        (self.path_y() - 0.5 * self.length).abs() <= 1e-9 * self.length
    }

    /// Whether the geometry has the mirror plane y = length/2, within `tolerance` (mm), that a half-height mesh needs.
    pub fn is_symmetric(&self, tolerance: f64) -> bool {
        self.is_centred() && self.shape_asymmetry().is_none_or(|(_, by)| by <= tolerance)
    }

    /// The least symmetric part of the shape and by how much, mm.
    fn shape_asymmetry(&self) -> Option<(&'static str, f64)> {
        let outline = self.outline.as_ref().map(|o| ("outline", o.asymmetry(self.length)));
        let profile = self.thickness_profile.as_ref();
        let profile = profile.map(|p| ("thickness profile", p.asymmetry(self.length)));
        outline.into_iter().chain(profile).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    pub(crate) fn validate(&self) -> Result<(), MeshError> {
        check_size("length", self.length)?;
        check_size("width", self.width)?;
        check_size("thickness", self.thickness)?;
        let (path_y, length) = (self.path_y(), self.length);
        if !(path_y > 0.0 && path_y < length) {
            return Err(MeshError::PathOutside { path_y, length });
        }
        if let Some(outline) = &self.outline {
            outline.check_covers(length)?;
            check_size("width of the outline on the tear path", self.path_width())?;
        }
        if let Some(profile) = &self.thickness_profile {
            profile.check_covers(length, "thickness profile")?;
        }
        if !(self.cut >= 0.0 && self.cut.is_finite()) {
            return Err(MeshError::Cut(self.cut));
        }
        if self.cut >= self.path_width() {
            let (cut, width, outline) = (self.cut, self.path_width(), self.outline.is_some());
            return Err(MeshError::CutTooLong { cut, width, outline });
        }
        if self.half_height {
            self.validate_half_height()?;
        }
        self.validate_sizing()
    }

    fn validate_half_height(&self) -> Result<(), MeshError> {
        let length = self.length;
        if !self.is_centred() {
            return Err(MeshError::NotCentred { path_y: self.path_y(), length });
        }
        match self.shape_asymmetry() {
            Some((what, by)) if by > 1e-6 * length => Err(MeshError::NotSymmetric { what, length, by }),
            _ => Ok(()),
        }
    }

    fn validate_sizing(&self) -> Result<(), MeshError> {
        match self.sizing {
            Sizing::Divisions(n) => {
                for (axis, n) in ['x', 'y', 'z'].into_iter().zip(n) {
                    if n == 0 {
                        return Err(MeshError::NoDivisions { axis });
                    }
                }
                if self.half_height && n[1] % 2 == 1 {
                    return Err(MeshError::OddDivisions(n[1]));
                }
                check_count(n.into_iter().map(|n| n as f64).product())
            }
            Sizing::Graded { bulk_size: bulk, path_size: path, layers } => {
                check_size("bulk_size", bulk)?;
                check_size("path_size", path)?;
                if layers == 0 {
                    return Err(MeshError::NoDivisions { axis: 'z' });
                }
                if bulk < path {
                    return Err(MeshError::BulkFinerThanPath { bulk, path });
                }
                // A lower bound, before any line is laid; the exact count is checked after.
                let across = (self.path_width() - self.cut) / path + self.cut / bulk;
                let along = self.length / bulk;
                let through = if self.half_thickness { layers.div_ceil(2) } else { layers };
                let halves = if self.half_height { 0.5 } else { 1.0 };
                check_count(across.max(1.0) * (halves * along).max(1.0) * through as f64)
            }
        }
    }
}

/// The same strip with every element cut into `factor` along each axis, for mesh convergence and numerical error.
///
/// The meshes are nested: every node line of the coarse mesh is one of the fine mesh, and element sizes shrink by the
/// same factor everywhere, as Richardson extrapolation needs. Smaller sizes or more divisions in [`Sizing`] would
/// not do that where lines are graded or moved. A factor of 0 counts as 1.
pub fn refine(strip: &Strip, factor: usize) -> Strip {
    Strip { split: strip.split.max(1).saturating_mul(factor.max(1)), ..strip.clone() }
}

pub(crate) fn check_size(what: &'static str, value: f64) -> Result<(), MeshError> {
    // Written so that NaN fails.
    if (1e-6..=1e6).contains(&value) { Ok(()) } else { Err(MeshError::Size { what, value }) }
}

pub(crate) fn check_count(count: f64) -> Result<(), MeshError> {
    if count <= MOST_ELEMENTS as f64 {
        return Ok(());
    }
    Err(MeshError::TooManyElements { count, most: MOST_ELEMENTS })
}
