//! What the server answers, and what it stands.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use polymapper_view::record::{About, Detail, End, FORMAT, Frame, Line, VERSION};
use polymapper_view::server::{MOST_CONNECTIONS, Server};
use polymapper_view::{Sink, Store};

/// A record of so many scans, ended or not.
fn store(scans: usize, ended: bool) -> Store {
    let mut store = Store::default();
    let mut take = |line| store.take(&Arc::new(line)).unwrap();
    take(Line::About(About {
        format: FORMAT.to_owned(),
        version: VERSION,
        generator: "test".to_owned(),
        log: "test.log".to_owned(),
        missing: None,
    }));
    for n in 0..scans {
        take(Line::Detail(Box::new(Detail {
            n,
            polylines: vec![vec![-1000, 2000, 3000, 0], vec![0, 0, 500, 500]],
            ..Detail::default()
        })));
        take(Line::Frame(Frame {
            scan: n,
            pose: Some([n as f64, 0.0, 0.0]),
            ..Frame::default()
        }));
    }
    if ended {
        take(Line::End(End { partial: None }));
    }
    store
}

fn serve(store: &Store) -> Server {
    Server::start(Ipv4Addr::LOCALHOST.into(), 0, store.clone()).unwrap()
}

fn connect(at: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(at).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(4))).unwrap();
    stream
}

/// Sends bytes and reads until the server closes.
fn exchange(at: SocketAddr, request: &[u8]) -> String {
    let mut stream = connect(at);
    // The server may close before all is sent.
    let _ = stream.write_all(request);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

fn get_with(at: SocketAddr, path: &str, headers: &str) -> String {
    let request = format!("GET {path} HTTP/1.1\r\nHost: {at}\r\nConnection: close\r\n{headers}\r\n");
    exchange(at, request.as_bytes())
}

fn get(at: SocketAddr, path: &str) -> String {
    get_with(at, path, "")
}

fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap_or("closed")
}

#[test]
fn the_page_and_its_parts_are_given_with_a_policy() {
    let server = serve(&store(3, true));
    for (path, kind) in [
        ("/", "text/html"),
        ("/app.js", "text/javascript"),
        ("/style.css", "text/css"),
        ("/icon.svg", "image/svg+xml"),
    ] {
        let answer = get(server.address, path);
        assert_eq!(status(&answer), "200", "{path}");
        assert!(answer.contains(&format!("content-type: {kind}")), "{path}");
        assert!(
            answer.contains("content-security-policy: default-src 'none'"),
            "{path}"
        );
    }
}

#[test]
fn the_record_goes_from_any_line_to_its_end() {
    let server = serve(&store(3, true));
    let lines = |path: &str| {
        get(server.address, path)
            .lines()
            .filter(|l| l.starts_with("{\""))
            .count()
    };
    assert_eq!(lines("/record"), 5);
    assert_eq!(lines("/record?from=4"), 1);
    assert_eq!(lines("/record?from=99"), 0);
    assert_eq!(lines("/detail?first=1&last=2"), 2);
    assert_eq!(lines("/detail?first=1&last=99999999999"), 2);
}

#[test]
fn shapes_of_two_scans_are_compared_when_asked_for() {
    let server = serve(&store(3, true));
    let answer = get(server.address, "/compare?n=2&before=1&x=0.0&y=0&theta=0");
    assert!(
        answer.contains("\"pairs\":[{\"scan\":[0],\"reference\":[0]"),
        "{answer}"
    );
    for path in ["/compare?n=7", "/compare", "/compare?n=-1"] {
        assert_eq!(status(&get(server.address, path)), "404", "{path}");
    }
    let odd = get(server.address, "/compare?n=2&before=1&x=NaN&y=1e308&theta=inf");
    assert_eq!(status(&odd), "200");
}

#[test]
fn nothing_else_is_given() {
    let server = serve(&store(3, true));
    for path in [
        "/etc/passwd",
        "/../Cargo.toml",
        "/..%2f..%2fetc/passwd",
        "//",
        "/app.js/",
        "/record/",
        "/%00",
        "/index.html",
        "http://evil.example/",
    ] {
        let answer = get(server.address, path);
        assert!(
            matches!(status(&answer), "400" | "403" | "404") || answer.contains("<!doctype html>"),
            "{path}: {answer}"
        );
        assert!(
            !answer.contains("root:") && !answer.contains("[package]"),
            "{path}"
        );
    }
    for path in ["/detail", "/detail?first=a&last=b", "/detail?first=&last="] {
        assert_eq!(status(&get(server.address, path)), "400", "{path}");
    }
    let at = server.address;
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "BREW"] {
        let request = format!("{method} / HTTP/1.1\r\nHost: {at}\r\nContent-Length: 5\r\n\r\nhello");
        assert_eq!(status(&exchange(at, request.as_bytes())), "405", "{method}");
    }
}

#[test]
fn pages_of_other_sites_and_foreign_names_are_refused() {
    let server = serve(&store(3, true));
    let at = server.address;
    for headers in [
        "Origin: http://evil.example\r\n",
        "Origin: null\r\n",
        "Sec-Fetch-Site: cross-site\r\n",
    ] {
        for path in ["/", "/record", "/detail?first=0&last=1"] {
            assert_eq!(status(&get_with(at, path, headers)), "403", "{headers}{path}");
        }
    }
    let rebound = format!("GET /record HTTP/1.1\r\nHost: evil.example:{}\r\n\r\n", at.port());
    assert_eq!(status(&exchange(at, rebound.as_bytes())), "403");
    let own = format!("Origin: http://{at}\r\nSec-Fetch-Site: same-origin\r\n");
    assert_eq!(status(&get_with(at, "/record", &own)), "200");
}

#[test]
fn giant_and_broken_requests_are_refused_and_harm_nobody() {
    let server = serve(&store(3, true));
    let at = server.address;
    let giant_path = format!("GET /{} HTTP/1.1\r\nHost: {at}\r\n\r\n", "a".repeat(1 << 20));
    let giant_header = format!(
        "GET / HTTP/1.1\r\nHost: {at}\r\nX: {}\r\n\r\n",
        "a".repeat(8 << 20)
    );
    let many_headers = format!(
        "GET / HTTP/1.1\r\nHost: {at}\r\n{}\r\n",
        "X-A: b\r\n".repeat(1000)
    );
    let no_end = vec![b'x'; 4 << 20];
    let binary: Vec<u8> = (0..100_000_u32).map(|k| (k * 31 % 251) as u8).collect();
    for request in [
        giant_path.as_bytes(),
        giant_header.as_bytes(),
        many_headers.as_bytes(),
        &no_end,
        &binary,
        b"\r\n\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
    ] {
        let answer = exchange(at, request);
        assert!(
            matches!(status(&answer), "400" | "403" | "414" | "431" | "closed"),
            "{answer}"
        );
    }
    assert_eq!(status(&get(at, "/")), "200", "others are served as before");
}

#[test]
fn two_hundred_pages_follow_a_record_that_grows() {
    let mut store = store(2000, false);
    let server = serve(&store);
    let mut pages: Vec<TcpStream> = (0..200)
        .map(|_| {
            let mut stream = connect(server.address);
            write!(
                stream,
                "GET /record HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n",
                server.address
            )
            .unwrap();
            stream
        })
        .collect();
    store.take(&Arc::new(Line::End(End { partial: None }))).unwrap();
    for page in &mut pages {
        let mut text = String::new();
        page.read_to_string(&mut text).unwrap();
        assert_eq!(text.matches("{\"frame\"").count(), 2000);
        assert!(text.contains("{\"end\":"));
    }
}

/// Memory that the process holds, bytes.
fn resident_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(text.split(' ').nth(1)?.parse::<u64>().ok()? * 4096)
}

#[test]
fn pages_that_do_not_read_cost_little_memory_and_hold_up_nobody() {
    let store = store(100_000, true);
    let server = serve(&store);
    let before = resident_bytes();
    let deaf: Vec<TcpStream> = (0..200)
        .map(|_| {
            let mut stream = connect(server.address);
            write!(stream, "GET /record HTTP/1.1\r\nHost: {}\r\n\r\n", server.address).unwrap();
            stream
        })
        .collect();
    std::thread::sleep(Duration::from_millis(700));
    let start = Instant::now();
    assert_eq!(status(&get(server.address, "/")), "200");
    assert!(start.elapsed() < Duration::from_secs(1));
    if let (Some(before), Some(now)) = (before, resident_bytes()) {
        // Two pieces of 64 kB and buffers each; the whole record would be 1.3 GB.
        let grown = now.saturating_sub(before);
        assert!(grown < 120_000_000, "{grown} bytes for {} pages", deaf.len());
    }
}

#[test]
fn more_connections_than_there_is_room_for_are_closed_and_room_comes_back() {
    let server = serve(&store(3, true));
    let idle: Vec<TcpStream> = (0..MOST_CONNECTIONS + 20)
        .filter_map(|_| TcpStream::connect(server.address).ok())
        .collect();
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(status(&get(server.address, "/")), "closed");
    drop(idle);
    let start = Instant::now();
    while status(&get(server.address, "/")) != "200" {
        assert!(start.elapsed() < Duration::from_secs(10), "no room comes back");
        std::thread::sleep(Duration::from_millis(50));
    }
}
