//! Signs and offsets: what flags turn and take off, and what they might still do.

use crate::choices::{Choices, Flip};
use crate::error::short;
use crate::physics::range;
use crate::rows::Rows;

/// What may have to be changed, found and not applied.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Proposal {
    /// The flag (and its value) that does it; empty: nothing here can.
    pub flag: String,
    /// What was seen.
    pub why: String,
}

/// What was done to a test's rows, and what may have to be.
#[derive(Default)]
pub(crate) struct Settled {
    pub done: Vec<String>,
    pub proposals: Vec<Proposal>,
}

impl Settled {
    fn propose(&mut self, flag: &str, why: String) {
        self.proposals.push(Proposal { flag: flag.into(), why });
    }
}

/// Turns signs and takes offsets off, as the flags say; then looks for what they might still do. `noise`: of the force, one
/// standard deviation of a row, N.
///
/// Of a second axis `--flip` alone (or for both) turns what runs to negative values; offsets go with those along y.
pub(crate) fn settle(rows: &mut Rows, choices: &Choices, noise: f64) -> Settled {
    let mut out = Settled::default();
    if rows.is_empty() {
        return out;
    }
    let flip = choices.flip;
    let told = |own: Flip| {
        move |seen: bool| flip == Some(own) || flip == Some(Flip::Both) || seen && flip == Some(Flip::Found)
    };
    sign(&mut rows.displacement, "displacement", "--flip displacement", told(Flip::Displacement), &mut out);
    sign(&mut rows.force, "force", "--flip force", told(Flip::Force), &mut out);
    let still = before_the_motion(&rows.displacement);
    let left = offsets(&mut rows.displacement, &mut rows.force, still, noise, "", choices, &mut out);
    slack(rows, still, left, noise, &mut out);
    if let [Some(displacement), Some(force)] = &mut rows.across {
        let told = move |seen: bool| seen && matches!(flip, Some(Flip::Found | Flip::Both));
        sign(displacement, "displacement along x", "--flip", told, &mut out);
        sign(force, "force along x", "--flip", told, &mut out);
        let noise = crate::noise::sd(force);
        offsets(displacement, force, still, noise, " along x", choices, &mut out);
    }
    out
}

/// Turns a channel where the user said so (`told`, by whether it runs to negative values); else says that it may have to be.
fn sign(channel: &mut [f64], word: &str, flag: &str, told: impl Fn(bool) -> bool, out: &mut Settled) {
    let negative = is_negative(channel);
    if told(negative) {
        channel.iter_mut().for_each(|x| *x = -*x + 0.0);
        out.done.push(format!("sign of the {word} turned (--flip)"));
    } else if negative {
        let why =
            format!("the {word} runs to negative values; expected tension and lengthening to be positive");
        out.propose(flag, why);
    }
}

/// Rows before the actuator moves, at least one.
fn before_the_motion(displacement: &[f64]) -> usize {
    let close = 2e-3 * range(displacement);
    displacement.iter().take_while(|x| (*x - displacement[0]).abs() <= close).count().max(1)
}

/// Takes the first displacement and the force before the motion off, or says that they may have to be; returns the force
/// before the motion that stays. `still`: rows before the motion; `axis`: how messages end a channel's name.
fn offsets(
    displacement: &mut [f64],
    force: &mut [f64],
    still: usize,
    noise: f64,
    axis: &str,
    choices: &Choices,
    out: &mut Settled,
) -> f64 {
    let (start, u_range, f_range) = (displacement[0], range(displacement), range(force));
    let at_rest = &force[..still.min(force.len())];
    let (count, before) = (at_rest.len() as f64, at_rest.iter().sum::<f64>() / at_rest.len() as f64);
    if choices.zero {
        displacement.iter_mut().for_each(|x| *x -= start);
        out.done.push(format!("{} mm taken off the displacement{axis} (--zero)", short(start)));
    } else if start.abs() > 1e-3 * u_range {
        let why = format!("the displacement{axis} starts at {} mm; a record starts at 0", short(start));
        out.propose("--zero", why);
    }
    if choices.tare {
        force.iter_mut().for_each(|x| *x -= before);
        out.done.push(format!("{} N taken off the force{axis} (--tare)", short(before)));
        return 0.0;
    }
    if before.abs() > (0.01 * f_range).max(4.0 * noise / count.sqrt()) {
        let why = format!(
            "the force{axis} before the motion is {} N: a pre-load, which is information, or a cell that was not zeroed, \
             which --tare takes off",
            short(before)
        );
        out.propose("--tare", why);
    }
    before
}

/// Says where a strip moves far before it carries more than `left`, the force before the motion.
fn slack(rows: &Rows, still: usize, left: f64, noise: f64, out: &mut Settled) {
    let quiet = (0.01 * range(&rows.force)).max(3.0 * noise);
    let slack = rows.force.iter().take_while(|x| (*x - left).abs() < quiet).count();
    if slack <= still || slack >= rows.len() {
        return;
    }
    let moved = (rows.displacement[slack] - rows.displacement[0]).abs();
    if moved > 0.15 * range(&rows.displacement) {
        let why = format!(
            "no force over the first {} mm: slack, or a soft toe; the effect `slack` has it as a parameter",
            short(moved)
        );
        out.propose("", why);
    }
}

/// Whether a channel runs from its start mostly to the negative side.
fn is_negative(x: &[f64]) -> bool {
    let first = x.first().copied().unwrap_or(0.0);
    let (low, high) = x.iter().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v - first), h.max(v - first)));
    -low > 1.5 * high
}
