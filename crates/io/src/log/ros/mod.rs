//! Scans of ROS recordings, whatever the file around the messages.
//!
//! In go messages in file order ([`Messages`]: a ROS 1 bag, MCAP, sqlite3), out come the scans of one laser.
//!
//! - The laser is the topic that was asked for, or the best of those that the first scans are of
//!   ([`choice`]); the others are counted.
//! - Static transforms tell how the scanner is mounted ([`mount`]): upside down is turned round, and where
//!   odometry is used, the place on the robot counts. They may come after the first scans, so that the first
//!   [`HELD_SCANS`] are held back.
//! - Odometry and moving transforms are looked at only when they are asked for ([`odometry`]).

mod choice;
mod laser_scan;
mod messages;
mod mount;
mod odometry;
mod transform;
mod wire;

use std::collections::VecDeque;
use std::io;

use super::keeper::Keeper;
use super::{Entry, LineFault, LogError, MAX_NAMES, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;
use choice::Lasers;
use messages::{LaserScan, Odometry, read_transforms};
use mount::Mounts;
use odometry::Track;
pub(super) use transform::Transform;
pub(super) use wire::Encoding;

/// A longer message is no scan, transform or pose; nothing longer is taken into memory.
pub(super) const MAX_MESSAGE_BYTES: usize = 64 * 1024 * 1024;
/// Scans that are held back at the start, or while the odometry of their time has not come.
const HELD_SCANS: usize = 600;
/// Beams of those scans together, which bounds the memory: 8 MB.
const HELD_BEAMS: usize = 1024 * 1024;

/// What messages of a topic are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Channel {
    pub topic: String,
    /// Type as ROS 1 writes it: `sensor_msgs/LaserScan`.
    pub kind: String,
    /// How they are serialised; the name of an encoding that is not read here.
    pub encoding: Result<Encoding, String>,
}

impl Channel {
    pub fn new(topic: &str, kind: &str, encoding: Result<Encoding, String>) -> Self {
        Self {
            topic: shortened(topic).to_owned(),
            kind: shortened(kind).replace("/msg/", "/"),
            encoding,
        }
    }

    fn name(&self) -> String {
        format!("{} ({})", self.topic, self.kind)
    }
}

/// The first characters of a name; a name that is longer is made to fill the memory.
pub(super) fn shortened(name: &str) -> &str {
    const LONGEST: usize = 255;
    &name[..name.floor_char_boundary(LONGEST)]
}

/// A serialised message.
pub(super) struct Message<'a> {
    /// Place of the channel among those of the source; small.
    pub id: usize,
    pub channel: &'a Channel,
    /// When it was recorded, seconds.
    pub recorded_s: f64,
    pub data: &'a [u8],
}

/// A file of messages.
pub(super) trait Messages {
    /// The next message; `None` at the end.
    ///
    /// # Errors
    /// The file is cut or broken.
    fn next_message(&mut self) -> io::Result<Option<Message<'_>>>;
    /// Bytes read so far, after decompression.
    fn read_bytes(&self) -> u64;
    /// What of the file is not read although there is no fault, and why.
    fn lost(&self) -> Option<String> {
        None
    }
}

/// Opens the messages of a file.
pub(super) type OpenMessages = fn(Input, &ReadOptions) -> Result<Box<dyn Messages>, LogError>;

/// Reads the scans of the recording in `input`.
pub(super) fn open(
    input: Input,
    options: &ReadOptions,
    open_messages: OpenMessages,
) -> Result<Box<dyn ScanReader>, LogError> {
    Ok(Box::new(RosReader {
        name: input.name.clone(),
        source: open_messages(input, options)?,
        open_messages,
        options: options.clone(),
        roles: Vec::new(),
        sorter: Sorter::new(options),
        messages: 0,
        bytes_before: 0,
        fault: None,
        lost_before: None,
        at_end: false,
    }))
}

/// What is done with the messages of a channel.
#[derive(Clone, Debug)]
enum Role {
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

struct RosReader {
    name: String,
    source: Box<dyn Messages>,
    open_messages: OpenMessages,
    options: ReadOptions,
    /// By the number of the channel in this part of the recording.
    roles: Vec<Option<(Role, Encoding)>>,
    sorter: Sorter,
    /// Messages of this part.
    messages: u64,
    bytes_before: u64,
    /// Why the source broke off, until all before it is handed out.
    fault: Option<io::Error>,
    /// What was not read of the parts before.
    lost_before: Option<String>,
    at_end: bool,
}

impl ScanReader for RosReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        loop {
            if let Some(entry) = self.sorter.ready(self.at_end) {
                return Some(Ok(entry));
            }
            if let Some(source) = self.fault.take() {
                return Some(Err(LogError::Broken {
                    name: self.name.clone(),
                    line: self.messages,
                    unit: Unit::Message,
                    source,
                }));
            }
            if self.at_end {
                return None;
            }
            self.read_one();
        }
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.bytes_before += self.source.read_bytes();
        self.lost_before = self.lost_before.take().or_else(|| self.source.lost());
        self.sorter.messages_before += self.messages;
        input.name.clone_into(&mut self.name);
        self.source = (self.open_messages)(input, &self.options)?;
        self.roles.clear();
        self.messages = 0;
        self.at_end = false;
        Ok(())
    }

    fn tally(&self) -> Tally {
        let mut tally = self.sorter.tally();
        tally.lines = self.sorter.messages_before + self.messages;
        tally.bytes = self.bytes_before + self.source.read_bytes();
        tally.lost = self.lost_before.clone().or_else(|| self.source.lost());
        tally
    }
}

impl RosReader {
    fn read_one(&mut self) {
        match self.source.next_message() {
            Ok(Some(message)) => {
                self.messages += 1;
                if self.roles.len() <= message.id {
                    self.roles.resize(message.id + 1, None);
                }
                let (role, encoding) = self.roles[message.id].get_or_insert_with(|| {
                    let encoding = message.channel.encoding.clone().unwrap_or(Encoding::Cdr);
                    (self.sorter.role(message.channel), encoding)
                });
                self.sorter.take(role, *encoding, &message, self.messages);
            }
            Ok(None) => self.at_end = true,
            Err(fault) => {
                self.fault = Some(fault);
                self.at_end = true;
            }
        }
    }
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
struct Sorter {
    use_odometry: bool,
    lasers: Lasers,
    /// Waiting, in file order: of all lasers until one is chosen, then of that one.
    held: VecDeque<Held>,
    held_beams: usize,
    mounts: Mounts,
    track: Track,
    keeper: Keeper,
    messages_before: u64,
}

impl Sorter {
    fn new(options: &ReadOptions) -> Self {
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

    fn role(&mut self, channel: &Channel) -> Role {
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

    fn take(&mut self, role: &Role, encoding: Encoding, message: &Message<'_>, number: u64) {
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
    fn ready(&mut self, at_end: bool) -> Option<Entry> {
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

    fn tally(&self) -> Tally {
        let mut tally = self.keeper.tally.clone();
        self.lasers.tell(&mut tally);
        tally.notes.extend(self.track.note());
        tally
    }
}
