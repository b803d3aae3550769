//! Records drawn anew: what the model says, and its misfit in blocks taken from all along the record.
//!
//! A block bootstrap of the misfit keeps noise that is correlated over a few points as it is; blocks are as long as the
//! correlation of neighbours asks for (Carlstein's rule for an autoregressive noise). Numbers follow from the seed and the
//! repeat alone.

use analysis::Identified;
use input::{Record, Test};
use model::Channel;

/// The tests of a fit with every channel's measured numbers replaced by prediction + redrawn misfit.
pub fn redrawn(fit: &Identified, seed: u64, repeat: usize) -> Vec<Test> {
    let mut tests = fit.model.case.tests.clone();
    let mut dice = Dice(seed ^ (repeat as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    for (block, slot) in fit.measured.data.blocks.iter().zip(&fit.measured.slots) {
        let predicted: Vec<f64> =
            fit.fit.prediction.values.rows(block.range.start, block.range.len()).iter().copied().collect();
        let misfit: Vec<f64> = block.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect();
        let drawn = dice.blocks(&misfit, block_length(misfit.len(), block.noise.ar1));
        let name = &fit.model.tests[slot.test].test.name;
        let Some(record) = tests.iter_mut().find(|t| t.name == *name).and_then(|t| t.record.as_mut()) else {
            continue;
        };
        for ((row, p), d) in slot.rows.iter().zip(&predicted).zip(&drawn) {
            set(record, slot.channel, *row, p + d);
        }
    }
    tests
}

fn set(record: &mut Record, channel: Channel, row: usize, value: f64) {
    let camera = match channel {
        Channel::Force => {
            record.force.get_mut(row).into_iter().for_each(|f| *f = value);
            return;
        }
        Channel::GripDisplacement => &mut record.grip_displacement,
        Channel::TearFront => &mut record.tear_front,
        Channel::WidthChange => &mut record.width_change,
        Channel::ForceX => &mut record.force_x,
    };
    camera.as_mut().and_then(|c| c.get_mut(row)).into_iter().for_each(|c| *c = Some(value));
}

/// Points of a block: (√6 ρ/(1 − ρ²))^⅔ n^⅓, at least 1.
fn block_length(points: usize, ar1: f64) -> usize {
    let ratio = 6f64.sqrt() * ar1.abs() / (1.0 - ar1 * ar1).max(1e-3);
    let length = ratio.powf(2.0 / 3.0) * (points as f64).cbrt();
    (length.round().max(1.0) as usize).min(points.max(1))
}

/// A stream of numbers (SplitMix64).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// As many numbers, in blocks that begin anywhere and go on at the front when they reach the end; their mean taken away.
    fn blocks(&mut self, from: &[f64], length: usize) -> Vec<f64> {
        let n = from.len();
        let mut out = Vec::with_capacity(n + length);
        while out.len() < n {
            let start = (self.next() % n as u64) as usize;
            out.extend((0..length).map(|k| from[(start + k) % n]));
        }
        out.truncate(n);
        let mean = from.iter().sum::<f64>() / n.max(1) as f64;
        out.iter_mut().for_each(|x| *x -= mean);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_pieces_of_what_was_there() {
        let from: Vec<f64> = (0..50).map(|k| f64::from(k) - 24.5).collect();
        let drawn = Dice(7).blocks(&from, 5);
        assert_eq!(drawn.len(), 50);
        for piece in drawn.chunks(5) {
            assert!(
                piece
                    .windows(2)
                    .all(|w| (w[1] - w[0] - 1.0).abs() < 1e-12 || (w[1] - w[0] + 49.0).abs() < 1e-12)
            );
        }
        assert_eq!(drawn, Dice(7).blocks(&from, 5), "the same seed, the same numbers");
        assert_ne!(drawn, Dice(8).blocks(&from, 5));
        assert!(Dice(7).blocks(&[], 3).is_empty());
    }

    #[test]
    fn blocks_grow_with_correlation() {
        assert_eq!(block_length(1000, 0.0), 1);
        assert!(block_length(1000, 0.9) > block_length(1000, 0.3) && block_length(3, 0.99) == 3);
    }
}
