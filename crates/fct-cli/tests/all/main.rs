//! All tests of `fct-cli` from outside, in one program: each of its own would be linked anew.

#[path = "common/accessible.rs"]
mod accessible;
mod answers;
mod bad_input;
mod beam;
#[path = "common/bench.rs"]
mod bench;
mod bent_base;
mod biaxial_protocols;
mod browser;
mod campaign;
mod command_lines;
mod common;
mod damaged;
#[path = "common/browser.rs"]
mod driver;
mod experiments;
mod honesty;
mod hostile;
#[path = "common/hostile_files.rs"]
mod hostile_files;
mod identify;
mod import;
mod killed;
mod laws;
mod newcomers;
mod reference;
mod safety;
mod simulate;
mod terminal;
mod too_large;
mod tutorial;
#[path = "common/watched.rs"]
mod watched;
mod weights;
mod workbench_browser;
mod workbench_figures;
mod workbench_kept;
mod workbench_practice;
