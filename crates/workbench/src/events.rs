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

/// Who listens.
#[derive(Default)]
pub struct Hub(Mutex<Vec<mpsc::Sender<Bytes>>>);

impl Hub {
    fn all(&self) -> MutexGuard<'_, Vec<mpsc::Sender<Bytes>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells every page. A line break in the data cannot end it: JSON has none.
    pub fn tell(&self, event: &str, data: &Value) {
        self.send(&Bytes::from(format!("event: {event}\ndata: {data}\n\n")));
    }

    /// A comment that no page sees: a page that has gone is noticed by it.
    pub fn beat(&self) {
        self.send(&Bytes::from_static(b": here\n\n"));
    }

    fn send(&self, text: &Bytes) {
        self.all().retain(|page| page.try_send(text.clone()).is_ok());
    }

    /// A page that listens from now on; the one that has listened longest goes where there are too many.
    pub fn listen(&self) -> Feed {
        let (sender, receiver) = mpsc::channel(BEHIND);
        // The head of the answer goes out with the first bytes.
        let _ = sender.try_send(Bytes::from_static(b": here\n\n"));
        let mut all = self.all();
        if all.len() >= MOST {
            all.remove(0);
        }
        all.push(sender);
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
        assert_eq!(hub.all().len(), 1);
        assert!(feed.0.try_recv().is_ok_and(|b| b.starts_with(b":")));
        assert!(feed.0.try_recv().is_ok_and(|b| &b[..] == b"event: note\ndata: \"a\\nb\"\n\n"));
        for _ in 0..=BEHIND {
            hub.beat();
        }
        assert_eq!(hub.all().len(), 0, "a page that does not read is let go");
    }
}
