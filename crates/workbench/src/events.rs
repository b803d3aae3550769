//! Server-sent events: what happens goes to every page that listens.

use axum::body::Bytes;
use futures_core::Stream;
use serde_json::Value;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use tokio::sync::mpsc;

/// Events that a page may be behind before it is let go; it connects again and asks for the state.
const BEHIND: usize = 256;
/// Pages that may listen at once.
const MOST: usize = 64;

/// Remarks of what runs that are kept for a page that comes later.
const KEPT: usize = 120;

/// Who listens.
#[derive(Default)]
pub struct Hub(Mutex<Heard>);

#[derive(Default)]
struct Heard {
    pages: Vec<mpsc::Sender<Bytes>>,
    /// What was told since the present work began, the newest of each key: a page that is opened meanwhile is told it too.
    work: Vec<(String, Bytes)>,
}

impl Heard {
    fn keep(&mut self, event: &str, data: &Value, text: &Bytes) {
        let key = match event {
            "begun" => {
                self.work.clear();
                String::new()
            }
            "ended" => return self.work.clear(),
            // A search tells of each model that it fits: `drift: iteration 3, χ² 120.5`.
            "note" => {
                let said = data["text"].as_str().unwrap_or_default();
                format!("note {}", said.split_once(": ").map_or("", |s| s.0))
            }
            "iterate" if data["accepted"] == true => event.to_owned(),
            _ => return,
        };
        self.work.retain(|(k, _)| *k != key);
        // The first is what was begun.
        if self.work.len() >= KEPT {
            self.work.remove(1);
        }
        self.work.push((key, text.clone()));
    }
}

impl Hub {
    fn all(&self) -> MutexGuard<'_, Heard> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells every page. A line break in the data cannot end it: JSON has none.
    pub fn tell(&self, event: &str, data: &Value) {
        let text = Bytes::from(format!("event: {event}\ndata: {data}\n\n"));
        let mut all = self.all();
        all.keep(event, data, &text);
        all.pages.retain(|page| page.try_send(text.clone()).is_ok());
    }

    /// A comment that no page sees: a page that has gone is noticed by it.
    pub fn beat(&self) {
        self.all().pages.retain(|page| page.try_send(Bytes::from_static(b": here\n\n")).is_ok());
    }

    /// A page that listens from now on, and is told what is being done; the one that has listened longest goes where there
    /// are too many.
    pub fn listen(&self) -> Feed {
        let (sender, receiver) = mpsc::channel(BEHIND);
        // The head of the answer goes out with the first bytes.
        let _ = sender.try_send(Bytes::from_static(b": here\n\n"));
        let mut all = self.all();
        for (_, text) in &all.work {
            let _ = sender.try_send(text.clone());
        }
        if all.pages.len() >= MOST {
            all.pages.remove(0);
        }
        all.pages.push(sender);
        Feed(receiver)
    }
}

/// The events of one page, as the body of an answer.
pub struct Feed(mpsc::Receiver<Bytes>);

impl Stream for Feed {
    type Item = Result<Bytes, Infallible>;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        self.0.poll_recv(context).map(|bytes| bytes.map(Ok))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_told_arrives_and_who_has_gone_is_forgotten() {
        let hub = Hub::default();
        let mut feed = hub.listen();
        drop(hub.listen());
        hub.tell("note", &json!("a\nb"));
        assert_eq!(hub.all().pages.len(), 1);
        assert!(feed.0.try_recv().is_ok_and(|b| b.starts_with(b":")));
        assert!(feed.0.try_recv().is_ok_and(|b| &b[..] == b"event: note\ndata: \"a\\nb\"\n\n"));
        for _ in 0..=BEHIND {
            hub.beat();
        }
        assert_eq!(hub.all().pages.len(), 0, "a page that does not read is let go");
    }

    #[test]
    fn a_page_that_comes_while_something_runs_is_told_what() {
        let hub = Hub::default();
        let heard = |hub: &Hub| {
            let mut feed = hub.listen();
            let all = std::iter::from_fn(|| feed.0.try_recv().ok());
            all.filter_map(|b| String::from_utf8(b.to_vec()).ok()).skip(1).collect::<Vec<_>>()
        };
        hub.tell("begun", &json!({ "what": "searching" }));
        for text in ["drift: iteration 1", "lag: iteration 1", "drift: iteration 2"] {
            hub.tell("note", &json!({ "text": text }));
        }
        hub.tell("iterate", &json!({ "accepted": true, "objective": 2.0 }));
        hub.tell("iterate", &json!({ "accepted": false, "objective": 9.0 }));
        let told = heard(&hub);
        assert_eq!(told.len(), 4, "{told:?}");
        assert!(told[0].contains("searching") && told[2].contains("drift: iteration 2"), "{told:?}");
        for n in 0..2 * KEPT {
            hub.tell("note", &json!({ "text": format!("model {n}: iteration 1") }));
        }
        assert!(heard(&hub).len() <= KEPT && heard(&hub)[0].contains("begun"));
        hub.tell("ended", &Value::Null);
        assert!(heard(&hub).is_empty());
    }
}
