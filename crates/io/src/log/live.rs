//! Logs that are being written: scans are given out as they come.
//!
//! A file is recognised by a large first part; waiting for that much of a live stream would hold back minutes of scans.
//! Here the head grows line by line until a format knows it.

use std::io::{BufRead, Read};

use super::{FORMATS, Log, LogError, ReadOptions, open_input};
use crate::input::Input;
use crate::lines::MAX_LINE_BYTES;

/// Lines of comments and other messages before the first scan that are waited for.
const MOST_HEAD_BYTES: usize = 256 * 1024;

/// Opens text that comes bit by bit, not packed, in any format whose first lines tell it; `name` is for messages.
///
/// # Errors
/// Nothing in it, the stream breaks, or content that is no known log.
pub fn open_live(
    name: &str,
    mut stream: impl BufRead + 'static,
    options: ReadOptions,
) -> Result<Log, LogError> {
    let name = name.to_owned();
    let mut head = Vec::new();
    loop {
        let read = (&mut stream)
            .take(MAX_LINE_BYTES as u64)
            .read_until(b'\n', &mut head)
            .map_err(|source| LogError::Unreadable {
                name: name.clone(),
                source,
            })?;
        if head.is_empty() {
            return Err(LogError::Empty { name });
        }
        let known = FORMATS.iter().any(|f| (f.recognise)(&head));
        if known || read == 0 || head.len() > MOST_HEAD_BYTES {
            return open_input(Input::begun(name, head, Box::new(stream)), options);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{self, BufReader};
    use std::sync::mpsc::{Receiver, channel};

    use super::*;
    use crate::log::Entry;

    /// Gives what is sent, and waits for more.
    struct Fed(Receiver<&'static str>);

    impl Read for Fed {
        fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
            let text = self.0.recv().unwrap_or_default();
            buf[..text.len()].copy_from_slice(text.as_bytes());
            Ok(text.len())
        }
    }

    #[test]
    fn a_scan_is_given_out_when_its_line_is_there() {
        let (sender, receiver) = channel();
        sender.send("# a comment\nPARAM laser\n").unwrap();
        sender
            .send("FLASER 3 1 1 1 0 0 0 0 0 0 5.5 host 1\nFLASER 3 1 1")
            .unwrap();
        let mut log = open_live("stream", BufReader::new(Fed(receiver)), ReadOptions::default()).unwrap();
        assert!(matches!(log.next(), Some(Ok(Entry::Scan(scan))) if scan.index == 0));
        sender.send(" 1 0 0 0 0 0 0 6.5 host 1\n").unwrap();
        assert!(matches!(log.next(), Some(Ok(Entry::Scan(scan))) if scan.stamp_s == Some(6.5)));
        drop(sender);
        assert!(log.next().is_none());
    }

    #[test]
    fn a_stream_of_something_else_is_refused() {
        let text = "hello\n".repeat(100_000);
        let error = open_live("stream", io::Cursor::new(text), ReadOptions::default())
            .err()
            .unwrap();
        assert!(matches!(error, LogError::Unrecognised { .. }), "{error}");
    }
}
