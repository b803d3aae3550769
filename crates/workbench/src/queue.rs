//! One worker: one thing at a time, the newest that was asked for.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Flags of what is being done.
#[derive(Clone, Debug, Default)]
pub struct Job {
    /// It is to end soon.
    pub cancelled: Arc<AtomicBool>,
    /// Nobody wants its result any more: something newer was asked for.
    pub superseded: Arc<AtomicBool>,
}

impl Job {
    /// Whether nobody wants the result.
    pub fn is_superseded(&self) -> bool {
        self.superseded.load(Ordering::SeqCst)
    }
}

struct Inner<T> {
    pending: Option<T>,
    running: Option<Job>,
    closed: bool,
}

/// What is asked for.
pub struct Queue<T> {
    inner: Mutex<Inner<T>>,
    bell: Condvar,
}

impl<T> Default for Queue<T> {
    fn default() -> Self {
        let inner = Inner { pending: None, running: None, closed: false };
        Self { inner: Mutex::new(inner), bell: Condvar::new() }
    }
}

impl<T> Queue<T> {
    fn lock(&self) -> MutexGuard<'_, Inner<T>> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks for something; what runs is cancelled, and its result thrown away.
    pub fn ask(&self, what: T) {
        let mut inner = self.lock();
        inner.pending = Some(what);
        supersede(&inner);
        self.bell.notify_all();
    }

    /// Cancels what runs and forgets what waits; the best of what runs is kept.
    pub fn stop(&self) {
        let mut inner = self.lock();
        inner.pending = None;
        if let Some(job) = &inner.running {
            job.cancelled.store(true, Ordering::SeqCst);
        }
    }

    /// Cancels what runs and forgets what waits, results too.
    pub fn forget(&self) {
        let mut inner = self.lock();
        inner.pending = None;
        supersede(&inner);
    }

    /// Whether something runs or waits.
    pub fn is_busy(&self) -> bool {
        let inner = self.lock();
        inner.running.is_some() || inner.pending.is_some()
    }

    /// Does what is asked for, until closed. `ended` is called when each is over: whoever asks then is told that nothing runs.
    pub fn work(&self, mut perform: impl FnMut(T, &Job), ended: impl Fn()) {
        while let Some((what, job)) = self.next() {
            perform(what, &job);
            self.lock().running = None;
            ended();
        }
    }

    fn next(&self) -> Option<(T, Job)> {
        let mut inner = self.lock();
        loop {
            if inner.closed {
                return None;
            }
            if let Some(what) = inner.pending.take() {
                let job = Job::default();
                inner.running = Some(job.clone());
                return Some((what, job));
            }
            inner = self.bell.wait(inner).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Ends the work; what runs is stopped.
    pub fn close(&self) {
        self.stop();
        self.lock().closed = true;
        self.bell.notify_all();
    }
}

fn supersede<T>(inner: &Inner<T>) {
    if let Some(job) = &inner.running {
        job.superseded.store(true, Ordering::SeqCst);
        job.cancelled.store(true, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use std::time::Duration;

    #[derive(Debug, PartialEq)]
    enum Told {
        Begun(u32),
        /// The number, and whether its result was thrown away.
        Ended(u32, bool),
    }

    /// Works at numbers above 1 until it is cancelled, and tells what it does.
    fn patient(queue: &Queue<u32>, told: &mpsc::Sender<Told>) {
        let work = |what, job: &Job| {
            let _ = told.send(Told::Begun(what));
            while what > 1 && !job.cancelled.load(Ordering::SeqCst) {
                std::thread::sleep(Duration::from_millis(1));
            }
            let _ = told.send(Told::Ended(what, job.is_superseded()));
        };
        queue.work(work, || ());
    }

    /// What is told up to and with the last that is waited for.
    fn until(heard: &mpsc::Receiver<Told>, last: &Told) -> Vec<Told> {
        let mut all = Vec::new();
        while all.last() != Some(last) {
            match heard.recv_timeout(Duration::from_secs(60)) {
                Ok(told) => all.push(told),
                Err(_) => break,
            }
        }
        all
    }

    #[test]
    fn what_has_ended_does_not_run_any_more() {
        let (queue, (told, heard)) = (Queue::default(), mpsc::channel());
        let busy = std::thread::scope(|scope| {
            scope.spawn(|| {
                queue.work(
                    |_, _| (),
                    || {
                        let _ = told.send(queue.is_busy());
                    },
                )
            });
            queue.ask(1);
            let busy = heard.recv_timeout(Duration::from_secs(60));
            queue.close();
            busy
        });
        assert_eq!(busy, Ok(false));
    }

    #[test]
    fn the_newest_cancels_the_older() {
        let (queue, (told, heard)) = (Queue::default(), mpsc::channel());
        let (first, newest, stopped) = std::thread::scope(|scope| {
            scope.spawn(|| patient(&queue, &told));
            queue.ask(9);
            let first = until(&heard, &Told::Begun(9));
            queue.ask(8);
            queue.ask(1);
            let newest = until(&heard, &Told::Ended(1, false));
            queue.ask(7);
            let mut stopped = until(&heard, &Told::Begun(7));
            queue.stop();
            stopped.extend(until(&heard, &Told::Ended(7, false)));
            // Whatever was heard, nothing is left that waits.
            queue.forget();
            queue.close();
            (first, newest, stopped)
        });
        assert_eq!(first, [Told::Begun(9)]);
        let between = [Told::Begun(8), Told::Ended(8, true)];
        // 8 may have begun before 1 was asked for.
        let without: Vec<_> = newest.iter().filter(|told| !between.contains(told)).collect();
        assert_eq!(without, [&Told::Ended(9, true), &Told::Begun(1), &Told::Ended(1, false)]);
        // What is stopped keeps its best.
        assert_eq!(stopped, [Told::Begun(7), Told::Ended(7, false)]);
    }
}
