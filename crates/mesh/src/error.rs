//! What can be wrong with a strip, in words with the offending numbers.

/// Why a strip could not be meshed. Every message names the numbers and their units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A dimension or size is zero, negative, not finite, or out of any sensible range.
    #[error("{what} must be a number between 1e-6 and 1e6 mm, but is {value} mm")]
    Size {
        /// The key, e.g. `length`.
        what: &'static str,
        /// The offending value, mm.
        value: f64,
    },
    /// The initial cut is negative or not finite.
    #[error("cut must be zero (no cut) or a positive number of mm, but is {0} mm")]
    Cut(f64),
    /// The initial cut leaves no ligament.
    #[error("cut {cut} mm must be smaller than the width {width} mm{}",
        if *.outline { " of the outline on the tear path" } else { "" })]
    CutTooLong {
        /// Initial cut, mm.
        cut: f64,
        /// Width on the tear path, mm.
        width: f64,
        /// Whether the width comes from an outline.
        outline: bool,
    },
    /// The tear path is not inside the strip.
    #[error("the tear path at y = {path_y} mm must lie inside the strip, 0 < y < {length} mm")]
    PathOutside {
        /// Height of the tear path, mm.
        path_y: f64,
        /// Length of the strip, mm.
        length: f64,
    },
    /// Zero elements along an axis.
    #[error("at least one element is needed along {axis}, but 0 are asked for")]
    NoDivisions {
        /// Axis name.
        axis: char,
    },
    /// No interior node line that could be moved to a place where one is needed.
    #[error(
        "a node line is needed at {axis} = {at} mm ({what}), so at least 2 elements along {axis} \
         are needed, but {divisions} is asked for"
    )]
    TooFewDivisions {
        /// Axis name.
        axis: char,
        /// Where the line is needed, mm.
        at: f64,
        /// Why it is needed.
        what: &'static str,
        /// Elements asked for.
        divisions: usize,
    },
    /// Two neighbouring elements differ so much in size that one is next to degenerate.
    #[error(
        "the node line at {axis} = {at} mm leaves an element of {size} mm beside one of \
         {neighbour} mm along {axis}; use finer elements, or move the cut or the tear path"
    )]
    TooThin {
        /// Axis name.
        axis: char,
        /// Line between the two elements, mm.
        at: f64,
        /// The small size, mm.
        size: f64,
        /// The large size, mm.
        neighbour: f64,
    },
    /// An odd number of elements cannot be halved.
    #[error("a half-height mesh needs an even number of elements along y, but {0} are asked for")]
    OddDivisions(usize),
    /// A half-height mesh of a path that is not the mirror plane.
    #[error(
        "a half-height mesh needs the tear path in the middle, y = {} mm, but it is at \
         y = {path_y} mm", .length / 2.0
    )]
    NotCentred {
        /// Height of the tear path, mm.
        path_y: f64,
        /// Length of the strip, mm.
        length: f64,
    },
    /// A half-height mesh of a shape without that symmetry.
    #[error(
        "a half-height mesh needs a {what} symmetric about y = {} mm, but it differs by {by} mm",
        .length / 2.0
    )]
    NotSymmetric {
        /// `outline` or `thickness profile`.
        what: &'static str,
        /// Length of the strip, mm.
        length: f64,
        /// Largest difference, mm.
        by: f64,
    },
    /// Bulk elements finer than those on the path.
    #[error("bulk_size {bulk} mm must not be smaller than path_size {path} mm")]
    BulkFinerThanPath {
        /// Element size away from the path, mm.
        bulk: f64,
        /// Element size at the path, mm.
        path: f64,
    },
    /// More elements than any computer of the user would like.
    #[error("the mesh would have about {count:.3e} elements; at most {most} are allowed")]
    TooManyElements {
        /// Elements asked for.
        count: f64,
        /// The limit.
        most: usize,
    },
    /// Fewer than two points, or a number that is not finite.
    #[error("the {what} needs at least 2 points of finite numbers, point {point} is missing or not finite")]
    Points {
        /// `outline` or `thickness profile`.
        what: &'static str,
        /// Number of the point, from 1.
        point: usize,
    },
    /// The y values of an outline or profile do not increase.
    #[error("the {what} needs increasing y: point {point} is at y = {y} mm after y = {before} mm")]
    NotIncreasing {
        /// `outline` or `thickness profile`.
        what: &'static str,
        /// Number of the point, from 1.
        point: usize,
        /// y of the point, mm.
        y: f64,
        /// y of the point before, mm.
        before: f64,
    },
    /// The edges touch or cross.
    #[error(
        "the outline's left edge must lie left of the right edge: at y = {y} mm left is {left} mm, right {right} mm"
    )]
    EdgesCross {
        /// Where, mm.
        y: f64,
        /// Left edge, mm.
        left: f64,
        /// Right edge, mm.
        right: f64,
    },
    /// An outline or profile that ends before the strip does.
    #[error("the {what} covers y = {from} … {to} mm, but the strip is y = 0 … {length} mm")]
    NotCovered {
        /// `outline` or `thickness profile`.
        what: &'static str,
        /// First y, mm.
        from: f64,
        /// Last y, mm.
        to: f64,
        /// Length of the strip, mm.
        length: f64,
    },
    /// A folded or flat element.
    #[error(
        "element {element} (column {}, row {}, layer {}) near x = {:.4}, y = {:.4}, z = {:.4} mm is degenerate: \
         its scaled Jacobian is {scaled_jacobian:.3e}; smooth the outline or use finer elements",
        .place[0], .place[1], .place[2], .centre[0], .centre[1], .centre[2]
    )]
    Degenerate {
        /// Index of the element in `Mesh::hexes`.
        element: usize,
        /// Its place in the grid along x, y, z.
        place: [usize; 3],
        /// Its centre, mm.
        centre: [f64; 3],
        /// Its least scaled corner Jacobian.
        scaled_jacobian: f64,
    },
}
