//! The questions of `fct import` on a terminal: a pseudo-terminal asks, and types the answers.
#![cfg(unix)]

use crate::common;

use common::Tested;
use nix::pty::openpty;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::error::Error;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// A program whose three streams are a terminal.
struct Terminal {
    child: Child,
    keys: File,
    screen: Receiver<Vec<u8>>,
    seen: String,
}

impl Terminal {
    fn new(folder: &Path, arguments: &[&str]) -> Result<Self, Box<dyn Error>> {
        let pair = openpty(None, None)?;
        let stream = || pair.slave.try_clone().map(Stdio::from);
        let mut command = Command::new(env!("CARGO_BIN_EXE_fct"));
        command.args(arguments).current_dir(folder).stdin(stream()?).stdout(stream()?).stderr(stream()?);
        let child = command.spawn()?;
        let keys = File::from(pair.master);
        let mut master = keys.try_clone()?;
        let (send, screen) = channel();
        std::thread::spawn(move || {
            let mut buffer = [0; 4096];
            // Linux answers with an error once nobody holds the other side.
            while let Ok(n @ 1..) = master.read(&mut buffer) {
                if send.send(buffer[..n].to_vec()).is_err() {
                    break;
                }
            }
        });
        Ok(Self { child, keys, screen, seen: String::new() })
    }

    /// Waits for a text, then forgets what stands before its end.
    fn expect(&mut self, text: &str) -> Tested {
        while !self.seen.contains(text) {
            let more = self.screen.recv_timeout(Duration::from_secs(60));
            let more = more.map_err(|e| format!("no `{text}` in `{}`: {e}", self.seen))?;
            self.seen += &String::from_utf8_lossy(&more);
        }
        let end = self.seen.find(text).map_or(0, |at| at + text.len());
        self.seen.drain(..end);
        Ok(())
    }

    fn say(&mut self, keys: &str) -> Tested {
        Ok(self.keys.write_all(keys.as_bytes())?)
    }

    fn end(mut self) -> Result<ExitStatus, Box<dyn Error>> {
        Ok(self.child.wait()?)
    }
}

/// A test that failed leaves no program that waits.
impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = self.child.kill();
    }
}

/// Two forces, no unit of the time.
fn open_file() -> Result<tempfile::TempDir, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let rows: String = (0..12).map(|i| format!("{i};0.{i:02};0.{};1.{i}\n", i % 10)).collect();
    fs::write(folder.path().join("a.csv"), format!("Time;Weg [mm];left [N];right [N]\n{rows}"))?;
    Ok(folder)
}

#[test]
fn what_is_open_is_asked_and_an_answer_that_does_not_fit_is_asked_again() -> Tested {
    let folder = open_file()?;
    let mut terminal = Terminal::new(folder.path(), &["import", "a.csv"])?;
    terminal.expect("(the time) has no unit")?;
    terminal.expect("--units (empty: stop) ")?;
    terminal.say("bananas\n")?;
    terminal.expect("`bananas`; expected")?;
    terminal.expect("--units (empty: stop) ")?;
    // The whole flag does as well.
    terminal.say("--units time=s\n")?;
    terminal.expect("no column is called the force")?;
    terminal.expect("--force (empty: stop) ")?;
    terminal.say("9\n")?;
    terminal.expect("--force `9` names no column")?;
    terminal.expect("--force (empty: stop) ")?;
    terminal.say("right [N]\n")?;
    terminal.expect("The same without questions: --units time=s --force 'right [N]'")?;
    assert!(terminal.end()?.success());
    let record = fs::read_to_string(folder.path().join("a/uniaxial.csv"))?;
    assert!(record.lines().any(|l| l.ends_with(",1.3") || l.contains(",1.3,")), "{record}");
    let log = fs::read_to_string(folder.path().join("a/import.json"))?;
    assert!(log.contains("--force 'right [N]'") && !log.contains("--force 9"), "{log}");
    Ok(())
}

#[test]
fn an_empty_line_leaves_it_open_and_names_the_flags() -> Tested {
    let folder = open_file()?;
    let mut terminal = Terminal::new(folder.path(), &["import", "a.csv"])?;
    terminal.expect("--units (empty: stop) ")?;
    terminal.say("\n")?;
    terminal.expect("= help: say --units time=s")?;
    assert_eq!(terminal.end()?.code(), Some(2));
    assert!(!folder.path().join("a").exists());
    Ok(())
}

#[test]
fn ctrl_c_at_a_question_ends_it_at_once() -> Tested {
    let folder = open_file()?;
    let mut terminal = Terminal::new(folder.path(), &["import", "a.csv"])?;
    terminal.expect("--units (empty: stop) ")?;
    kill(Pid::from_raw(i32::try_from(terminal.child.id())?), Signal::SIGINT)?;
    assert_eq!(terminal.end()?.code(), Some(130));
    Ok(())
}

#[test]
fn nobody_is_asked_for_json() -> Tested {
    let folder = open_file()?;
    let mut terminal = Terminal::new(folder.path(), &["import", "a.csv", "--json"])?;
    terminal.expect("\"flag\"")?;
    assert_eq!(terminal.end()?.code(), Some(2));
    Ok(())
}
