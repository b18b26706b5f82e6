//! Who may ask: pages that this server gave out, and people who typed its address.
//!
//! Another site's page in the same browser can send requests here. It is told apart by what the browser adds: `Origin`
//! and `Sec-Fetch-Site` name where the page is from, `Host` the name by which it found us, which is a foreign one when
//! that name was made to lead here (DNS rebinding).

use std::net::{IpAddr, SocketAddr};

use hyper::HeaderMap;
use hyper::header::{HOST, ORIGIN};

/// Knows where the server listens.
pub struct Gate {
    address: SocketAddr,
}

impl Gate {
    pub fn new(address: SocketAddr) -> Self {
        Self { address }
    }

    /// Why a request is refused; `None` when it is welcome.
    pub fn refusal(&self, headers: &HeaderMap) -> Option<&'static str> {
        let text = |name| headers.get(name).map(|v| v.to_str().unwrap_or_default());
        let Some(host) = headers.get(HOST).and_then(|v| v.to_str().ok()) else {
            return Some("a Host is expected");
        };
        if headers.get_all(HOST).iter().count() > 1 || !self.is_us(host) {
            return Some("this server does not go by that name");
        }
        let foreign_origin =
            headers.contains_key(ORIGIN) && text("origin") != Some(format!("http://{host}").as_str());
        let is_visit =
            text("sec-fetch-mode") == Some("navigate") && text("sec-fetch-dest") == Some("document");
        let foreign_site = matches!(text("sec-fetch-site"), Some("cross-site" | "same-site"));
        (foreign_origin || foreign_site && !is_visit).then_some("pages of other sites may not ask here")
    }

    /// Whether a host of a request means this server: by its address, any address if it listens on all, or as
    /// localhost. Names can be made to lead anywhere, addresses not.
    fn is_us(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.contains(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        if port != Some(self.address.port()) {
            return false;
        }
        let ours = self.address.ip();
        if name.eq_ignore_ascii_case("localhost") {
            return ours.is_loopback() || ours.is_unspecified();
        }
        let name = name
            .strip_prefix('[')
            .and_then(|n| n.strip_suffix(']'))
            .unwrap_or(name);
        name.parse::<IpAddr>()
            .is_ok_and(|ip| ip == ours || ours.is_unspecified())
    }
}

#[cfg(test)]
mod tests {
    use hyper::header::{HeaderName, HeaderValue};

    use super::*;

    fn refused(listening: &str, headers: &[(&'static str, &'static str)]) -> bool {
        let map = headers
            .iter()
            .map(|&(k, v)| (HeaderName::from_static(k), HeaderValue::from_static(v)))
            .collect();
        Gate::new(listening.parse().unwrap()).refusal(&map).is_some()
    }

    #[test]
    fn our_own_page_and_a_typed_address_are_welcome() {
        for host in ["localhost:7070", "127.0.0.1:7070", "LOCALHOST:7070"] {
            assert!(!refused("127.0.0.1:7070", &[("host", host)]), "{host}");
        }
        assert!(!refused(
            "127.0.0.1:7070",
            &[
                ("host", "localhost:7070"),
                ("origin", "http://localhost:7070"),
                ("sec-fetch-site", "same-origin")
            ]
        ));
        assert!(!refused("0.0.0.0:7070", &[("host", "192.168.1.7:7070")]));
        assert!(!refused("[::1]:7070", &[("host", "[::1]:7070")]));
    }

    #[test]
    fn a_name_that_was_made_to_lead_here_is_refused() {
        for host in [
            "evil.example:7070",
            "localhost:80",
            "localhost",
            "127.0.0.1.evil:7070",
            "",
        ] {
            assert!(refused("127.0.0.1:7070", &[("host", host)]), "{host}");
            assert!(refused("0.0.0.0:7070", &[("host", host)]), "{host}");
        }
        assert!(refused("127.0.0.1:7070", &[]));
    }

    #[test]
    fn a_page_of_another_site_is_refused_but_a_link_may_lead_here() {
        let host = ("host", "localhost:7070");
        for origin in [
            "http://evil.example",
            "null",
            "https://localhost:7070",
            "http://localhost:8080",
        ] {
            assert!(
                refused(
                    "127.0.0.1:7070",
                    &[host, ("origin", Box::leak(origin.to_owned().into_boxed_str()))]
                ),
                "{origin}"
            );
        }
        let cross = ("sec-fetch-site", "cross-site");
        assert!(refused(
            "127.0.0.1:7070",
            &[host, cross, ("sec-fetch-mode", "no-cors")]
        ));
        let frame = [
            host,
            cross,
            ("sec-fetch-mode", "navigate"),
            ("sec-fetch-dest", "iframe"),
        ];
        assert!(refused("127.0.0.1:7070", &frame));
        let link = [
            host,
            cross,
            ("sec-fetch-mode", "navigate"),
            ("sec-fetch-dest", "document"),
        ];
        assert!(!refused("127.0.0.1:7070", &link));
    }
}
