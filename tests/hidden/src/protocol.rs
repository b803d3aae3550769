//! What the actuator does, and when the instruments are read.

use crate::draw::{about_one, between};
use crate::spec::Protocol;
use input::{Leg, Record};
use inverse::Random;

/// Sizes a protocol is made to.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Largest displacement of the intact strip, mm.
    pub uniaxial: f64,
    /// Displacement at which the tear is through, mm.
    pub tearing: f64,
}

/// Rows of a record, about.
const ROWS: f64 = 340.0;

/// Least rows of one leg: a corner needs neighbours to be seen.
const LEAST: usize = 14;

fn to(to_mm: f64, rate_mm_per_s: f64) -> Leg {
    Leg::Ramp { to_mm, rate_mm_per_s }
}

/// Legs of the intact strip's test.
pub fn uniaxial(protocol: Protocol, extent: &Extent, random: &mut Random) -> Vec<Leg> {
    let (u, slow) = (extent.uniaxial, 0.05 * about_one(random, 0.25));
    let mut legs = Vec::new();
    match protocol {
        Protocol::Paper => {
            for _ in 0..4 {
                legs.extend([to(u, slow), to(0.0, slow)]);
            }
        }
        Protocol::Rich => {
            let fast = slow * between(random, 6.0, 12.0);
            // A first cycle below the maximum: its continuation shows what the maximum changes.
            let low = u * between(random, 0.6, 0.75);
            legs.extend([
                to(low, slow),
                to(0.0, slow),
                to(u, slow),
                to(0.0, slow),
                to(u, fast),
                to(0.0, fast),
            ]);
            let (rest, hold) = (between(random, 20.0, 40.0), between(random, 60.0, 110.0));
            legs.extend([Leg::Hold { hold_s: rest }, to(u, slow), Leg::Hold { hold_s: hold }, to(0.0, slow)]);
        }
    }
    legs
}

/// Legs of the tearing test.
pub fn tearing(protocol: Protocol, extent: &Extent, random: &mut Random) -> Vec<Leg> {
    let slow = 0.05 * about_one(random, 0.25);
    let share = between(random, 0.25, 0.4);
    let mut at = |s: f64| extent.tearing * s * about_one(random, 0.06);
    let (a, b, c, d) = (at(0.24), at(0.4), at(0.56), at(0.74));
    let mut legs = Vec::new();
    match protocol {
        Protocol::Paper => {
            for top in [a, b, d] {
                legs.extend([to(top, slow), to(share * top, slow)]);
            }
        }
        Protocol::Rich => {
            let fast = slow * between(random, 6.0, 12.0);
            legs.extend([to(a, slow), to(share * a, slow), to(b, slow), to(share * b, slow), to(c, fast)]);
            legs.extend([Leg::Hold { hold_s: between(random, 60.0, 110.0) }, to(share * c, fast)]);
            legs.extend([to(d, slow), to(share * d, slow)]);
        }
    }
    legs.push(to(extent.tearing, slow));
    legs
}

/// A record's motion: rows spread over the legs by time and by travel, every corner a row. Rounded as
/// the file holds it, so that what is computed is what is written. Forces are zero as yet.
pub fn motion(legs: &[Leg]) -> Record {
    let corners = model::corners_of_protocol(legs);
    let total_time = corners.last().map_or(1.0, |c| c.time);
    let total_travel: f64 = corners.windows(2).map(|w| (w[1].displacement - w[0].displacement).abs()).sum();
    let (mut time, mut displacement) = (vec![0.0], vec![0.0]);
    for w in corners.windows(2) {
        let (dt, du) = (w[1].time - w[0].time, w[1].displacement - w[0].displacement);
        let share = 0.4 * dt / total_time + 0.6 * du.abs() / total_travel;
        let n = ((ROWS * share).round() as usize).max(LEAST);
        for i in 1..=n {
            let s = i as f64 / n as f64;
            time.push(rounded(w[0].time + s * dt, 1e4));
            displacement.push(rounded(w[0].displacement + s * du, 1e6));
        }
    }
    Record { force: vec![0.0; time.len()], time, displacement, ..Record::default() }
}

/// `x` to 1/`digits`.
pub fn rounded(x: f64, digits: f64) -> f64 {
    (x * digits).round() / digits
}
