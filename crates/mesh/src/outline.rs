//! Shapes that are not rectangles: edges and thickness against y, piecewise linear.

use crate::MeshError;

/// Left and right edge of a strip against y.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    left: Profile,
    right: Profile,
}

impl Outline {
    /// An outline through points `[y, left, right]`, mm, with increasing y.
    ///
    /// # Errors
    /// If there are fewer than two points, a number is not finite, y does not increase, or left ≥ right.
    pub fn new(points: &[[f64; 3]]) -> Result<Self, MeshError> {
        let edge = |e: usize| {
            let points = points.iter().map(|p| [p[0], p[e]]).collect();
            Profile::new(points, "outline")
        };
        let (left, right) = (edge(1)?, edge(2)?);
        match points.iter().find(|p| p[1] >= p[2]) {
            Some(&[y, left, right]) => Err(MeshError::EdgesCross { y, left, right }),
            None => Ok(Self { left, right }),
        }
    }

    /// x of the left edge, mm; constant beyond the first and the last point.
    pub fn left(&self, y: f64) -> f64 {
        self.left.at(y)
    }

    /// x of the right edge, mm; constant beyond the first and the last point.
    pub fn right(&self, y: f64) -> f64 {
        self.right.at(y)
    }

    /// Distance of the edges, mm.
    pub fn width(&self, y: f64) -> f64 {
        self.right(y) - self.left(y)
    }

    /// Whether both edges are symmetric about y = length/2 within `tolerance` (mm), as a half-height mesh needs.
    pub fn is_symmetric(&self, length: f64, tolerance: f64) -> bool {
        self.asymmetry(length) <= tolerance
    }

    /// Largest difference (mm) between an edge and its mirror image about y = length/2.
    pub fn asymmetry(&self, length: f64) -> f64 {
        self.left.asymmetry(length).max(self.right.asymmetry(length))
    }

    pub(crate) fn check_covers(&self, length: f64) -> Result<(), MeshError> {
        self.left.check_covers(length, "outline")
    }
}

/// A quantity against y, linear between points: an edge, or the thickness.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    points: Vec<[f64; 2]>,
}

impl Profile {
    /// Thickness against y, through points `[y, thickness]`, mm, with increasing y.
    ///
    /// # Errors
    /// If there are fewer than two points, a number is not finite, y does not increase, or a thickness is not
    /// positive.
    pub fn thickness(points: Vec<[f64; 2]>) -> Result<Self, MeshError> {
        let profile = Self::new(points, "thickness profile")?;
        for &[_, value] in &profile.points {
            crate::strip::check_size("thickness in the thickness profile", value)?;
        }
        Ok(profile)
    }

    fn new(points: Vec<[f64; 2]>, what: &'static str) -> Result<Self, MeshError> {
        let bad = points.iter().position(|p| !p.iter().all(|v| v.is_finite()));
        if let Some(point) = bad.or((points.len() < 2).then_some(points.len())) {
            return Err(MeshError::Points { what, point: point + 1 });
        }
        match points.windows(2).position(|p| p[0][0] >= p[1][0]) {
            Some(at) => Err(MeshError::NotIncreasing {
                what,
                point: at + 2,
                y: points[at + 1][0],
                before: points[at][0],
            }),
            None => Ok(Self { points }),
        }
    }

    /// The value at y, mm; constant beyond the first and the last point.
    pub fn at(&self, y: f64) -> f64 {
        let after = self.points.partition_point(|p| p[0] <= y);
        if after == 0 {
            return self.points[0][1];
        }
        let [y0, v0] = self.points[after - 1];
        match self.points.get(after) {
            Some(&[y1, v1]) => v0 + (v1 - v0) * ((y - y0) / (y1 - y0)),
            None => v0,
        }
    }

    /// Largest difference (mm) between the profile and its mirror image about y = length/2.
    ///
    /// Both are linear between points, so it is reached at a point.
    pub fn asymmetry(&self, length: f64) -> f64 {
        let inside = self.points.iter().map(|p| p[0].clamp(0.0, length));
        inside.map(|y| (self.at(y) - self.at(length - y)).abs()).fold(0.0, f64::max)
    }

    pub(crate) fn check_covers(&self, length: f64, what: &'static str) -> Result<(), MeshError> {
        let (from, to) = (self.points[0][0], self.points[self.points.len() - 1][0]);
        let slack = 1e-6 * length;
        if from > slack || to < length - slack {
            return Err(MeshError::NotCovered { what, from, to, length });
        }
        Ok(())
    }
}
