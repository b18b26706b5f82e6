//! A scan of a log, as it is named on the command line: `LOG:SCAN`.

use std::convert::Infallible;
use std::path::PathBuf;
use std::str::FromStr;

/// A scan of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScanPlace {
    pub log: PathBuf,
    /// 0-based; `None`: the only one.
    pub scan: Option<usize>,
}

impl FromStr for ScanPlace {
    type Err = Infallible;

    /// What follows the last colon is a scan if it is a number, and part of the name otherwise.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        let place = text
            .rsplit_once(':')
            .and_then(|(log, scan)| Some((log, scan.parse().ok()?)));
        Ok(match place {
            Some((log, scan)) => Self {
                log: log.into(),
                scan: Some(scan),
            },
            None => Self {
                log: text.into(),
                scan: None,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_follows_the_last_colon_if_it_is_a_number() {
        let place = |text: &str| text.parse::<ScanPlace>().map(|p| (p.log, p.scan));
        assert_eq!(place("a.log:12"), Ok(("a.log".into(), Some(12))));
        assert_eq!(place("a:b.log"), Ok(("a:b.log".into(), None)));
        assert_eq!(place("day:1:12"), Ok(("day:1".into(), Some(12))));
        assert_eq!(place("-:3"), Ok(("-".into(), Some(3))));
    }
}
