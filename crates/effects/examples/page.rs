//! Prints the catalogue as a Markdown page: `cargo run -p effects --example page > docs/catalogue.md`.

fn main() {
    print!("{}", effects::card_text::markdown(&effects::catalogue()));
}
