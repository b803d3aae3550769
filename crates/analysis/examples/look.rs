//! The first look at the records of a case: `cargo run --release -p analysis --example look -- FILE…`
use std::path::Path;
use std::time::Instant;

fn main() {
    let catalogue = effects::catalogue();
    for path in std::env::args().skip(1) {
        let begun = Instant::now();
        let look =
            input::read_case(Path::new(&path), &catalogue).map_err(|e| e.to_string()).and_then(|case| {
                analysis::first_look(&case.into(), &catalogue, &|| false).map_err(|e| e.to_string())
            });
        println!("{path}, {:.1} s: {}", begun.elapsed().as_secs_f64(), look.unwrap_or_else(|e| e));
    }
}
