//! What there is to ask for.
//!
//! | path | answer |
//! |---|---|
//! | `/`, `/app.js`, `/style.css`, `/icon.svg` | the page |
//! | `/record?from=K` | the lines of the record from line K on, and on as they come |
//! | `/detail?first=A&last=B` | the details of these scans, 64 at most |
//! | `/compare?n=A&before=B&x=..&y=..&theta=..` | shapes of scan A beside those of B, A lying there in B's frame |

use bytes::Bytes;
use http_body_util::{Either, Full};
use hyper::body::Incoming;
use hyper::header::{self, HeaderValue};
use hyper::{Method, Request, Response, StatusCode};

use super::gate::Gate;
use super::stream::RecordBody;
use crate::compare::compare;
use crate::page;
use crate::store::Store;

/// Details that are given at once.
const MOST_DETAILS: usize = 64;

/// The page may load nothing but its own parts, and nobody may frame it.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

type Answer = Response<Either<Full<Bytes>, RecordBody>>;

pub async fn answer(request: &Request<Incoming>, gate: &Gate, store: &Store) -> Answer {
    let mut answer = route(request, gate, store).await;
    if request.method() == Method::HEAD {
        *answer.body_mut() = Either::Left(Full::default());
    }
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    let headers = answer.headers_mut();
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    for name in ["cross-origin-resource-policy", "cross-origin-opener-policy"] {
        headers.insert(name, HeaderValue::from_static("same-origin"));
    }
    answer
}

async fn route(request: &Request<Incoming>, gate: &Gate, store: &Store) -> Answer {
    if let Some(why) = gate.refusal(request.headers()) {
        return refused(StatusCode::FORBIDDEN, why);
    }
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return refused(StatusCode::METHOD_NOT_ALLOWED, "only GET is answered here");
    }
    let query = Query(request.uri().query().unwrap_or_default());
    match request.uri().path() {
        "/" => text("text/html; charset=utf-8", page::live_html().into()),
        "/app.js" => text("text/javascript; charset=utf-8", page::script().into()),
        "/style.css" => text("text/css; charset=utf-8", page::STYLE.into()),
        "/icon.svg" => text("image/svg+xml", page::ICON.into()),
        "/record" => {
            let from = query.number("from").unwrap_or(0);
            Response::builder()
                .header(header::CONTENT_TYPE, "application/x-ndjson")
                .body(Either::Right(RecordBody::new(store.clone(), from)))
                .unwrap_or_default_answer()
        }
        "/detail" => match (query.number("first"), query.number("last")) {
            (Some(first), Some(last)) => {
                let last = last.min(first.saturating_add(MOST_DETAILS - 1));
                text("application/x-ndjson", store.details(first, last))
            }
            _ => refused(StatusCode::BAD_REQUEST, "first and last are expected"),
        },
        "/compare" => compared(&query, store).await,
        _ => refused(StatusCode::NOT_FOUND, "there is nothing here"),
    }
}

async fn compared(query: &Query<'_>, store: &Store) -> Answer {
    let Some(scan) = query.number("n").and_then(|n| store.detail(n)) else {
        return refused(StatusCode::NOT_FOUND, "there is no such scan");
    };
    let before = query.number("before").and_then(|n| store.detail(n));
    let pose = ["x", "y", "theta"].map(|name| query.real(name).unwrap_or(0.0));
    // On the one helper thread: a page that asks for many holds up its own answers and nobody else's.
    let made = tokio::task::spawn_blocking(move || {
        serde_json::to_vec(&compare(&scan, before.as_ref().map(|b| (b, pose))))
    });
    match made.await {
        Ok(Ok(json)) => text("application/json", json.into()),
        _ => refused(StatusCode::INTERNAL_SERVER_ERROR, "the comparison failed"),
    }
}

fn text(kind: &'static str, body: Bytes) -> Answer {
    Response::builder()
        .header(header::CONTENT_TYPE, kind)
        .body(Either::Left(Full::new(body)))
        .unwrap_or_default_answer()
}

fn refused(status: StatusCode, why: &'static str) -> Answer {
    let mut answer = text("text/plain; charset=utf-8", Bytes::from_static(why.as_bytes()));
    *answer.status_mut() = status;
    // What else the client sends is not read.
    answer
        .headers_mut()
        .insert(header::CONNECTION, HeaderValue::from_static("close"));
    answer
}

/// Building an answer from constants does not fail; if it does, the answer is empty.
trait OrEmpty {
    fn unwrap_or_default_answer(self) -> Answer;
}

impl OrEmpty for Result<Answer, hyper::http::Error> {
    fn unwrap_or_default_answer(self) -> Answer {
        self.unwrap_or_else(|_| Response::new(Either::Left(Full::default())))
    }
}

/// `a=1&b=2`. Only numbers are asked for, so that nothing has to be decoded.
struct Query<'a>(&'a str);

impl Query<'_> {
    fn get(&self, name: &str) -> Option<&str> {
        self.0
            .split('&')
            .filter_map(|pair| pair.split_once('='))
            .find_map(|(key, value)| (key == name).then_some(value))
    }

    fn number(&self, name: &str) -> Option<usize> {
        self.get(name)?.parse().ok()
    }

    fn real(&self, name: &str) -> Option<f64> {
        self.get(name)?
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
    }
}
