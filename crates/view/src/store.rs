//! The record as the server holds it: lines that every page gets, and details that a page asks for.
//!
//! A page reads at its own pace from the place it has come to; nothing is queued for it, so that a slow page costs no
//! memory.

use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::{Bytes, BytesMut};
use tokio::sync::{Notify, watch};
use tokio::time::sleep;

use crate::record::{Detail, Line};
use crate::recorder::Sink;

/// A record that grows. Clones share it.
#[derive(Clone)]
pub struct Store {
    held: Arc<Mutex<Held>>,
    /// Told of every line; one waits for it, however many pages there are.
    grown: Arc<Notify>,
    /// Tells all pages how many lines there are.
    lines: watch::Sender<usize>,
}

/// Pages are told of new lines at most this often,
const TELL_AFTER: Duration = Duration::from_millis(5);
/// and so much less often for each of them: waking and sending takes some hundredths of a millisecond a page, and a
/// machine with two processors has them for the mapper. 100 pages are 30 ms behind.
const TELL_AFTER_FOR_EACH: Duration = Duration::from_micros(250);

#[derive(Default)]
struct Held {
    lines: Vec<Bytes>,
    details: Vec<Bytes>,
    ended: bool,
}

impl Default for Store {
    fn default() -> Self {
        Self {
            held: Arc::default(),
            grown: Arc::default(),
            lines: watch::Sender::new(0),
        }
    }
}

impl Store {
    /// Whether nothing has come yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held().lines.is_empty()
    }

    /// Follows the number of lines.
    pub(crate) fn watch(&self) -> watch::Receiver<usize> {
        self.lines.subscribe()
    }

    /// Tells all pages when there are new lines, as long as it is polled.
    pub(crate) async fn herald(&self) {
        loop {
            self.grown.notified().await;
            let count = self.held().lines.len();
            self.lines.send_replace(count);
            let pages = u32::try_from(self.lines.receiver_count()).unwrap_or(u32::MAX);
            sleep(TELL_AFTER + TELL_AFTER_FOR_EACH.saturating_mul(pages)).await;
        }
    }

    /// As many lines from `from` on as fit into `most_bytes`, at least one if there is one; how many they are, and
    /// whether nothing will follow.
    pub(crate) fn lines(&self, from: usize, most_bytes: usize) -> (Bytes, usize, bool) {
        let held = self.held();
        let (mut out, mut count) = (BytesMut::new(), 0);
        for line in held.lines.iter().skip(from) {
            if count > 0 && out.len() + line.len() > most_bytes {
                break;
            }
            out.extend_from_slice(line);
            count += 1;
        }
        let at_end = held.ended && from + count >= held.lines.len();
        (out.freeze(), count, at_end)
    }

    /// The details of the scans `first..=last`, as lines; those that are there.
    pub(crate) fn details(&self, first: usize, last: usize) -> Bytes {
        let held = self.held();
        let mut out = BytesMut::new();
        for line in held.details.iter().take(last.saturating_add(1)).skip(first) {
            out.extend_from_slice(line);
        }
        out.freeze()
    }

    /// The detail of scan `n`.
    pub(crate) fn detail(&self, n: usize) -> Option<Detail> {
        let line = self.held().details.get(n).cloned()?;
        match serde_json::from_slice(&line) {
            Ok(Line::Detail(detail)) => Some(*detail),
            _ => None,
        }
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        // The data are whole even if a thread died while it held them: every change is a single push.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a line that is text already.
    pub(crate) fn push(&self, line: &Line, mut text: Vec<u8>) {
        text.push(b'\n');
        {
            let mut held = self.held();
            held.ended |= matches!(line, Line::End(_));
            if matches!(line, Line::Detail(_)) {
                held.details.push(text.into());
                return;
            }
            held.lines.push(text.into());
        }
        self.grown.notify_one();
    }
}

impl Sink for Store {
    fn take(&mut self, line: &Arc<Line>) -> io::Result<()> {
        self.push(line, serde_json::to_vec(&**line)?);
        Ok(())
    }
}
