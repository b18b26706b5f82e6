//! MRPT rawlogs (`.rawlog`): serialised objects one after another, usually packed with gzip.
//!
//! In goes the file as a stream, out come the `CObservation2DRangeScan` in it. Objects have no length, so that one of
//! an unknown class could not be skipped; instead the stream is searched for what begins a scan or a pose of odometry:
//! `0x80 + length`, the name of the class, its version. What is found so is read whole or told as faulty.
//! Both kinds of rawlog go in: sensory frames with actions between them (odometry is then a step a frame) and plain
//! observations.

mod fields;
mod objects;
mod window;

use polymapper_core::geometry::Pose;

use super::keeper::{Keeper, Reading};
use super::{Entry, LineFault, LogError, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;
use objects::{Odometry, Scan};
use window::{Class, Window};

/// How the names of classes in a rawlog begin.
const NAMES: &[&[u8]] = &[
    b"CSensoryFrame",
    b"CActionCollection",
    b"CObservation",
    b"CRawlog",
    b"mrpt::",
];

/// Whether the first bytes are an object of a class that rawlogs have.
pub(super) fn recognise(head: &[u8]) -> bool {
    let Some((&length, rest)) = head.split_first() else {
        return false;
    };
    let name = rest.get(..usize::from(length & 0x7f)).unwrap_or_default();
    let is_name = name
        .iter()
        .all(|b| b.is_ascii_alphanumeric() || b"_:<>,".contains(b));
    length & 0x80 != 0 && is_name && NAMES.iter().any(|n| name.starts_with(n))
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    Ok(Box::new(RawlogReader {
        name: input.name.clone(),
        window: Window::new(input.into_stream()),
        label: options.laser.clone(),
        use_odometry: options.use_odometry,
        pose: None,
        objects: 0,
        objects_before: 0,
        bytes_before: 0,
        keeper: Keeper::new(Unit::Message, options),
    }))
}

struct RawlogReader {
    name: String,
    window: Window,
    /// Label of the sensor that is read; that of the first scan unless told.
    label: Option<String>,
    use_odometry: bool,
    /// The odometry so far, of the robot.
    pose: Option<Pose>,
    /// Objects met in this part.
    objects: u64,
    objects_before: u64,
    bytes_before: u64,
    keeper: Keeper,
}

impl ScanReader for RawlogReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        loop {
            match self.window.find() {
                Ok(Some(class)) => {
                    self.objects += 1;
                    if let Some(entry) = self.take(class) {
                        return Some(Ok(entry));
                    }
                }
                Ok(None) => return None,
                Err(source) => {
                    return Some(Err(LogError::Broken {
                        name: self.name.clone(),
                        line: self.objects,
                        unit: Unit::Message,
                        source,
                    }));
                }
            }
        }
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.bytes_before += self.window.read_bytes;
        self.objects_before += self.objects;
        self.objects = 0;
        input.name.clone_into(&mut self.name);
        self.window = Window::new(input.into_stream());
        Ok(())
    }

    fn tally(&self) -> Tally {
        let label = self.label.as_deref().filter(|l| !l.is_empty());
        Tally {
            lines: self.objects_before + self.objects,
            bytes: self.bytes_before + self.window.read_bytes,
            laser: Some(label.unwrap_or("CObservation2DRangeScan").to_owned()),
            ..self.keeper.tally.clone()
        }
    }
}

impl RawlogReader {
    /// Uses the object at the start of the window; an entry when it is a scan of the sensor that is read.
    fn take(&mut self, class: Class) -> Option<Entry> {
        match class {
            Class::Scan => {
                let read = Scan::read(self.window.bytes());
                let step = read.as_ref().map_or(1, |(_, bytes)| *bytes);
                self.window.consume(step);
                let scan = read.map(|(scan, _)| scan);
                if let Ok(scan) = &scan
                    && *self.label.get_or_insert_with(|| scan.label.clone()) != scan.label
                {
                    let name = format!("{} (another sensor)", scan.label);
                    self.keeper.count_other(name.as_bytes());
                    return None;
                }
                let reading = scan.and_then(|scan| self.reading(scan));
                Some(self.keeper.entry(self.objects, reading))
            }
            Class::Odometry | Class::Action => {
                if self.use_odometry {
                    let is_step = class == Class::Action;
                    match Odometry::read(self.window.bytes(), is_step) {
                        Ok(Odometry::At(pose)) => self.pose = Some(pose),
                        Ok(Odometry::Step(step)) => self.pose = Some(self.pose.unwrap_or_default() * step),
                        Err(fault) => self.keeper.note(format!("odometry that cannot be read: {fault}")),
                    }
                }
                self.keeper.count_other(match class {
                    Class::Odometry => b"CObservationOdometry",
                    _ => b"CActionRobotMovement2D",
                });
                self.window.consume(1);
                None
            }
        }
    }

    fn reading(&mut self, scan: Scan) -> Result<Reading, LineFault> {
        if scan.is_upside_down() {
            let note =
                "the scanner is mounted upside down by its pose in the log: its beams are turned round";
            self.keeper.note(note.to_owned());
        }
        // A log whose first frame comes before any odometry starts at the origin.
        let robot = self.use_odometry.then(|| self.pose.unwrap_or_default());
        let odometry = robot.and_then(|robot| Some(robot * scan.mount()?));
        scan.into_reading(odometry)
    }
}
