//! The size of a mesh before there is one: nodes and elements from the node lines, and what a factorisation in the order
//! of [`nested_dissection`](crate::nested_dissection) fills.

use std::collections::HashMap;

use crate::lines::Lines;
use crate::ordering::LEAF;
use crate::{MeshError, Strip};

/// How large a mesh would be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count {
    /// Elements along x, y, z of the meshed part.
    pub elements: [usize; 3],
    /// Elements along the tear path, ahead of the cut.
    pub ahead: usize,
    /// Nodes, those on both sides of the tear path included.
    pub nodes: usize,
    /// What a factor of three unknowns per node holds.
    pub fill: Fill,
}

/// What a factorisation holds and costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fill {
    /// Stored entries.
    pub entries: f64,
    /// Multiplications and additions: the sum over the columns of their length squared.
    pub flops: f64,
    /// Rows of the largest front.
    pub front: f64,
}

impl Fill {
    fn add(self, other: Self) -> Self {
        Self {
            entries: self.entries + other.entries,
            flops: self.flops + other.flops,
            front: self.front.max(other.front),
        }
    }

    /// One supernode: so many columns of the matrix, and so many rows below them.
    fn front(columns: f64, below: f64) -> Self {
        let rows = columns + below;
        let cubes = |x: f64| x * x * x;
        Self { entries: rows * columns, flops: (cubes(rows) - cubes(below)) / 3.0, front: rows }
    }
}

/// Counts without meshing.
///
/// # Errors
/// As [`strip`](crate::strip), degenerate elements apart.
pub fn count(strip: &Strip) -> Result<Count, MeshError> {
    strip.validate()?;
    let lines = Lines::new(strip)?;
    let n = [lines.x.len(), lines.y.len(), lines.z.len()];
    let doubled = usize::from(strip.tear && !strip.half_height);
    Ok(Count {
        elements: n.map(|n| n - 1),
        ahead: n[0] - 1 - lines.tip,
        nodes: n.into_iter().product::<usize>() + doubled * n[0] * n[2],
        fill: fill([n[0], n[1] + doubled], 3 * n[2]),
    })
}

/// What nested dissection of a grid of columns fills, each of so many unknowns.
pub fn fill(columns: [usize; 2], unknowns: usize) -> Fill {
    dissected(columns, [false; 4], unknowns as f64, &mut HashMap::new())
}

type Known = HashMap<([usize; 2], [bool; 4]), Fill>;

/// A part of the grid, with what lies already eliminated-last beside it: left, right, below, above.
fn dissected([w, h]: [usize; 2], beside: [bool; 4], unknowns: f64, known: &mut Known) -> Fill {
    if w == 0 || h == 0 {
        return Fill::default();
    }
    if let Some(&fill) = known.get(&([w, h], beside)) {
        return fill;
    }
    let [left, right, below, above] = beside;
    let sides = [left, right].into_iter().filter(|s| *s).count() * h
        + [below, above].into_iter().filter(|s| *s).count() * w;
    let front = |columns: usize| Fill::front(columns as f64 * unknowns, sides as f64 * unknowns);
    let fill = if w * h <= LEAF {
        front(w * h)
    } else if w >= h {
        let middle = w / 2;
        dissected([middle, h], [left, true, below, above], unknowns, known)
            .add(dissected([w - middle - 1, h], [true, right, below, above], unknowns, known))
            .add(front(h))
    } else {
        let middle = h / 2;
        dissected([w, middle], [left, right, below, true], unknowns, known)
            .add(dissected([w, h - middle - 1], [left, right, true, above], unknowns, known))
            .add(front(w))
    };
    known.insert(([w, h], beside), fill);
    fill
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sizing;

    #[test]
    fn what_is_counted_is_what_is_meshed() {
        for (tear, half, cut) in [(true, true, 1.0), (true, false, 1.0), (false, false, 0.0)] {
            for sizing in [Sizing::Divisions([9, 14, 3]), Sizing::default()] {
                let strip = Strip {
                    tear,
                    cut,
                    half_height: half,
                    half_thickness: half,
                    sizing,
                    ..Strip::new(10.0, 4.0, 1.0)
                };
                let (mesh, count) = (crate::strip(&strip).unwrap(), count(&strip).unwrap());
                assert_eq!(mesh.hexes.len(), count.elements.iter().product::<usize>());
                assert_eq!(mesh.nodes.len(), count.nodes);
                let [nx, ny, nz] = count.elements.map(|n| n + 1);
                assert_eq!(count.fill, fill([nx, ny + usize::from(tear && !half)], 3 * nz));
                if tear {
                    assert_eq!(mesh.interfaces.len(), count.ahead * count.elements[2]);
                }
            }
        }
    }

    /// Fronts written out by hand: columns of 3 unknowns, parts of up to four columns in one front. A front of c columns with
    /// b rows below holds c (c + b) entries and takes ((c + b)³ − b³)/3.
    #[test]
    fn a_small_grid_fills_what_its_fronts_hold() {
        let filled = |grid, entries: f64, flops: f64, front: f64| {
            assert_eq!(fill(grid, 3), Fill { entries, flops, front }, "{grid:?}");
        };
        filled([1, 4], 144.0, 576.0, 12.0);
        // Two parts, of 12 and 6 columns with the 6 of the separator below, and these.
        filled([2, 4], 216.0 + 72.0 + 36.0, 1872.0 + 504.0 + 72.0, 18.0);
        filled([4, 2], 216.0 + 72.0 + 36.0, 1872.0 + 504.0 + 72.0, 18.0);
        filled([5, 2], 2.0 * 216.0 + 36.0, 2.0 * 1872.0 + 72.0, 18.0);
        // Parted twice: each half is a part that sees one separator, one that sees two, and its own separator.
        let half = (54.0 + 72.0 + 18.0, 234.0 + 504.0 + 63.0);
        filled([1, 11], 2.0 * half.0 + 9.0, 2.0 * half.1 + 9.0, 12.0);
        filled([11, 1], 2.0 * half.0 + 9.0, 2.0 * half.1 + 9.0, 12.0);
    }
}
