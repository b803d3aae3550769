//! The elimination order.

use std::collections::BTreeSet;

use mesh::{Mesh, Sizing, Strip, nested_dissection, strip};

fn mesh(divisions: [usize; 3], tear: bool) -> Mesh {
    let sizing = Sizing::Divisions(divisions);
    strip(&Strip { cut: 1.0, tear, sizing, ..Strip::new(10.0, 4.0, 1.0) }).unwrap()
}

#[test]
fn it_is_a_permutation_and_keeps_columns_together() {
    for (divisions, tear) in [([8, 20, 2], true), ([8, 20, 2], false), ([2, 2, 1], true), ([40, 3, 1], false)]
    {
        let mesh = mesh(divisions, tear);
        let order = nested_dissection(&mesh);
        let distinct: BTreeSet<usize> = order.iter().copied().collect();
        assert_eq!(distinct.len(), mesh.nodes.len());
        assert_eq!(order.len(), mesh.nodes.len());
        assert!(order.iter().all(|&node| node < mesh.nodes.len()));
        let mut columns: Vec<[usize; 2]> = order.iter().map(|&node| mesh.columns[node]).collect();
        columns.dedup();
        assert_eq!(columns.len(), mesh.grid[0] * mesh.grid[1]);
        for (lower, upper) in mesh.interfaces.iter().flat_map(|q| q.lower.into_iter().zip(q.upper.unwrap())) {
            let at = order.iter().position(|&node| node == lower).unwrap();
            assert_eq!(order[at + 1], upper);
        }
    }
}

/// Entries below the diagonal of the factor, counted in columns of the grid.
fn fill(mesh: &Mesh, order: &[usize]) -> usize {
    let [nx, ny, _] = mesh.grid;
    let mut columns: Vec<[usize; 2]> = order.iter().map(|&node| mesh.columns[node]).collect();
    columns.dedup();
    let mut rank = vec![0; nx * ny];
    columns.iter().enumerate().for_each(|(at, [i, j])| rank[j * nx + i] = at);
    let mut later: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); nx * ny];
    for hex in &mesh.hexes {
        let corners = hex.map(|node| rank[mesh.columns[node][1] * nx + mesh.columns[node][0]]);
        for a in corners {
            later[a].extend(corners.iter().filter(|&&b| b > a));
        }
    }
    let mut count = 0;
    for at in 0..later.len() {
        let below = std::mem::take(&mut later[at]);
        count += below.len();
        if let Some(&parent) = below.first() {
            later[parent].extend(below.into_iter().skip(1));
        }
    }
    count
}

#[test]
fn it_fills_less_than_the_natural_order() {
    let mesh = mesh([60, 120, 1], false);
    let natural: Vec<usize> = (0..mesh.nodes.len()).collect();
    let (dissected, natural) = (fill(&mesh, &nested_dissection(&mesh)), fill(&mesh, &natural));
    assert!(2 * dissected < natural, "{dissected} against {natural}");
}
