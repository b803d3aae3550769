//! Short lists of parameters or history entries, on the stack.

use constitutive::Scalar;

/// Parameters or history variables of an inner law that a call without jets has room for.
pub(crate) const MOST: usize = 64;

/// The values, if none has a derivative and there is room for them.
pub(crate) fn constants<S: Scalar>(all: &[S]) -> Option<[f64; MOST]> {
    let mut out = [0.0; MOST];
    if all.len() > MOST || !all.iter().all(S::is_constant) {
        return None;
    }
    out.iter_mut().zip(all).for_each(|(to, x)| *to = x.value());
    Some(out)
}

/// Longest parameter list that is changed on the stack.
const SMALL: usize = 48;

/// Calls `f` with a copy of `params` in which `change` has altered some entries.
#[inline]
pub fn with_changed<S: Scalar, R>(
    params: &[S],
    change: impl FnOnce(&mut [S]),
    f: impl FnOnce(&[S]) -> R,
) -> R {
    if params.len() <= SMALL {
        let mut copy = [S::zero(); SMALL];
        copy[..params.len()].copy_from_slice(params);
        change(&mut copy[..params.len()]);
        f(&copy[..params.len()])
    } else {
        let mut copy = params.to_vec();
        change(&mut copy);
        f(&copy)
    }
}
