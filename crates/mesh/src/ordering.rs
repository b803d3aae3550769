//! Geometric nested dissection: an elimination order with little fill.

use std::ops::Range;

use crate::Mesh;

/// Columns left undivided.
pub(crate) const LEAF: usize = 4;

/// Nodes in the order of elimination: recursive bisection of the (i, j) column grid, separators last.
///
/// All nodes of a column, both sides of a doubled tear path among them, stay together, pairs next to each other, so
/// that pivots stay inside a supernode. Three unknowns per node follow by repeating each node three times.
pub fn nested_dissection(mesh: &Mesh) -> Vec<usize> {
    let [nx, ny, _] = mesh.grid;
    let mut columns = Vec::with_capacity(nx * ny);
    dissect(0..nx, 0..ny, &mut columns);
    let mut rank = vec![0; nx * ny];
    for (place, [i, j]) in columns.into_iter().enumerate() {
        rank[j * nx + i] = place;
    }
    let mut order: Vec<usize> = (0..mesh.nodes.len()).collect();
    order.sort_by(|&a, &b| {
        let of = |node: usize| rank[mesh.columns[node][1] * nx + mesh.columns[node][0]];
        let by_height = || mesh.nodes[a][2].total_cmp(&mesh.nodes[b][2]);
        // The sort is stable: of a pair at one place, the lower side comes first.
        of(a).cmp(&of(b)).then_with(by_height)
    });
    order
}

fn dissect(i: Range<usize>, j: Range<usize>, order: &mut Vec<[usize; 2]>) {
    if i.len() * j.len() <= LEAF {
        order.extend(j.flat_map(|j| i.clone().map(move |i| [i, j])));
    } else if i.len() >= j.len() {
        let middle = i.start + i.len() / 2;
        dissect(i.start..middle, j.clone(), order);
        dissect(middle + 1..i.end, j.clone(), order);
        order.extend(j.map(|j| [middle, j]));
    } else {
        let middle = j.start + j.len() / 2;
        dissect(i.clone(), j.start..middle, order);
        dissect(i.clone(), middle + 1..j.end, order);
        order.extend(i.map(|i| [i, middle]));
    }
}
