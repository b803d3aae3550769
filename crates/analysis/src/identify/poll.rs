//! Along what a search looks around where its derivatives lead nowhere.

use inverse::{Free, Poll};
use params::{Owner, ParamPath};
use std::collections::BTreeMap;

/// Reduced χ² beyond which what is left may be a bent start, not what the model can do.
pub(crate) const FAR: f64 = 3.0;

/// Each parameter alone; those of all areas together, which move where a tear stands.
pub(crate) fn poll(free: &[Free]) -> Poll {
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (k, f) in free.iter().enumerate() {
        let together = match f.path.parse::<ParamPath>() {
            Ok(ParamPath { owner: Owner::Area(_), name }) => name,
            _ => f.path.clone(),
        };
        groups.entry(together).or_default().push(k);
    }
    Poll { groups: groups.into_values().collect(), ..Poll::each(FAR, 0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use params::Transform;

    #[test]
    fn areas_move_together() {
        let free = |path: &str| Free::new(path.to_owned(), (0.1, 10.0), Transform::Log, 1.0);
        let list = ["bulk.mu", "interface.area[1].gc", "interface.area[1].sigma_c", "interface.area[2].gc"];
        assert_eq!(poll(&list.map(free)).groups, [vec![0], vec![1, 3], vec![2]]);
    }
}
