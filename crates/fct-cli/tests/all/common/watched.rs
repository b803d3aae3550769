//! Running the binary under watch: an exit code of ours, in time, in little memory, without a panic.
#![allow(dead_code)]

use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time of a command.
pub const LONGEST: Duration = Duration::from_secs(60);
/// Address space that a command may have, kB: more than 2 GB of memory cannot be had.
pub const MEMORY: u32 = 2_000_000;

/// How a command ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; `None`: a signal.
    pub code: Option<i32>,
    /// What it said.
    pub stderr: String,
    /// How long it took.
    pub took: Duration,
}

impl Ended {
    /// What is wrong with an end, if anything.
    pub fn fault(&self) -> Option<String> {
        let tail: String = self.stderr.chars().take(400).collect();
        match self.code {
            _ if self.took > LONGEST => Some(format!("took more than {LONGEST:?}")),
            _ if self.stderr.contains("panicked") => Some(format!("panicked: {tail}")),
            Some(0) => None,
            Some(1 | 2) if !self.stderr.trim().is_empty() => None,
            Some(1 | 2) => Some("failed and said nothing".to_owned()),
            code => Some(format!("ended with {code:?}: {tail}")),
        }
    }
}

/// Runs `fct` in a folder with 2 GB of address space; what is no end after a minute is killed.
pub fn watched<S: AsRef<OsStr>>(folder: &Path, arguments: &[S]) -> std::io::Result<Ended> {
    let begun = Instant::now();
    let script = format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"");
    let mut child = Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_fct")])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()?;
    let mut pipe = child.stderr.take();
    let reader = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(pipe) = &mut pipe {
            let _ = pipe.take(10_000_000).read_to_end(&mut bytes);
        }
        bytes
    });
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if begun.elapsed() > LONGEST {
            child.kill()?;
            break child.wait()?;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let stderr = String::from_utf8_lossy(&reader.join().unwrap_or_default()).into_owned();
    Ok(Ended { code: status.code(), stderr, took: begun.elapsed() })
}
