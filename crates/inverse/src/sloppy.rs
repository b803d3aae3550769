//! Sloppy directions in words.
//!
//! A singular value s of the scaled jacobian says that a move of 1/s natural scales along its direction
//! raises χ² by 1 (Transtrum, Machta & Sethna, Phys. Rev. E 83, 036701, 2011). Where 1/s exceeds the
//! rule's `max_sd`, the record does not fix that combination.

use crate::Uncertainty;
use params::Transform;

/// Components below this share of the largest are not named.
const NAMED: f64 = 0.3;

/// Parameters named in one sentence.
const MOST_NAMED: usize = 3;

impl Uncertainty {
    /// Which columns of `directions` the record does not fix, stiffest first.
    pub fn sloppy_columns(&self) -> Vec<usize> {
        (0..self.singular_values.len())
            .filter(|&k| self.singular_values[k] * self.rule.max_sd < 1.0)
            .collect()
    }

    /// One sentence per direction that the record does not fix: the leading parameters, how they move
    /// together, and by how much at Δχ² = 1.
    pub fn sloppy_directions(&self) -> Vec<String> {
        self.sloppy_columns().into_iter().map(|k| self.sentence(k)).collect()
    }

    fn sentence(&self, column: usize) -> String {
        let v = self.directions.column(column);
        let largest = v.amax();
        let mut leading: Vec<usize> = (0..v.len()).filter(|&k| v[k].abs() >= NAMED * largest).collect();
        leading.sort_by(|&a, &b| v[b].abs().total_cmp(&v[a].abs()).then(a.cmp(&b)));
        let Some(&first) = leading.first() else {
            return String::from("No parameter takes part in this direction.");
        };
        let sign = v[first].signum();
        let length = 1.0 / self.singular_values[column].max(1e-300);
        let moves: Vec<String> = leading
            .iter()
            .map(|&k| format!("{} {}", self.free[k].path, self.percentage(k, sign * v[k] * length)))
            .collect();
        if let [only] = moves.as_slice() {
            return format!("The record hardly fixes {}: {only} raises χ² by only 1.", self.free[first].path);
        }
        if leading.len() > MOST_NAMED {
            return format!(
                "The record hardly fixes {} parameters against each other: {} and {} smaller changes together \
                 raise χ² by only 1.",
                leading.len(),
                moves[..MOST_NAMED].join(", "),
                leading.len() - MOST_NAMED
            );
        }
        let combination = combination(&leading, |k| (self.free[k].path.as_str(), sign * v[k]));
        let kept = self.kept_pair(&leading, &v.into_owned());
        format!(
            "The record hardly fixes {combination}{kept}: {} together raise χ² by only 1.",
            moves.join(", ")
        )
    }

    /// For a pair of logarithms, what the record does fix: the product or the ratio.
    fn kept_pair(&self, leading: &[usize], v: &nalgebra::DVector<f64>) -> String {
        let [a, b] = *leading else { return String::new() };
        if self.free[a].transform != Transform::Log || self.free[b].transform != Transform::Log {
            return String::new();
        }
        let ratio = (v[b] / v[a]).abs();
        if !(0.7..1.43).contains(&ratio) {
            return String::new();
        }
        let (p, q) = (&self.free[a].path, &self.free[b].path);
        if v[a] * v[b] < 0.0 { format!(", only {p} · {q}") } else { format!(", only {p} / {q}") }
    }

    /// The change of parameter k for a move of `dz` natural scales, in words.
    fn percentage(&self, k: usize, scaled: f64) -> String {
        let f = &self.free[k];
        let x = self.theta[k];
        match f.transform {
            Transform::Log => {
                let factor = scaled.abs().exp();
                if factor > 10.0 {
                    let word = if scaled > 0.0 { "up" } else { "down" };
                    format!("{word} more than 10-fold")
                } else {
                    format!("{:+.0} %", 100.0 * (scaled.exp() - 1.0))
                }
            }
            _ => {
                let to = f.backward(f.forward(x) + scaled * self.scales[k]);
                let change = to - x;
                if f.at_bound(to) {
                    "as far as its bound".into()
                } else if x != 0.0 && (change / x).abs() < 10.0 {
                    format!("{:+.0} %", 100.0 * change / x)
                } else {
                    format!("{change:+.3}")
                }
            }
        }
    }
}

/// `a · b / c` from signed weights.
fn combination<'a>(leading: &[usize], weight: impl Fn(usize) -> (&'a str, f64)) -> String {
    let mut text = String::new();
    for (n, &k) in leading.iter().enumerate() {
        let (name, w) = weight(k);
        if n > 0 {
            text.push_str(if w > 0.0 { " · " } else { " / " });
        }
        text.push_str(name);
    }
    text
}
