//! Which key of the user's files a fault of the mesh is about, and where it stands.

use super::BuildError;
use input::{Case, locate};
use mesh::MeshError;

/// `file:line:column: error: `, or nothing for a case that no file gave.
pub(crate) fn at_key(case: &Case, section: &str, key: &str) -> String {
    match locate(case, section, key) {
        Some(place) if place.line > 0 => format!("{place}: error: "),
        Some(place) => format!("{}: error: ", place.file.display()),
        None => String::new(),
    }
}

impl BuildError {
    /// A fault of the mesh of a test, with the place of the key that is to be changed.
    pub(crate) fn mesh(case: &Case, test: &str, source: MeshError) -> Self {
        let (section, key) = key_of(case, &source);
        Self::Mesh { place: at_key(case, section, key), test: test.to_owned(), source }
    }
}

fn key_of(case: &Case, fault: &MeshError) -> (&'static str, &'static str) {
    let sizes = if case.mesh.divisions.is_some() { "divisions" } else { "path_size" };
    match fault {
        MeshError::Size { what, .. } => match *what {
            "length" | "width" | "thickness" => ("geometry", *what),
            "bulk_size" | "path_size" => ("mesh", *what),
            what if what.contains("outline") => ("geometry", "outline"),
            _ => ("geometry", "cut"),
        },
        MeshError::Cut(_) | MeshError::CutTooLong { .. } => ("geometry", "cut"),
        MeshError::PathOutside { .. } | MeshError::NotCentred { .. } => ("geometry", "path_y"),
        MeshError::NoDivisions { .. }
        | MeshError::TooFewDivisions { .. }
        | MeshError::OddDivisions(_)
        | MeshError::TooManyElements { .. }
        | MeshError::BulkFinerThanPath { .. } => ("mesh", sizes),
        MeshError::TooThin { .. } if case.mesh.divisions.is_some() => ("mesh", sizes),
        MeshError::TooThin { axis: 'y', .. } => ("geometry", "path_y"),
        MeshError::TooThin { .. } => ("geometry", "cut"),
        MeshError::Points { what, .. }
        | MeshError::NotIncreasing { what, .. }
        | MeshError::NotCovered { what, .. }
        | MeshError::NotSymmetric { what, .. }
            if what.contains("thickness") =>
        {
            ("geometry", "thickness_profile")
        }
        _ => ("geometry", "outline"),
    }
}
