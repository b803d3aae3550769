//! A headless Chromium spoken to over its debugging protocol: just enough to load a page, move a mouse
//! and read what stands there.

use serde_json::{Value, json};
use std::error::Error;
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket, connect};

type Outcome<T> = Result<T, Box<dyn Error>>;

const FLAGS: [&str; 11] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "about:blank",
];

/// Least time between two pictures of a film while something is waited for.
const FILM: Duration = Duration::from_millis(300);

/// The browser of this machine: `$CHROMIUM`, or one of the usual names on the path.
pub fn found() -> Option<PathBuf> {
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let usual = std::env::split_paths(&path).flat_map(|p| names.map(|n| p.join(n))).find(|p| p.is_file());
    named.or(usual)
}

/// A page in a running browser.
pub struct Page {
    child: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: Option<String>,
    last: u64,
    /// What the page did by itself, in order.
    pub events: Vec<Value>,
    profile: TempDir,
    /// Pictures of the film so far.
    frames: u32,
    filmed: Instant,
}

impl Page {
    /// Starts the browser with an empty page.
    pub fn open(chromium: &Path) -> Outcome<Self> {
        let profile = tempfile::tempdir()?;
        let mut child = Command::new(chromium)
            .args(FLAGS)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()?;
        let lines = BufReader::new(child.stderr.take().ok_or("no stderr")?);
        let mut lines = lines.lines();
        let address = loop {
            let line = lines.next().ok_or("the browser ended at once")??;
            if let Some(at) = line.strip_prefix("DevTools listening on ") {
                break at.to_owned();
            }
        };
        // What it says later must not fill the pipe.
        std::thread::spawn(move || lines.for_each(drop));
        let (socket, _) = connect(address)?;
        if let MaybeTlsStream::Plain(s) = socket.get_ref() {
            s.set_read_timeout(Some(Duration::from_secs(30)))?;
        }
        let mut page = Self {
            child,
            socket,
            session: None,
            last: 0,
            events: Vec::new(),
            profile,
            frames: 0,
            filmed: Instant::now(),
        };
        let target = page.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = page.call("Target.attachToTarget", attach)?;
        page.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            page.call(&format!("{domain}.enable"), json!({}))?;
        }
        Ok(page)
    }

    /// One command and its result.
    pub fn call(&mut self, method: &str, params: Value) -> Outcome<Value> {
        self.last += 1;
        let id = self.last;
        let mut message = json!({ "id": id, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(message.to_string()))?;
        loop {
            let Message::Text(text) = self.socket.read()? else { continue };
            let answer: Value = serde_json::from_str(&text)?;
            if answer["id"] == id {
                return match answer.get("error") {
                    Some(e) => Err(format!("{method}: {e}").into()),
                    None => Ok(answer["result"].clone()),
                };
            }
            self.events.push(answer);
        }
    }

    /// Loads a file at a width, light or dark; gives the time until the page's load event, ms.
    pub fn load(&mut self, file: &Path, width: u32, scheme: &str) -> Outcome<f64> {
        self.looks(width, scheme)?;
        self.go(&format!("file://{}", file.display()))
    }

    /// How wide the window is, and whether it is light or dark.
    pub fn looks(&mut self, width: u32, scheme: &str) -> Outcome<()> {
        let height = if width < 600 { 844 } else { 900 };
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.call("Emulation.setDeviceMetricsOverride", metrics)?;
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.call("Emulation.setEmulatedMedia", json!({ "features": features })).map(|_| ())
    }

    /// Goes to an address; gives the time until the page's load event, ms.
    pub fn go(&mut self, url: &str) -> Outcome<f64> {
        self.call("Page.navigate", json!({ "url": url }))?;
        let begun = Instant::now();
        loop {
            let state = self.ask("document.readyState === 'complete' && location.href !== 'about:blank' ? performance.getEntriesByType('navigation')[0].loadEventEnd : 0")?;
            match state.as_f64() {
                Some(ms) if ms > 0.0 => return Ok(ms),
                _ if begun.elapsed() > Duration::from_secs(30) => return Err("the page did not load".into()),
                _ => std::thread::sleep(Duration::from_millis(20)),
            }
        }
    }

    /// The value of a JavaScript expression.
    pub fn ask(&mut self, expression: &str) -> Outcome<Value> {
        let params = json!({ "expression": expression, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", params)?;
        match answer.get("exceptionDetails") {
            Some(e) => Err(format!("{expression}: {e}").into()),
            None => Ok(answer["result"]["value"].clone()),
        }
    }

    /// The value that a JavaScript promise comes to.
    pub fn ask_later(&mut self, expression: &str) -> Outcome<Value> {
        let params = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        Ok(self.call("Runtime.evaluate", params)?["result"]["value"].clone())
    }

    /// Waits until a JavaScript expression is true.
    pub fn until(&mut self, expression: &str, patience: Duration) -> Outcome<()> {
        let begun = Instant::now();
        while self.ask(&format!("Boolean({expression})"))? != true {
            if self.filmed.elapsed() > FILM {
                self.film(1)?;
            }
            if begun.elapsed() > patience {
                let seen = self.text("body")?;
                return Err(format!("not within {patience:?}: {expression}\n{seen}").into());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        self.settle()
    }

    /// Presses a key, as a keyboard does.
    pub fn press(&mut self, key: &str, code: u32, modifiers: u32) -> Outcome<()> {
        // Enter and space come with a character.
        let text = match key {
            "Enter" => "\r",
            " " => " ",
            _ => "",
        };
        for kind in ["keyDown", "keyUp"] {
            let event = json!({ "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code,
                "modifiers": modifiers, "text": if kind == "keyDown" { text } else { "" } });
            self.call("Input.dispatchKeyEvent", event)?;
        }
        self.settle()
    }

    /// Text of the first element that a selector finds.
    pub fn text(&mut self, selector: &str) -> Outcome<String> {
        let value = self.ask(&format!("document.querySelector({selector:?}).innerText"))?;
        Ok(value.as_str().unwrap_or_default().to_owned())
    }

    /// Scrolls to an element and gives a place in it: shares of its width and height.
    fn place(&mut self, selector: &str, at: [f64; 2]) -> Outcome<[f64; 2]> {
        let expression = format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center' }}); const r = e.getBoundingClientRect(); \
             return [r.x + r.width * {}, r.y + r.height * {}]; }})()",
            at[0], at[1]
        );
        Ok(serde_json::from_value(self.ask(&expression)?)?)
    }

    /// Moves the mouse over an element.
    pub fn hover(&mut self, selector: &str, at: [f64; 2]) -> Outcome<()> {
        let [x, y] = self.place(selector, at)?;
        // A mouse arrives from somewhere.
        for shift in [3.0, 0.0] {
            let event = json!({ "type": "mouseMoved", "x": x - shift, "y": y - shift });
            self.call("Input.dispatchMouseEvent", event)?;
        }
        self.settle()
    }

    /// Drags the mouse over an element, from a place in it to another.
    pub fn drag(&mut self, selector: &str, from: [f64; 2], to: [f64; 2]) -> Outcome<()> {
        let begin = self.place(selector, from)?;
        let end = self.place(selector, to)?;
        let mut event = |kind: &str, [x, y]: [f64; 2]| {
            let buttons = u8::from(kind != "mouseReleased");
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event)
        };
        event("mousePressed", begin)?;
        let between = [0.5 * (begin[0] + end[0]), 0.5 * (begin[1] + end[1])];
        for at in [between, end] {
            event("mouseMoved", at)?;
        }
        event("mouseReleased", end)?;
        self.settle()
    }

    /// Clicks an element in its middle.
    pub fn click(&mut self, selector: &str) -> Outcome<()> {
        let [x, y] = self.place(selector, [0.5, 0.5])?;
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event)?;
        }
        self.settle()
    }

    /// Two frames, so that what was asked for is drawn.
    pub fn settle(&mut self) -> Outcome<()> {
        let frames = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))";
        let params = json!({ "expression": frames, "awaitPromise": true });
        self.call("Runtime.evaluate", params).map(|_| ())
    }

    /// A picture of the whole page or of what is seen, into `$FCT_SCREENSHOTS`, if that is set.
    pub fn picture(&mut self, name: &str, whole: bool) -> Outcome<()> {
        let Some(folder) = std::env::var_os("FCT_SCREENSHOTS") else { return Ok(()) };
        if whole {
            // What stays at the top of the window would lie over the middle of the page.
            self.ask("scrollTo(0, 0)")?;
            self.settle()?;
        }
        let answer = self.call("Page.captureScreenshot", json!({ "captureBeyondViewport": whole }))?;
        let file = Path::new(&folder).join(format!("{name}.png"));
        Ok(std::fs::write(file, decoded(&answer)?)?)
    }

    /// A picture of what is seen for the film, shown for so many tenths of a second; only where `$FCT_FILM` names a folder.
    pub fn film(&mut self, tenths: u32) -> Outcome<()> {
        let Some(folder) = std::env::var_os("FCT_FILM") else { return Ok(()) };
        let answer = self.call("Page.captureScreenshot", json!({}))?;
        self.frames += 1;
        self.filmed = Instant::now();
        let file = Path::new(&folder).join(format!("{:04}-{tenths}.png", self.frames));
        Ok(std::fs::write(file, decoded(&answer)?)?)
    }

    /// Process ids of this browser's renderers, as Linux tells them.
    pub fn renderers(&self) -> Vec<u32> {
        let profile = self.profile.path().display().to_string();
        let ids = std::fs::read_dir("/proc").into_iter().flatten().flatten();
        let ids = ids.filter_map(|e| e.file_name().to_str()?.parse::<u32>().ok());
        let family: Vec<(u32, String)> = ids
            .filter_map(|id| Some((id, std::fs::read_to_string(format!("/proc/{id}/cmdline")).ok()?)))
            .filter(|(_, line)| line.contains("--type=renderer"))
            .collect();
        // A renderer does not name the profile; its parents do.
        let ours = |id: u32| {
            let mut at = id;
            for _ in 0..4 {
                let stat = std::fs::read_to_string(format!("/proc/{at}/stat")).unwrap_or_default();
                let parent = stat.rsplit(')').next().and_then(|r| r.split_whitespace().nth(1)?.parse().ok());
                let Some(parent) = parent else { return false };
                at = parent;
                let line = std::fs::read_to_string(format!("/proc/{at}/cmdline")).unwrap_or_default();
                if line.contains(&profile) {
                    return true;
                }
            }
            false
        };
        family.into_iter().map(|f| f.0).filter(|id| ours(*id)).collect()
    }

    /// What went wrong in the page: exceptions, errors on the console.
    pub fn faults(&self) -> Vec<String> {
        let bad = |e: &&Value| match e["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => {
                matches!(e["params"]["type"].as_str(), Some("error" | "warning"))
            }
            Some("Log.entryAdded") => e["params"]["entry"]["level"] == "error",
            _ => false,
        };
        self.events.iter().filter(bad).map(ToString::to_string).collect()
    }

    /// Addresses asked for that are neither the page itself nor inside it.
    pub fn outside(&self) -> Vec<String> {
        let asked = self.events.iter().filter(|e| e["method"] == "Network.requestWillBeSent");
        let urls = asked.filter_map(|e| e["params"]["request"]["url"].as_str());
        urls.filter(|u| !(u.starts_with("data:") || u.starts_with("file:") && u.ends_with(".html")))
            .map(str::to_owned)
            .collect()
    }
}

fn decoded(answer: &Value) -> Outcome<Vec<u8>> {
    let text = answer["data"].as_str().unwrap_or_default();
    Ok(base64::Engine::decode(&base64::engine::general_purpose::STANDARD, text)?)
}

impl Drop for Page {
    fn drop(&mut self) {
        // The browser is ours alone; nothing is lost with it.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
