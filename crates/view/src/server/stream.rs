//! The record as the body of an answer that goes on as long as the record grows.

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use bytes::Bytes;
use hyper::body::{Body, Frame};
use tokio::sync::mpsc;
use tokio::time::timeout;

use crate::store::Store;

/// How much is on its way at once.
pub const PIECE_BYTES: usize = 64 * 1024;
/// An empty line is sent when nothing else was for so long, so that a page that is gone is noticed.
const SIGN_OF_LIFE: Duration = Duration::from_secs(10);

/// Pieces as they come.
pub struct RecordBody(mpsc::Receiver<Bytes>);

impl RecordBody {
    /// The record from line `from` on.
    pub fn new(store: Store, from: usize) -> Self {
        let (sender, receiver) = mpsc::channel(1);
        tokio::spawn(pump(store, from, sender));
        Self(receiver)
    }
}

impl Body for RecordBody {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.0
            .poll_recv(cx)
            .map(|piece| piece.map(|bytes| Ok(Frame::data(bytes))))
    }
}

/// Sends pieces until the record ends or the reader is gone.
async fn pump(store: Store, mut from: usize, to: mpsc::Sender<Bytes>) {
    let mut growth = store.watch();
    loop {
        growth.mark_unchanged();
        let (piece, lines, at_end) = store.lines(from, PIECE_BYTES);
        from += lines;
        if lines > 0 && to.send(piece).await.is_err() {
            return;
        }
        if at_end {
            return;
        }
        if lines == 0 {
            match timeout(SIGN_OF_LIFE, growth.changed()).await {
                Ok(Ok(())) => {}
                Ok(Err(_)) => return,
                Err(_) => {
                    if to.send(Bytes::from_static(b"\n")).await.is_err() {
                        return;
                    }
                }
            }
        }
    }
}
