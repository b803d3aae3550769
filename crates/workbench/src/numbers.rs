//! Tables of a run, as the page takes them.

use report::StoredRun;
use serde_json::{Map, Value, json};

/// Derivatives of the force at the record's points: `{ "paths": [bulk.mu, …], "tests": { tearing: [[∂F/∂μ, …], …] } }`, one
/// list per parameter and test; units as in `jacobian.csv` (N per internal unit). `null` where the run has none.
pub fn jacobian(run: &StoredRun) -> Value {
    let Ok(content) = run.file("jacobian.csv") else { return Value::Null };
    read(&content, 3).unwrap_or(Value::Null)
}

/// What each effect of the screen would add to the forces, N, in the same form; `null` before a diagnosis.
pub fn adds(run: &StoredRun) -> Value {
    let Ok(content) = run.file("adds.csv") else { return Value::Null };
    read(&content, 2).unwrap_or(Value::Null)
}

/// A table whose first column is the test, with the numbers behind its first `skip` columns.
fn read(content: &[u8], skip: usize) -> Option<Value> {
    let mut reader = csv::Reader::from_reader(content);
    let paths: Vec<String> = reader.headers().ok()?.iter().skip(skip).map(str::to_owned).collect();
    let mut tests: Map<String, Value> = Map::new();
    for row in reader.records() {
        let row = row.ok()?;
        // Camera channels are blocks `test.channel`; a test's name has no dot.
        let block = row.get(0).filter(|b| !b.contains('.'));
        let Some(block) = block else { continue };
        let columns = tests.entry(block).or_insert_with(|| vec![json!([]); paths.len()].into());
        for (column, cell) in columns.as_array_mut()?.iter_mut().zip(row.iter().skip(skip)) {
            column.as_array_mut()?.push(short(cell.parse().ok()?));
        }
    }
    Some(json!({ "paths": paths, "tests": tests }))
}

/// Six significant digits: more than a slider needs, and half the bytes.
pub fn short(x: f64) -> Value {
    if !x.is_finite() {
        return Value::Null;
    }
    json!(format!("{x:.5e}").parse().unwrap_or(x))
}

/// The same for a list.
pub fn list(x: &[f64]) -> Value {
    Value::Array(x.iter().map(|v| short(*v)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_read_and_cameras_are_not() {
        let csv = b"block,row,prediction,bulk.mu,\"interface.area[1].gc\"\ntear,0,0.1,1.0,2\ntear,1,0.2,3,4e-9\ntear.grip,0,1,7,8\n";
        let read = read(csv, 3).unwrap_or_default();
        assert_eq!(read["paths"], json!(["bulk.mu", "interface.area[1].gc"]));
        assert_eq!(read["tests"], json!({ "tear": [[1.0, 3.0], [2.0, 4e-9]] }));
        assert_eq!(super::read(b"block,row,prediction,a\nx,0,0,what\n", 3), None);
    }
}
