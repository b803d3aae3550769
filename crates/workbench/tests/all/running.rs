//! A running workbench, and requests over real sockets.

use serde_json::{Value, json};
use std::error::Error;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use workbench::{Bench, BenchError, Commands, Listener, Opened, Server, Told};

pub type Tested = Result<(), Box<dyn Error>>;

/// Commands that do nothing but wait for being cancelled, where they are told to.
#[derive(Default)]
pub struct Idle {
    /// Words of every command, and whether it was cancelled.
    pub heard: Mutex<Vec<(Vec<String>, bool)>>,
    pub waits: AtomicBool,
    /// How many have begun.
    pub begun: AtomicUsize,
}

impl Commands for Idle {
    fn run(&self, words: &[String], cancelled: &Arc<AtomicBool>, listener: &Arc<dyn Listener>) -> Told {
        listener.note("at work");
        self.begun.fetch_add(1, Ordering::SeqCst);
        let begun = Instant::now();
        while self.waits.load(Ordering::SeqCst)
            && !cancelled.load(Ordering::SeqCst)
            && begun.elapsed().as_secs() < 20
        {
            std::thread::sleep(Duration::from_millis(2));
        }
        let stopped = cancelled.load(Ordering::SeqCst);
        if let Ok(mut heard) = self.heard.lock() {
            heard.push((words.to_vec(), stopped));
        }
        Told { code: 1, json: json!({ "error": {} }), message: "nothing is computed here".into() }
    }
}

pub struct Running {
    pub folder: TempDir,
    pub commands: Arc<Idle>,
    pub port: u16,
    pub token: String,
    stops: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<(), BenchError>>>,
}

/// The answer to a request.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Running {
    /// A workbench on an empty folder.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let opened = Opened::of(&[folder.path().to_owned()])?;
        Self::on(folder, opened, Arc::new(Idle::default()))
    }

    /// A workbench on what was opened.
    pub fn on(folder: TempDir, opened: Opened, commands: Arc<Idle>) -> Result<Self, Box<dyn Error>> {
        let bench = Bench::open(opened, commands.clone(), effects::catalogue())?;
        let server = Server::bind(bench, 0)?;
        let url = server.url();
        let (before, token) = url.split_once("/?token=").ok_or("a token")?;
        let port = before.rsplit(':').next().ok_or("a port")?.parse()?;
        let token = token.to_owned();
        let stops = Arc::new(AtomicBool::new(false));
        let flag = stops.clone();
        let thread = Some(std::thread::spawn(move || server.run(&|| flag.load(Ordering::SeqCst))));
        Ok(Self { folder, commands, port, token, stops, thread })
    }

    pub fn connect(&self) -> std::io::Result<TcpStream> {
        let stream = TcpStream::connect(("127.0.0.1", self.port))?;
        stream.set_read_timeout(Some(Duration::from_secs(20)))?;
        Ok(stream)
    }

    pub fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    pub fn cookie(&self) -> String {
        format!("Cookie: fct-workbench-{}={}", self.port, self.token)
    }

    /// Sends a request as it is, with the connection closed after it.
    pub fn send(&self, line: &str, headers: &[&str], body: &[u8]) -> Result<Answer, Box<dyn Error>> {
        let mut stream = self.connect()?;
        let mut text = format!("{line} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n", body.len());
        headers.iter().for_each(|h| text.push_str(&format!("{h}\r\n")));
        text.push_str("\r\n");
        stream.write_all(text.as_bytes())?;
        // A server that refuses may not read the body.
        let _ = stream.write_all(body);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (head, body) = text.split_once("\r\n\r\n").ok_or_else(|| format!("no answer: {text:?}"))?;
        let status = head.split(' ').nth(1).ok_or("a status")?.parse()?;
        Ok(Answer { status, head: head.to_lowercase(), body: body.to_owned() })
    }

    /// A request as the page makes it.
    pub fn own(&self, line: &str, body: &[u8]) -> Result<Answer, Box<dyn Error>> {
        let (host, cookie) = (format!("Host: {}", self.host()), self.cookie());
        let origin = format!("Origin: http://{}", self.host());
        self.send(line, &[&host, &cookie, &origin, "Sec-Fetch-Site: same-origin"], body)
    }

    pub fn state(&self) -> Result<Value, Box<dyn Error>> {
        let answer = self.own("GET /api/state", b"")?;
        assert_eq!(answer.status, 200, "{}", answer.body);
        Ok(serde_json::from_str(&answer.body)?)
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stops.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            assert!(thread.join().is_ok_and(|r| r.is_ok()), "the server ended otherwise than asked");
        }
    }
}
