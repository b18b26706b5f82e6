//! Logs that are being written: scans are given out as they come.
//!
//! A file is recognised by a large first part; waiting for that much of a live stream would hold back minutes of scans.
//! Here the head grows line by line until a format knows it.

use std::io::{BufRead, Read};

use super::{Log, LogError, ReadOptions, format_of, open_input};
use crate::compression::unpacked;
use crate::input::{Input, without_mark};
use crate::lines::MAX_LINE_BYTES;

/// Lines of comments and other messages before the first scan that are waited for.
const MOST_HEAD_BYTES: usize = 256 * 1024;

/// The head is looked at again when it has grown by this part of itself: line after line while it is small, and yet no
/// more than some hundred times until it is [`MOST_HEAD_BYTES`] long.
const LOOK_AGAIN: usize = 64;

/// Opens a log that comes bit by bit, in any format whose first lines tell it; `name` is for messages.
///
/// # Errors
/// Nothing in it, the stream breaks, or content that is no known log.
pub fn open_live(name: &str, stream: impl BufRead + 'static, options: ReadOptions) -> Result<Log, LogError> {
    let name = name.to_owned();
    let unreadable = |source| LogError::Unreadable {
        name: name.clone(),
        source,
    };
    let (mut stream, _) = unpacked(Box::new(stream)).map_err(unreadable)?;
    let (mut head, mut look_at) = (Vec::new(), 0);
    loop {
        let read = (&mut stream)
            .take(MAX_LINE_BYTES as u64)
            .read_until(b'\n', &mut head)
            .map_err(unreadable)?;
        if head.is_empty() {
            return Err(LogError::Empty { name });
        }
        if read > 0 && head.len() < look_at {
            continue;
        }
        look_at = head.len() + head.len() / LOOK_AGAIN;
        let known = format_of(without_mark(&head), &options).is_some();
        if known || read == 0 || head.len() > MOST_HEAD_BYTES {
            return open_input(Input::begun(name, head, stream), &options);
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
