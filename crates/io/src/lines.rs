//! Lines of a text stream in bounded memory, whatever the stream holds.

use std::io::{self, BufRead, Read};

/// The longest line that is read whole. The longest lines seen in real logs (1081 beams with remission
/// values) are 20 kB; the limit only keeps a file without line ends from filling the memory.
pub(crate) const MAX_LINE_BYTES: usize = 1024 * 1024;

/// A line without its line end.
pub(crate) struct Line<'a> {
    /// 1-based.
    pub number: u64,
    /// The line, or its first [`MAX_LINE_BYTES`] bytes.
    pub bytes: &'a [u8],
    /// Whether something was left out.
    pub too_long: bool,
}

/// Reads line after line.
pub(crate) struct Lines {
    stream: Box<dyn BufRead>,
    buffer: Vec<u8>,
    number: u64,
    read_bytes: u64,
}

impl Lines {
    pub fn new(stream: Box<dyn BufRead>) -> Self {
        Self {
            stream,
            buffer: Vec::new(),
            number: 0,
            read_bytes: 0,
        }
    }

    /// Reads on in another stream. The count of the lines starts anew, that of the bytes does not.
    pub fn continue_with(&mut self, stream: Box<dyn BufRead>) {
        self.stream = stream;
        self.number = 0;
    }

    /// Lines read whole so far.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Bytes of text read so far, after decompression.
    pub fn read_bytes(&self) -> u64 {
        self.read_bytes
    }

    /// The next line; `None` at the end.
    ///
    /// # Errors
    /// Those of the stream. What was read of a line before the fault is dropped: it may be cut inside a number.
    pub fn next_line(&mut self) -> io::Result<Option<Line<'_>>> {
        self.buffer.clear();
        let limit = MAX_LINE_BYTES as u64 + 1;
        (&mut self.stream)
            .take(limit)
            .read_until(b'\n', &mut self.buffer)?;
        self.read_bytes += self.buffer.len() as u64;
        if self.buffer.is_empty() {
            return Ok(None);
        }
        let too_long = self.buffer.len() > MAX_LINE_BYTES && self.buffer.last() != Some(&b'\n');
        if too_long {
            self.skip_to_line_end()?;
        }
        self.number += 1;
        Ok(Some(Line {
            number: self.number,
            bytes: self.buffer.trim_ascii(),
            too_long,
        }))
    }

    fn skip_to_line_end(&mut self) -> io::Result<()> {
        self.read_bytes += self.stream.skip_until(b'\n')? as u64;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_end_costs_bounded_memory_and_one_line() {
        let mut text = vec![b'7'; 3 * MAX_LINE_BYTES];
        text.extend_from_slice(b"\nnext\r\n");
        let mut lines = Lines::new(Box::new(io::Cursor::new(text)));
        let long = lines.next_line().unwrap().unwrap();
        assert!(long.too_long && long.bytes.len() <= MAX_LINE_BYTES + 1);
        let next = lines.next_line().unwrap().unwrap();
        assert_eq!((next.bytes, next.number, next.too_long), (&b"next"[..], 2, false));
        assert!(lines.next_line().unwrap().is_none());
    }
}
