//! The last net: a panic is a fault of this program, told as such, never a backtrace.

use crate::outcome::Failure;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::Mutex;

/// What the first panic said, and where.
static TOLD: Mutex<Option<String>> = Mutex::new(None);

/// Keeps what a panic says for [`guarded`], instead of printing it.
pub fn panics_are_told() {
    std::panic::set_hook(Box::new(|info| {
        let said = info.payload();
        let said = said.downcast_ref::<&str>().copied().or(said.downcast_ref::<String>().map(String::as_str));
        let said = said.unwrap_or("no reason given");
        let place = info.location().map_or(String::new(), |l| format!(" at {}:{}", l.file(), l.line()));
        let mut told = TOLD.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        told.get_or_insert(format!("{said}{place}"));
    }));
}

/// Runs the program; a panic becomes exit code 1 with what it said.
pub fn guarded(json: bool, run: impl FnOnce() -> ExitCode) -> ExitCode {
    caught(run).unwrap_or_else(|fault| fault.tell(json))
}

/// Runs something; a panic becomes a failure with what it said.
///
/// # Errors
/// If it panics.
pub fn caught<T>(run: impl FnOnce() -> T) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(run)).map_err(|_| {
        let told = TOLD.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take();
        let said = told.unwrap_or_else(|| "no reason given".into());
        Failure::compute(format!(
            "fct: this is a fault of fct itself ({said}); nothing that was there before was changed. Please report it \
             with the input files"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_exit_code() {
        let code = guarded(false, || panic!("made by the test"));
        assert_eq!(format!("{code:?}"), format!("{:?}", ExitCode::from(1)));
    }
}
