//! `polymapper view`: watch a map grow in the browser.
//!
//! The page is served before the first scan is read. A log or a stream is mapped here, on this thread; what a build has
//! left is read from its replay, or from map and trajectory where there is none. When all is read, the page stays until
//! Ctrl-C.

mod browser;
mod follow;
mod source;
mod stream;

use std::fs::File;
use std::io::ErrorKind;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use anyhow::{Context, anyhow};
use polymapper_io::log::ReadOptions;
use polymapper_view::record::{End, Line};
use polymapper_view::replay::read_replay;
use polymapper_view::server::{Server, ServerError};
use polymapper_view::{Recorder, Sink, Snapshots, Store};

use crate::Finish;
use crate::args::ViewArgs;
use crate::interrupt::Interrupt;
use crate::record::GENERATOR;
use crate::scans;
use crate::talk::say;
use follow::Follower;
use source::Source;

/// Share of the time that goes into the map of all scans, while it is watched.
const MAP_SHARE: f64 = 0.2;
/// How long a live scan may wait for it.
const LIVE_WAIT: Duration = Duration::from_millis(50);
/// A scan of a log may wait: it is not live.
const LOG_WAIT: Duration = Duration::from_secs(5);
/// How often it is looked whether Ctrl-C was pressed.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// Runs the command.
pub fn run(args: &ViewArgs) -> anyhow::Result<Finish> {
    let interrupt = Interrupt::listen_and_say("stopping")?;
    let mut store = Store::default();
    // A wrong name is to be told before a page is opened.
    let source = Source::of(&args.source, read_options(args))?;
    let server = serve(args, store.clone())?;
    let url = server.url();
    say(format_args!("watch it at {url} (Ctrl-C ends)"));
    if args.open {
        browser::open(&url);
    }
    let finish = match source {
        Source::Replay { file, name } => replayed(file, &name, &mut store)?,
        Source::Finished(finished) => {
            say(format_args!("note: {}", finished.missing));
            finished.tell(&mut store)?;
            Finish::Whole
        }
        Source::Log(mut log) => {
            let mut follower = follower(log.name(), store, LOG_WAIT)?;
            let reading = scans::for_each(&mut log, &interrupt, |entry| follower.take(&entry))?;
            follower.finish(reading.partial.clone())?;
            Finish::with_loss(reading.has_loss())
        }
        Source::Stream(stream) => {
            let mut follower = follower(stream.name(), store, LIVE_WAIT)?;
            let (partial, loss) = stream.each(&interrupt, &mut follower)?;
            follower.finish(partial)?;
            Finish::with_loss(loss)
        }
    };
    say(format_args!("all is read; the page stays until Ctrl-C"));
    while !interrupt.asked() {
        thread::sleep(LOOK_AGAIN);
    }
    Ok(finish)
}

fn serve(args: &ViewArgs, store: Store) -> anyhow::Result<Server> {
    Server::start(args.host, args.port, store).map_err(|error| match error {
        ServerError::Listen { source, .. } if source.kind() == ErrorKind::AddrInUse => {
            anyhow!("port {} is in use; --port 0 takes any that is free", args.port)
        }
        other => other.into(),
    })
}

/// Plays a record; one that breaks off is shown up to there.
fn replayed(file: File, name: &str, store: &mut Store) -> anyhow::Result<Finish> {
    match read_replay(file, store) {
        Ok(()) => Ok(Finish::Whole),
        Err(error) if store.is_empty() => Err(error).context(name.to_owned()),
        Err(error) => {
            let fault = format!("{:#}", anyhow::Error::new(error));
            say(format_args!("warning: {name}: {fault}"));
            store.take(&Arc::new(Line::End(End { partial: Some(fault) })))?;
            Ok(Finish::WithLoss)
        }
    }
}

fn read_options(args: &ViewArgs) -> ReadOptions {
    ReadOptions {
        use_odometry: args.use_odometry,
        ..args.reading.read_options()
    }
}

fn follower(name: &str, store: Store, longest: Duration) -> anyhow::Result<Follower> {
    let snapshots = Snapshots::Share {
        share: MAP_SHARE,
        longest,
    };
    Ok(Follower::new(Recorder::new(
        store,
        &scans::short_name(name),
        GENERATOR,
        snapshots,
    )?))
}
