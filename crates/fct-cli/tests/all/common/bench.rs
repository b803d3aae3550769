//! A running workbench, and requests to it as a page makes them, without a browser.
#![allow(dead_code)]

use serde_json::Value;
use std::error::Error;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The longest that one piece of work may take on a busy machine.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// A running `fct workbench`; ends with the value.
pub struct Bench {
    child: Child,
    /// The address to open.
    pub url: String,
}

impl Bench {
    /// Opens what is named in a folder.
    pub fn open(folder: &Path, named: &[&str]) -> Result<Self, Box<dyn Error>> {
        Self::begun(Command::new(env!("CARGO_BIN_EXE_fct")).args(arguments(named)), folder)
    }

    /// The same where no file may grow beyond so many blocks of 512 or 1024 bytes: as good as a full disk.
    pub fn on_a_full_disk(folder: &Path, named: &[&str], blocks: u32) -> Result<Self, Box<dyn Error>> {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_fct")]).args(arguments(named));
        Self::begun(&mut command, folder)
    }

    fn begun(command: &mut Command, folder: &Path) -> Result<Self, Box<dyn Error>> {
        let mut child = command.current_dir(folder).stdout(Stdio::piped()).spawn()?;
        let mut line = String::new();
        BufReader::new(child.stdout.take().ok_or("no stdout")?).read_line(&mut line)?;
        let told: Value = serde_json::from_str(&line)?;
        let url = told["url"].as_str().ok_or("no address")?.to_owned();
        Ok(Self { child, url })
    }

    /// Its process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Kills it, as a power cut does.
    pub fn kill(mut self) -> Result<(), Box<dyn Error>> {
        self.child.kill()?;
        self.child.wait()?;
        Ok(())
    }

    fn send(&self, line: &str, body: &[u8]) -> Result<TcpStream, Box<dyn Error>> {
        let (host, token) = self.url.trim_start_matches("http://").split_once("/?token=").ok_or("a token")?;
        let port = host.rsplit(':').next().ok_or("a port")?;
        let mut stream = TcpStream::connect(host)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        write!(
            stream,
            "{line} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nCookie: fct-workbench-{port}={token}\r\n\
             Connection: close\r\nContent-Length: {}\r\n\r\n",
            body.len()
        )?;
        stream.write_all(body)?;
        Ok(stream)
    }

    /// Status and body of an answer.
    pub fn ask(&self, line: &str, body: &[u8]) -> Result<(u16, Value), Box<dyn Error>> {
        let mut text = String::new();
        self.send(line, body)?.read_to_string(&mut text)?;
        let (head, body) = text.split_once("\r\n\r\n").ok_or_else(|| format!("no answer: {text:?}"))?;
        Ok((head.split(' ').nth(1).ok_or("a status")?.parse()?, serde_json::from_str(body)?))
    }

    /// What a page shows.
    pub fn state(&self) -> Result<Value, Box<dyn Error>> {
        Ok(self.ask("GET /api/state", b"")?.1)
    }

    /// Asks for something and waits for its end; what was told meanwhile.
    pub fn perform(&self, action: &str) -> Result<String, Box<dyn Error>> {
        let mut events = BufReader::new(self.send("GET /api/events", b"")?);
        let mut told = String::new();
        // Listening begins with the head of the answer.
        until(&mut events, &mut told, ": here")?;
        assert_eq!(self.ask("POST /api/do", action.as_bytes())?.0, 200, "{action}");
        until(&mut events, &mut told, "event: ended")?;
        Ok(told)
    }

    /// Asks for something and comes back as soon as it is being done.
    pub fn begin(&self, action: &str) -> Result<(), Box<dyn Error>> {
        let mut events = BufReader::new(self.send("GET /api/events", b"")?);
        let mut told = String::new();
        until(&mut events, &mut told, ": here")?;
        assert_eq!(self.ask("POST /api/do", action.as_bytes())?.0, 200, "{action}");
        until(&mut events, &mut told, "event: iterate")
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn arguments<'a>(named: &[&'a str]) -> Vec<&'a str> {
    [&["workbench", "--no-open", "--json"], named].concat()
}

fn until(events: &mut impl BufRead, told: &mut String, word: &str) -> Result<(), Box<dyn Error>> {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        let mut line = String::new();
        if events.read_line(&mut line)? == 0 {
            return Err(format!("the workbench went away before {word:?}").into());
        }
        told.push_str(&line);
        if line.starts_with(word) {
            return Ok(());
        }
    }
    Err(format!("not within {PATIENCE:?}: {word}").into())
}
