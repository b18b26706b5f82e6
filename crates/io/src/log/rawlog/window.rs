//! The search for objects in the stream of a rawlog, in bounded memory.

use std::io::{self, BufRead};

/// A scan of the most beams that are read, with intensities, and a long label.
const MAX_OBJECT_BYTES: usize = 1024 * 1024;
/// Bytes held at most; more than one object.
const WINDOW_BYTES: usize = 2 * MAX_OBJECT_BYTES;

/// Classes that are looked for, with and without their namespace.
const CLASSES: &[(&[u8], Class)] = &[
    (b"\x97CObservation2DRangeScan", Class::Scan),
    (b"\xa2mrpt::obs::CObservation2DRangeScan", Class::Scan),
    (b"\x94CObservationOdometry", Class::Odometry),
    (b"\x9fmrpt::obs::CObservationOdometry", Class::Odometry),
    (b"\x96CActionRobotMovement2D", Class::Action),
    (b"\xa1mrpt::obs::CActionRobotMovement2D", Class::Action),
];

/// What an object is, of those that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Scan,
    Odometry,
    Action,
}

/// A part of the stream that slides along it.
pub(super) struct Window {
    stream: Box<dyn BufRead>,
    bytes: Vec<u8>,
    start: usize,
    at_end: bool,
    fault: Option<io::Error>,
    /// Bytes taken from the stream.
    pub read_bytes: u64,
}

impl Window {
    pub fn new(stream: Box<dyn BufRead>) -> Self {
        Self {
            stream,
            bytes: Vec::new(),
            start: 0,
            at_end: false,
            fault: None,
            read_bytes: 0,
        }
    }

    /// What is at hand.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[self.start..]
    }

    /// Passes over some of it.
    pub fn consume(&mut self, bytes: usize) {
        self.start = (self.start + bytes).min(self.bytes.len());
    }

    /// Sees to it that a whole object is at hand, unless the stream ends before.
    fn fill(&mut self) {
        if self.at_end || self.bytes.len() - self.start >= MAX_OBJECT_BYTES {
            return;
        }
        self.bytes.drain(..self.start);
        self.start = 0;
        while self.bytes.len() < WINDOW_BYTES && !self.at_end {
            match self.stream.fill_buf() {
                Ok([]) => self.at_end = true,
                Ok(part) => {
                    let taken = part.len();
                    self.bytes.extend_from_slice(part);
                    self.stream.consume(taken);
                    self.read_bytes += taken as u64;
                }
                Err(fault) => {
                    self.fault = Some(fault);
                    self.at_end = true;
                }
            }
        }
    }

    /// Slides on to the next object of a class that is looked for.
    pub fn find(&mut self) -> io::Result<Option<Class>> {
        const LONGEST_NAME: usize = 40;
        loop {
            self.fill();
            let bytes = &self.bytes[self.start..];
            let found = (0..bytes.len()).find_map(|at| {
                if bytes[at] & 0x80 == 0 {
                    return None;
                }
                let (_, class) = CLASSES.iter().find(|(name, _)| bytes[at..].starts_with(name))?;
                Some((at, *class))
            });
            if let Some((at, class)) = found {
                self.start += at;
                self.fill();
                return Ok(Some(class));
            }
            if self.at_end {
                self.start = self.bytes.len();
                return self.fault.take().map_or(Ok(None), Err);
            }
            self.start = self.bytes.len().saturating_sub(LONGEST_NAME).max(self.start);
        }
    }
}
