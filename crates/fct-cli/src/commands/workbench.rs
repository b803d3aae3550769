//! `fct workbench`: the loop with hands, in the browser.

use crate::cli::Cli;
use crate::guard::caught;
use crate::outcome::{Failure, Outcome, print};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::workbench::{Bench, BenchError, Commands, Listener, Opened, Server, Told};
use clap::Parser;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Arguments of `fct workbench`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A run directory, a specimen or config, or files of the testing machine; default: an empty page in this folder
    #[arg(value_name = "RUN|CONFIG|CSV")]
    pub named: Vec<PathBuf>,
    /// Port on 127.0.0.1; default: any free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Only print the address, open no browser
    #[arg(long)]
    pub no_open: bool,
}

/// Serves the page until Ctrl-C.
///
/// # Errors
/// If there is nothing to open, or the port is taken.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let failed = |e: BenchError| match e {
        BenchError::Asked(why) => Failure::usage(format!("fct workbench: {why}")),
        other => Failure::compute(format!("fct workbench: {other}")),
    };
    let opened = Opened::of(&arguments.named).map_err(failed)?;
    // The commands of the page name files from here, as they do when pasted.
    std::env::set_current_dir(&opened.root)
        .map_err(|e| Failure::compute(format!("fct workbench: {}: {e}", opened.root.display())))?;
    let folder = opened.root.clone();
    let bench = Bench::open(opened, Arc::new(InProcess), effects::catalogue()).map_err(failed)?;
    let server = Server::bind(bench, arguments.port).map_err(failed)?;
    let url = server.url();
    let told = if session.common.json {
        json!({ "schema": SCHEMA, "url": url, "folder": folder }).to_string()
    } else {
        format!(
            "{url}\nOnly this machine can open it, with this token. Ctrl-C ends it; what was done stays in {}.",
            folder.display()
        )
    };
    print(&format!("{told}\n"))
        .map_err(|e| Failure::compute(format!("fct: cannot print the address: {e}")))?;
    if !arguments.no_open && !open(&url) {
        session.say("no browser could be started: open the address above");
    }
    server.run(&|| session.cancelled()).map_err(failed)?;
    Ok(Outcome { json: Value::Null, text: String::new(), partial: None })
}

/// Starts the user's browser; whether that could be done.
fn open(url: &str) -> bool {
    let (program, before): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("rundll32", &["url.dll,FileProtocolHandler"]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(before).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}

/// Commands of the page, run by the code that runs them from a shell.
struct InProcess;

impl Commands for InProcess {
    fn run(&self, arguments: &[String], cancelled: &Arc<AtomicBool>, listener: &Arc<dyn Listener>) -> Told {
        let words: Vec<String> = ["fct"]
            .iter()
            .map(|s| (*s).to_owned())
            .chain(arguments.iter().cloned())
            .chain(["--json".into()])
            .collect();
        let done = caught(|| {
            let cli = Cli::try_parse_from(&words).map_err(|e| Failure::usage(e.to_string()))?;
            let common = cli.command.common();
            let session = Session::within(&common, words.clone(), cancelled.clone(), listener.clone());
            super::run(&cli.command, &session)
        });
        match done.and_then(|done| done) {
            Ok(Outcome { json, partial, .. }) => {
                Told { code: u8::from(partial.is_some()), json, message: partial.unwrap_or_default() }
            }
            Err(Failure { code, message, json }) => {
                let message = message.strip_prefix("fct: ").map(str::to_owned).unwrap_or(message);
                Told { code, json, message }
            }
        }
    }
}
