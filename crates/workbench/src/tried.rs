//! What a running command says, on its way to the pages.

use crate::Listener;
use crate::events::Hub;
use crate::numbers::list;
use serde_json::{Map, Value, json};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Least time between two remarks of a search.
const PACE: Duration = Duration::from_millis(50);

/// Tells the pages about one command.
pub struct Teller {
    hub: Arc<Hub>,
    said: Mutex<Option<Instant>>,
}

impl Teller {
    /// A listener of a command.
    pub fn new(hub: Arc<Hub>) -> Self {
        Self { hub, said: Mutex::new(None) }
    }

    /// Whether something that is no news may be said already.
    fn due(&self) -> bool {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        let due = said.is_none_or(|at| at.elapsed() >= PACE);
        if due {
            *said = Some(Instant::now());
        }
        due
    }
}

impl Listener for Teller {
    fn note(&self, text: &str) {
        self.hub.tell("note", &json!({ "text": text }));
    }

    fn iterate(&self, p: &analysis::Progress) {
        // Every accepted step is told; trials only now and then.
        if p.iterate.accepted || self.due() {
            let forces: Map<String, Value> =
                p.forces.iter().map(|(test, f)| (test.clone(), list(f))).collect();
            self.hub.tell(
                "iterate",
                &json!({
                    "stage": p.stage.word(), "coarse": p.coarse, "iteration": p.iterate.iteration,
                    "objective": p.iterate.f, "accepted": p.iterate.accepted,
                    "paths": p.paths, "theta": p.iterate.theta, "forces": forces,
                }),
            );
        }
    }
}
