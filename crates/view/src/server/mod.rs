//! The web server: the page, the record as it grows, details on demand. Nothing else; nothing is written.
//!
//! It stands on one thread of its own and never waits for the mapper, nor the mapper for it. What it can be made to
//! hold is bounded: connections ([`MOST_CONNECTIONS`]), the head of a request ([`MOST_HEAD_BYTES`]), what is on its
//! way to one page (two pieces of 64 kB). A page that stops reading is dropped after a while.

mod answers;
mod gate;
mod patience;
mod stream;

use std::convert::Infallible;
use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::sync::Semaphore;

use crate::store::Store;
use gate::Gate;
use patience::Patient;

/// Connections at the same time; more are closed at once.
pub const MOST_CONNECTIONS: usize = 512;
/// The longest head of a request.
pub const MOST_HEAD_BYTES: usize = 16 * 1024;
/// How long a client may take to send the head of a request, and how long it may read nothing of an answer.
const PATIENCE: Duration = Duration::from_secs(20);

/// Why the server does not stand.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The address cannot be had.
    #[error("cannot listen on {address}")]
    Listen {
        /// Host and port.
        address: String,
        /// What the system says.
        source: io::Error,
    },
    /// The system gives no thread or no event queue.
    #[error("cannot start the server")]
    Start(#[source] io::Error),
}

/// A server at work. It ends with the program.
pub struct Server {
    /// Where it listens.
    pub address: SocketAddr,
    _thread: JoinHandle<()>,
}

impl Server {
    /// Begins to serve `store` on `host`; port 0 takes any that is free.
    ///
    /// # Errors
    /// The address cannot be had; the system gives no thread.
    pub fn start(host: IpAddr, port: u16, store: Store) -> Result<Self, ServerError> {
        let at = SocketAddr::new(host, port);
        let refused = |source| ServerError::Listen {
            address: at.to_string(),
            source,
        };
        let listener = TcpListener::bind(at).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(1)
            .build()
            .map_err(ServerError::Start)?;
        let thread = thread::Builder::new()
            .name("server".to_owned())
            .spawn(move || runtime.block_on(serve(listener, Gate::new(address), store)))
            .map_err(ServerError::Start)?;
        Ok(Self {
            address,
            _thread: thread,
        })
    }

    /// What to type into a browser on this machine.
    #[must_use]
    pub fn url(&self) -> String {
        let port = self.address.port();
        match self.address.ip() {
            ip if ip.is_unspecified() || ip == IpAddr::from([127, 0, 0, 1]) => {
                format!("http://localhost:{port}/")
            }
            ip => format!("http://{}/", SocketAddr::new(ip, port)),
        }
    }
}

async fn serve(listener: TcpListener, gate: Gate, store: Store) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
        return;
    };
    let herald = store.clone();
    tokio::spawn(async move { herald.herald().await });
    let gate = Arc::new(gate);
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Out of descriptors: others have to end first.
            tokio::time::sleep(Duration::from_millis(100)).await;
            continue;
        };
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            continue;
        };
        let _ = stream.set_nodelay(true);
        let (gate, store) = (Arc::clone(&gate), store.clone());
        tokio::spawn(async move {
            let service = service_fn(|request| {
                let (gate, store) = (Arc::clone(&gate), store.clone());
                async move { Ok::<_, Infallible>(answers::answer(&request, &gate, &store).await) }
            });
            // A client that breaks off or sends no HTTP harms nobody but itself.
            let _ = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(PATIENCE)
                .max_buf_size(MOST_HEAD_BYTES)
                .serve_connection(TokioIo::new(Patient::new(stream, PATIENCE)), service)
                .await;
            drop(place);
        });
    }
}
