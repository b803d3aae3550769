//! VTK XML: unstructured grids with numbers in base64, and their collections over time.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// Kind of the cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cells {
    /// Eight nodes.
    #[default]
    Hexahedra,
    /// Four nodes.
    Quads,
}

/// Name, components, numbers.
pub type Field = (&'static str, usize, Vec<f64>);

/// Positions, cells, numbers.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// Kind of all cells.
    pub shape: Cells,
    /// Reference positions, mm.
    pub points: Vec<[f64; 3]>,
    /// Nodes of each cell.
    pub cells: Vec<Vec<usize>>,
    /// Fields on points.
    pub point_data: Vec<Field>,
    /// Fields on cells.
    pub cell_data: Vec<Field>,
}

impl Grid {
    /// The numbers of a point field.
    pub fn point_field(&self, name: &str) -> &[f64] {
        self.point_data.iter().find(|f| f.0 == name).map_or(&[], |f| &f.2)
    }

    /// The numbers of a cell field.
    pub fn cell_field(&self, name: &str) -> &[f64] {
        self.cell_data.iter().find(|f| f.0 == name).map_or(&[], |f| &f.2)
    }

    /// The file.
    pub fn vtu(&self) -> String {
        let mut out = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n<UnstructuredGrid>\n",
        );
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
            self.points.len(),
            self.cells.len()
        );
        out.push_str("<Points>\n");
        let flat: Vec<f64> = self.points.iter().flatten().copied().collect();
        floats(&mut out, "position", 3, &flat);
        out.push_str("</Points>\n<Cells>\n");
        let connectivity = self.cells.iter().flatten().flat_map(|n| (*n as i64).to_le_bytes());
        array(&mut out, "Int64", "connectivity", 1, connectivity);
        let mut end = 0i64;
        let offsets = self.cells.iter().flat_map(|c| {
            end += c.len() as i64;
            end.to_le_bytes()
        });
        array(&mut out, "Int64", "offsets", 1, offsets);
        let code = match self.shape {
            Cells::Hexahedra => 12u8,
            Cells::Quads => 9,
        };
        array(&mut out, "UInt8", "types", 1, self.cells.iter().map(|_| code));
        out.push_str("</Cells>\n");
        for (tag, fields) in [("PointData", &self.point_data), ("CellData", &self.cell_data)] {
            let _ = writeln!(out, "<{tag}>");
            for (name, components, numbers) in fields {
                floats(&mut out, name, *components, numbers);
            }
            let _ = writeln!(out, "</{tag}>");
        }
        out.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        out
    }
}

fn floats(out: &mut String, name: &str, components: usize, numbers: &[f64]) {
    array(out, "Float32", name, components, numbers.iter().flat_map(|x| (*x as f32).to_le_bytes()));
}

/// A data array: its length in bytes, then the bytes, in base64.
fn array(out: &mut String, kind: &str, name: &str, components: usize, bytes: impl Iterator<Item = u8>) {
    let data: Vec<u8> = bytes.collect();
    let mut all = (data.len() as u64).to_le_bytes().to_vec();
    all.extend(data);
    let _ = writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">{}</DataArray>",
        STANDARD.encode(all)
    );
}

/// A `.pvd` file: (time, part, file).
pub fn collection(entries: &[(usize, usize, String)]) -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n",
    );
    for (time, part, file) in entries {
        let file = file.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        let _ = writeln!(out, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>");
    }
    out.push_str("</Collection>\n</VTKFile>\n");
    out
}
