//! Sorts messages by what they are, and scans by whether enough is known to hand them out.

use std::collections::VecDeque;

use super::choice::Lasers;
use super::laser_scan;
use super::messages::{LaserScan, Odometry, read_transforms};
use super::mount::Mounts;
use super::odometry::Track;
use super::{Channel, Encoding, Message};
use crate::log::keeper::Keeper;
use crate::log::{Entry, LineFault, MAX_NAMES, ReadOptions, Tally, Unit};

/// Scans that are held back at the start, or while the odometry of their time has not come.
const HELD_SCANS: usize = 600;
/// Beams of those scans together, which bounds the memory: 8 MB.
const HELD_BEAMS: usize = 1024 * 1024;

/// What is done with the messages of a channel.
#[derive(Clone, Debug)]
pub(super) enum Role {
    Laser {
        laser: usize,
        echoes: bool,
    },
    StaticTransforms,
    Transforms,
    Odometry,
    /// Counted under this name.
    Other(String),
}

/// A scan that waits.
struct Held {
    laser: usize,
    message: u64,
    recorded_s: f64,
    scan: Result<LaserScan, LineFault>,
}

impl Held {
    fn beams(&self) -> usize {
        self.scan.as_ref().map_or(0, |s| s.ranges_m.len())
    }
}

/// Sorts messages by what they are, and scans by whether enough is known to hand them out.
pub(super) struct Sorter {
    use_odometry: bool,
    lasers: Lasers,
    /// Waiting, in file order: of all lasers until one is chosen, then of that one.
    held: VecDeque<Held>,
    held_beams: usize,
    mounts: Mounts,
    track: Track,
    keeper: Keeper,
    /// Messages of the parts before this one.
    pub messages_before: u64,
}

impl Sorter {
    pub fn new(options: &ReadOptions) -> Self {
        Self {
            use_odometry: options.use_odometry,
            lasers: Lasers::new(options.laser.as_deref()),
            held: VecDeque::new(),
            held_beams: 0,
            mounts: Mounts::default(),
            track: Track::default(),
            keeper: Keeper::new(Unit::Message, options),
            messages_before: 0,
        }
    }

    /// What the messages of `channel` are for.
    pub fn role(&mut self, channel: &Channel) -> Role {
        let mut reason = None;
        let role = match (channel.kind.as_str(), &channel.encoding) {
            (_, Err(encoding)) => {
                reason = Some(format!("serialised as {encoding}, which is not read here"));
                None
            }
            ("sensor_msgs/LaserScan", _) => self.laser(channel, false),
            ("sensor_msgs/MultiEchoLaserScan", _) => self.laser(channel, true),
            ("tf2_msgs/TFMessage" | "tf/tfMessage", _) if channel.topic.ends_with("tf_static") => {
                Some(Role::StaticTransforms)
            }
            ("tf2_msgs/TFMessage" | "tf/tfMessage", _) => {
                reason = Some("transforms: not used unless --use-odometry".to_owned());
                self.use_odometry.then_some(Role::Transforms)
            }
            ("nav_msgs/Odometry", _) => {
                reason = Some("odometry: not used unless --use-odometry".to_owned());
                self.use_odometry.then_some(Role::Odometry)
            }
            _ => None,
        };
        if let Some(role) = role {
            return role;
        }
        let name = channel.name();
        if let Some(reason) = reason
            && self.keeper.tally.reasons.len() < MAX_NAMES
        {
            self.keeper.tally.reasons.insert(name.clone(), reason);
        }
        Role::Other(name)
    }

    fn laser(&mut self, channel: &Channel, echoes: bool) -> Option<Role> {
        let laser = self.lasers.number(&channel.topic, &channel.kind)?;
        if echoes {
            let note = format!("{}: the first echo of every beam is used", channel.topic);
            self.keeper.note(note);
        }
        Some(Role::Laser { laser, echoes })
    }

    /// Takes the message with this number.
    pub fn take(&mut self, role: &Role, encoding: Encoding, message: &Message<'_>, number: u64) {
        match role {
            Role::Laser { laser, echoes } => {
                if self.lasers.is_refused(*laser) {
                    self.lasers.count_unused(*laser);
                    return;
                }
                let held = Held {
                    laser: *laser,
                    message: number,
                    recorded_s: message.recorded_s,
                    scan: LaserScan::read(message.data, encoding, *echoes),
                };
                self.lasers.observe(*laser, held.scan.as_ref().ok());
                self.held_beams += held.beams();
                self.held.push_back(held);
            }
            Role::StaticTransforms => match read_transforms(message.data, encoding) {
                Ok(transforms) => {
                    for transform in transforms {
                        self.mounts.insert(transform);
                    }
                }
                Err(fault) => self.bad_message(message.channel, &fault),
            },
            Role::Transforms => match read_transforms(message.data, encoding) {
                Ok(transforms) => self.track.add_transforms(transforms),
                Err(fault) => self.bad_message(message.channel, &fault),
            },
            Role::Odometry => match Odometry::read(message.data, encoding) {
                Ok(odometry) => self.track.add_odometry(&message.channel.topic, &odometry),
                Err(fault) => self.bad_message(message.channel, &fault),
            },
            Role::Other(name) => self.keeper.count_other(name.as_bytes()),
        }
    }

    fn bad_message(&mut self, channel: &Channel, fault: &LineFault) {
        self.keeper
            .note(format!("{}: a message cannot be used: {fault}", channel.topic));
    }

    /// The next scan about which enough is known.
    pub fn ready(&mut self, at_end: bool) -> Option<Entry> {
        let is_full = self.held.len() >= HELD_SCANS || self.held_beams >= HELD_BEAMS;
        if !self.lasers.is_decided() {
            if !is_full && !at_end {
                return None;
            }
            if !self.held.is_empty() {
                self.lasers.decide();
            }
        }
        loop {
            let first = self.held.front()?;
            if self.lasers.is_refused(first.laser) {
                self.lasers.count_unused(first.laser);
                self.drop_first();
                continue;
            }
            let waits = self.use_odometry && !at_end && !is_full && {
                let stamp_s = first.scan.as_ref().map_or(0.0, |s| s.header.stamp_s);
                !self.track.reaches(stamp_s)
            };
            if waits {
                return None;
            }
            let held = self.drop_first()?;
            return Some(self.entry(held));
        }
    }

    fn drop_first(&mut self) -> Option<Held> {
        let first = self.held.pop_front()?;
        self.held_beams -= first.beams();
        Some(first)
    }

    fn entry(&mut self, held: Held) -> Entry {
        let reading = held.scan.and_then(|scan| {
            let mount = self.mounts.of(&scan.header.frame);
            laser_scan::check(&scan, &mount, &mut self.keeper);
            let stamp_s = if scan.header.stamp_s > 0.0 {
                scan.header.stamp_s
            } else {
                held.recorded_s
            };
            let odometry = if self.use_odometry {
                self.track.laser_at(stamp_s, &scan.header.frame, &self.mounts)
            } else {
                None
            };
            laser_scan::reading(scan, mount.is_upside_down(), stamp_s, odometry)
        });
        self.keeper.entry(held.message, reading)
    }

    pub fn tally(&self) -> Tally {
        let mut tally = self.keeper.tally.clone();
        self.lasers.tell(&mut tally);
        tally.notes.extend(self.track.note());
        tally
    }
}
