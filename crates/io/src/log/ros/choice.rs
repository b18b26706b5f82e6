//! Which of several lasers is read.
//!
//! In go the first scans of every topic, out comes the topic that shows most: the widest field of view (to 10°, so
//! that the same scanner twice is a draw), then the most beams that returned in a scan, then the one that came
//! first. A depth camera's narrow scan and a filtered copy lose against the scanner itself.

use super::super::{MAX_NAMES, Tally};
use super::laser_scan;
use super::messages::LaserScan;

/// The topics with scans.
pub(super) struct Lasers {
    asked_for: Option<String>,
    lasers: Vec<Laser>,
    chosen: Option<usize>,
}

struct Laser {
    topic: String,
    kind: String,
    scans: u64,
    returns: u64,
    widest_rad: f64,
    /// Scans that were not used.
    unused: u64,
}

impl Laser {
    fn field_of_view_deg(&self) -> f64 {
        self.widest_rad.to_degrees()
    }

    /// What is compared, the most important first.
    fn rank(&self) -> (i64, u64) {
        let tens = (self.field_of_view_deg() / 10.0).round() as i64;
        (tens, self.returns / self.scans.max(1))
    }
}

impl Lasers {
    pub fn new(asked_for: Option<&str>) -> Self {
        Self {
            asked_for: asked_for.map(|name| name.trim_start_matches('/').to_owned()),
            lasers: Vec::new(),
            chosen: None,
        }
    }

    /// The number of a topic, new or known; `None` when there are too many.
    pub fn number(&mut self, topic: &str, kind: &str) -> Option<usize> {
        if let Some(known) = self.lasers.iter().position(|l| l.topic == topic) {
            return Some(known);
        }
        if self.lasers.len() >= MAX_NAMES {
            return None;
        }
        let number = self.lasers.len();
        self.lasers.push(Laser {
            topic: topic.to_owned(),
            kind: kind.to_owned(),
            scans: 0,
            returns: 0,
            widest_rad: 0.0,
            unused: 0,
        });
        Some(number)
    }

    /// Takes note of a scan; `None` for one that cannot be used.
    pub fn observe(&mut self, laser: usize, scan: Option<&LaserScan>) {
        let laser = &mut self.lasers[laser];
        laser.scans += 1;
        if let Some(scan) = scan {
            laser.returns += laser_scan::returns(scan);
            laser.widest_rad = laser.widest_rad.max(laser_scan::field_of_view_rad(scan));
        }
    }

    pub fn is_decided(&self) -> bool {
        self.chosen.is_some()
    }

    /// Whether the scans of a laser are surely not wanted.
    pub fn is_refused(&self, laser: usize) -> bool {
        match (&self.asked_for, self.chosen) {
            (Some(name), _) => self.lasers[laser].topic.trim_start_matches('/') != name,
            (None, Some(chosen)) => chosen != laser,
            (None, None) => false,
        }
    }

    pub fn count_unused(&mut self, laser: usize) {
        self.lasers[laser].unused += 1;
    }

    /// Picks one of those observed so far.
    pub fn decide(&mut self) {
        let wanted = (0..self.lasers.len()).filter(|&k| !self.is_refused(k));
        // The later of two equals is the greater one for `max_by_key`.
        self.chosen = wanted.rev().max_by_key(|&k| self.lasers[k].rank());
    }

    /// Writes down which laser was read, and what of the others.
    pub fn tell(&self, tally: &mut Tally) {
        tally.laser = self.chosen.map(|k| self.lasers[k].topic.clone());
        for laser in self.lasers.iter().filter(|l| l.unused > 0) {
            let name = format!("{} ({})", laser.topic, laser.kind);
            // Nobody looks at the scans of a laser that was not asked for.
            let width = match laser.scans {
                0 => String::new(),
                _ => format!(", {:.0}° wide", laser.field_of_view_deg()),
            };
            let reason = format!("another laser{width}; --topic {} reads it", laser.topic);
            tally.other_messages.insert(name.clone(), laser.unused);
            tally.reasons.insert(name, reason);
        }
        if let Some(chosen) = tally.laser.as_ref()
            && self.asked_for.is_none()
            && self.lasers.len() > 1
        {
            tally.notes.push(format!(
                "{} lasers; {chosen} is read, which is the widest, or has the most returns",
                self.lasers.len()
            ));
        }
    }
}
