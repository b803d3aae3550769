//! From internal units back to a file's, so that reading gives the same number to the last bit.

use crate::config::Value;
use crate::keys::units;
use params::{Quantity, Suffix};

/// A key for `name` and the numbers in its unit: a unit in which every number survives the way back, the
/// preferred one unless the numbers are unwieldy in it; at worst the internal one.
pub(crate) fn spell(quantity: Quantity, name: &str, values: &[f64]) -> (String, Vec<f64>) {
    let units = units(quantity, name);
    let exact = |s: &Suffix| {
        let factor = s.factor;
        let numbers =
            values.iter().map(|&v| before(v, v / factor, |x| x * factor)).collect::<Option<Vec<_>>>()?;
        Some((format!("{name}_{}", s.name), numbers))
    };
    let spelled: Vec<_> = units.iter().filter_map(exact).collect();
    if let Some(best) = spelled.iter().find(|s| handy(&s.1)).or(spelled.first()) {
        return best.clone();
    }
    match units.iter().find(|s| s.factor == 1.0) {
        Some(suffix) => (format!("{name}_{}", suffix.name), values.to_vec()),
        None => (name.to_owned(), values.to_vec()),
    }
}

/// Whether the largest number is neither very large nor very small.
fn handy(numbers: &[f64]) -> bool {
    let largest = numbers.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    largest == 0.0 || (1e-3..1e5).contains(&largest)
}

/// A parameter x as `numerator`/x (the bulk modulus of a D), if that survives the way back.
pub(crate) fn spell_reciprocal(d: &Value, numerator: f64) -> Option<Value> {
    let modulus = |x: Option<f64>| match x {
        None => Some(None),
        Some(d) => before(d, numerator / d, |k| numerator / k).map(Some),
    };
    Some(Value { value: modulus(d.value)?, min: modulus(d.max)?, max: modulus(d.min)?, fixed: d.fixed })
}

/// The number near `guess` with the fewest digits that `back` turns into exactly `target`.
fn before(target: f64, guess: f64, back: impl Fn(f64) -> f64) -> Option<f64> {
    let rounded = (1..17).filter_map(|digits| format!("{guess:.digits$e}").parse::<f64>().ok());
    let mut near = vec![guess];
    let (mut up, mut down) = (guess, guess);
    for _ in 0..3 {
        (up, down) = (up.next_up(), down.next_down());
        near.extend([up, down]);
    }
    rounded.chain(near).find(|&x| back(x) == target)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_number_in_a_files_unit_comes_back_as_it_was_written() {
        let (key, numbers) = spell(Quantity::Stress, "mu", &[5.1 * 1e-3]);
        assert_eq!((key.as_str(), numbers[0]), ("mu_kPa", 5.1));
        let gamma = 38.53 * (std::f64::consts::PI / 180.0);
        assert_eq!(spell(Quantity::Angle, "gamma", &[gamma]), ("gamma_deg".to_owned(), vec![38.53]));
        let modulus = spell_reciprocal(&Value::new(2.0 / 20.0), 2.0);
        assert_eq!(modulus, Some(Value::new(20.0)));
    }

    proptest! {
        #[test]
        fn every_number_survives(x in prop_oneof![1e-9f64..1e-3, 1e-3..1.0, 1.0..1e6]) {
            for q in [Quantity::Stress, Quantity::Angle, Quantity::Time, Quantity::Density, Quantity::Speed] {
                let (key, numbers) = spell(q, "x", &[x, 2.0 * x]);
                let suffix = q.parse_key("x", &key).unwrap();
                prop_assert_eq!(numbers[0] * suffix.factor, x);
                prop_assert_eq!(numbers[1] * suffix.factor, 2.0 * x);
            }
        }
    }
}
