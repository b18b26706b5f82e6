//! A sink that works on a thread of its own, so that writing a record does not hold up the mapper.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use crate::record::Line;
use crate::recorder::Sink;

/// Lines that are handed over together: waking the other thread for each cost 2 % of a build.
const AT_ONCE: usize = 64;
/// Hands full of lines that wait to be written; when there are more, the mapper waits.
const MOST_WAITING: usize = 16;

/// Gives every line to a sink on another thread. What goes wrong there is told with one of the next lines, or at the end.
pub struct Background<S> {
    lines: Option<SyncSender<Vec<Arc<Line>>>>,
    gathered: Vec<Arc<Line>>,
    thread: Option<JoinHandle<io::Result<S>>>,
}

impl<S: Sink + Send + 'static> Background<S> {
    /// Starts the thread.
    pub fn new(mut sink: S) -> Self {
        let (lines, waiting) = sync_channel::<Vec<Arc<Line>>>(MOST_WAITING);
        let thread = thread::spawn(move || {
            for line in waiting.into_iter().flatten() {
                sink.take(&line)?;
            }
            Ok(sink)
        });
        Self {
            lines: Some(lines),
            gathered: Vec::with_capacity(AT_ONCE),
            thread: Some(thread),
        }
    }

    /// Waits until all is written, and gives the sink back.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn finish(mut self) -> io::Result<S> {
        // Where the thread has ended, its fault is told below.
        let _ = self.hand_over();
        self.lines = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) | None => Err(io::Error::other("the thread that writes has died")),
        }
    }

    /// Gives what was gathered to the thread; whether that still takes it.
    fn hand_over(&mut self) -> bool {
        let gathered = std::mem::replace(&mut self.gathered, Vec::with_capacity(AT_ONCE));
        self.lines
            .as_ref()
            .is_some_and(|lines| lines.send(gathered).is_ok())
    }

    /// What the thread died of.
    fn fault(&mut self) -> io::Error {
        let result = self.thread.take().map(JoinHandle::join);
        match result {
            Some(Ok(Err(error))) => error,
            _ => io::Error::other("the thread that writes has ended"),
        }
    }
}

impl<S: Sink + Send + 'static> Sink for Background<S> {
    fn take(&mut self, line: &Arc<Line>) -> io::Result<()> {
        self.gathered.push(Arc::clone(line));
        let is_taken = self.gathered.len() < AT_ONCE || self.hand_over();
        if is_taken { Ok(()) } else { Err(self.fault()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{End, Line};

    /// Has room for so many lines.
    struct Disk(usize);

    impl Sink for Disk {
        fn take(&mut self, _line: &Arc<Line>) -> io::Result<()> {
            self.0 = self
                .0
                .checked_sub(1)
                .ok_or_else(|| io::Error::other("the disk is full"))?;
            Ok(())
        }
    }

    fn line() -> Arc<Line> {
        Arc::new(Line::End(End { partial: None }))
    }

    #[test]
    fn everything_is_written_before_the_end() {
        let mut sink = Background::new(Disk(5000));
        for _ in 0..4000 {
            sink.take(&line()).unwrap();
        }
        assert_eq!(sink.finish().unwrap().0, 1000);
    }

    #[test]
    fn a_full_disk_is_told_soon_and_by_name() {
        let mut sink = Background::new(Disk(3));
        let error = (0..10_000).find_map(|_| sink.take(&line()).err()).unwrap();
        assert_eq!(error.to_string(), "the disk is full");
        let mut late = Background::new(Disk(0));
        late.take(&line()).unwrap();
        assert_eq!(late.finish().err().unwrap().to_string(), "the disk is full");
    }
}
