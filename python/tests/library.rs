//! The library that Python loads, made by the tests' command without Python.

/// What Python looks for in a module named `fct._fct`.
const ENTRY: &[u8] = b"PyInit__fct";

#[test]
fn the_library_has_the_entry_that_python_looks_for() {
    let test = std::env::current_exe().expect("this test");
    let folder = test.parent().expect("the folder of what tests depend on");
    let file = folder.join(format!("{}_fct{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX));
    let library = std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    assert!(library.windows(ENTRY.len()).any(|w| w == ENTRY), "{}", file.display());
}
