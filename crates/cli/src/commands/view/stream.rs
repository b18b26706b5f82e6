//! Scans as they come, read on a thread of their own, so that the map is made while nothing comes.

use std::io::{self, BufReader, Read};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::Context;
use polymapper_io::log::{Entry, LogError, ReadOptions, open_live};

use super::follow::Follower;
use crate::interrupt::Interrupt;
use crate::talk::say;

/// Scans that wait to be mapped; when there are more, the sender waits.
const MOST_WAITING: usize = 64;
/// When nothing came for so long, there is time for other things.
const IDLE_AFTER: Duration = Duration::from_millis(150);

/// What those say who connect, one after the other.
struct Callers {
    listener: TcpListener,
    now: Option<TcpStream>,
}

impl Read for Callers {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        loop {
            let Some(stream) = &mut self.now else {
                self.now = Some(self.listener.accept()?.0);
                continue;
            };
            match stream.read(buf) {
                Ok(n) if n > 0 => return Ok(n),
                // Gone, in the middle of a line perhaps: the next caller begins a new one.
                Ok(_) | Err(_) => {
                    self.now = None;
                    if let Some(first) = buf.first_mut() {
                        *first = b'\n';
                        return Ok(1);
                    }
                    return Ok(0);
                }
            }
        }
    }
}

/// Scans as they come.
pub struct Stream {
    name: String,
    entries: Receiver<Result<Entry, LogError>>,
}

impl Stream {
    /// Scans from standard input.
    pub fn of_stdin(options: ReadOptions) -> Self {
        Self::start("standard input", || Ok(Box::new(io::stdin())), options)
    }

    /// Scans from whoever connects to `place`, a port of this machine or `HOST:PORT`.
    pub fn of_callers(place: &str, options: ReadOptions) -> anyhow::Result<Self> {
        let address = if place.contains(':') {
            place.to_owned()
        } else {
            format!("127.0.0.1:{place}")
        };
        let listener = TcpListener::bind(&address).with_context(|| format!("cannot listen on {address}"))?;
        say(format_args!(
            "scans are awaited at tcp:{}",
            listener.local_addr()?
        ));
        let reader = move || Ok(Box::new(Callers { listener, now: None }) as Box<dyn Read>);
        Ok(Self::start(&format!("tcp:{address}"), reader, options))
    }

    fn start(
        name: &str,
        reader: impl FnOnce() -> io::Result<Box<dyn Read>> + Send + 'static,
        options: ReadOptions,
    ) -> Self {
        let (sender, entries) = sync_channel(MOST_WAITING);
        let own_name = name.to_owned();
        // Not joined: it may wait for a line that never comes. It ends with the program.
        thread::spawn(move || read(&own_name, reader, options, &sender));
        Self {
            name: name.to_owned(),
            entries,
        }
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// Gives every scan to `follower` until the stream ends or Ctrl-C. Says why it is partial, and whether something
    /// was not used.
    ///
    /// # Errors
    /// A stream that is no log; those of the follower.
    pub fn each(
        self,
        interrupt: &Interrupt,
        follower: &mut Follower,
    ) -> anyhow::Result<(Option<String>, bool)> {
        let (mut scans, mut loss) = (0, false);
        while !interrupt.asked() {
            match self.entries.recv_timeout(IDLE_AFTER) {
                Ok(Ok(entry)) => {
                    if let Entry::Bad(bad) = &entry {
                        say(format_args!(
                            "warning: {}, line {}: {} (left out)",
                            self.name, bad.line, bad.fault
                        ));
                        loss = true;
                    }
                    scans += 1;
                    follower.take(&entry)?;
                }
                Ok(Err(error)) if scans > 0 => {
                    return Ok((Some(format!("{:#}", anyhow::Error::new(error))), true));
                }
                Ok(Err(error)) => return Err(error.into()),
                Err(RecvTimeoutError::Timeout) => follower.idle()?,
                Err(RecvTimeoutError::Disconnected) => return Ok((None, loss)),
            }
        }
        Ok((Some(format!("stopped by hand after {scans} scans")), true))
    }
}

fn read(
    name: &str,
    reader: impl FnOnce() -> io::Result<Box<dyn Read>>,
    options: ReadOptions,
    to: &SyncSender<Result<Entry, LogError>>,
) {
    let unreadable = |source| LogError::Unreadable {
        name: name.to_owned(),
        source,
    };
    let log = reader()
        .map_err(unreadable)
        .and_then(|stream| open_live(name, BufReader::new(stream), options));
    match log {
        Ok(log) => {
            for entry in log {
                if to.send(entry).is_err() {
                    return;
                }
            }
        }
        Err(error) => {
            // Nobody listens any more when the program ends.
            let _ = to.send(Err(error));
        }
    }
}
