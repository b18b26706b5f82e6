//! `keyframes.jsonl.gz`: the scans that a map is made of, so that it can be continued and joined with others.
//!
//! In and out goes a [`SavedMap`], as JSON lines packed with gzip: the kind of file, then a line for each geometry, keyframe
//! and edge, in order. Ranges are kept to the millimetre: 0 is no return.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use polymapper_core::align::Information;
use polymapper_core::geometry::Pose;
use polymapper_core::join::{SavedEdge, SavedKeyframe, SavedMap};
use polymapper_core::scan::{Scan, ScanGeometry};
use serde::{Deserialize, Serialize};

use super::map_file_in::FARTHEST_M;

const FORMAT: &str = "polymapper-keyframes";
const VERSION: u64 = 1;
/// No scanner moves farther while its beam goes round, metres and radians.
const MOST_TURN_M: f64 = 10.0;
const MOST_TURN_RAD: f64 = 7.0;
/// Unpacked, more than this is no such file, bytes: 100 000 keyframes of 1440 beams.
const MOST_BYTES: u64 = 1 << 30;

/// The keyframes of a map, and the log that they are of.
#[derive(Clone, Debug, Default)]
pub struct KeyframeFile {
    /// Keyframes and edges; scans are numbered as in `trajectory.csv`.
    pub saved: SavedMap,
    /// Rows of `trajectory.csv`.
    pub scans: usize,
}

/// Why keyframes cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum KeyframeFileError {
    /// The system does not give the file, or it is not packed with gzip.
    #[error("{name} cannot be read")]
    Unreadable {
        /// Name of the file.
        name: String,
        /// What the system says.
        source: io::Error,
    },
    /// A line that is no such line.
    #[error("{name}, line {line} is no line of keyframes")]
    Json {
        /// Name of the file.
        name: String,
        /// 1-based line.
        line: usize,
        /// What is wrong.
        source: serde_json::Error,
    },
    /// A line that cannot be.
    #[error("{name}, line {line}: {fault}")]
    Content {
        /// Name of the file.
        name: String,
        /// 1-based line.
        line: usize,
        /// What is wrong with it.
        fault: String,
    },
}

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Line {
    Head {
        format: String,
        version: u64,
        scans: usize,
    },
    Geometry {
        first_bearing_rad: f64,
        step_rad: f64,
        beams: usize,
        min_range_m: f64,
        max_range_m: f64,
    },
    Keyframe {
        scan: usize,
        pose: [f64; 3],
        noise_m: f64,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        moving: Vec<usize>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        turn_motion: Option<[f64; 3]>,
        ranges_mm: Vec<u32>,
    },
    Edge {
        edge: [usize; 2],
        motion: [f64; 3],
        information: [f64; 6],
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_loop: bool,
    },
}

/// Writes the keyframes.
///
/// # Errors
/// Those of `out`.
pub fn write_keyframes(out: &mut impl Write, file: &KeyframeFile) -> io::Result<()> {
    let mut out = GzEncoder::new(out, Compression::new(6));
    let mut text = Vec::new();
    let mut put = |line: &Line| -> io::Result<()> {
        // Packed line by line: calling the packer for every number is dear.
        text.clear();
        serde_json::to_writer(&mut text, line)?;
        text.push(b'\n');
        out.write_all(&text)
    };
    put(&Line::Head {
        format: FORMAT.to_owned(),
        version: VERSION,
        scans: file.scans,
    })?;
    let mut geometry = None;
    for keyframe in &file.saved.keyframes {
        let here = *keyframe.scan.geometry();
        if geometry != Some(here) {
            put(&geometry_line(&here))?;
            geometry = Some(here);
        }
        put(&keyframe_line(keyframe))?;
    }
    for edge in &file.saved.edges {
        put(&edge_line(edge))?;
    }
    out.finish()?;
    Ok(())
}

fn geometry_line(geometry: &ScanGeometry) -> Line {
    Line::Geometry {
        first_bearing_rad: geometry.bearing_rad(0),
        step_rad: geometry.step_rad(),
        beams: geometry.beams(),
        min_range_m: geometry.min_range_m(),
        max_range_m: geometry.max_range_m(),
    }
}

fn keyframe_line(keyframe: &SavedKeyframe) -> Line {
    // NaN, which is no return, becomes 0.
    let millimetres = |range_m: &f64| (1e3 * range_m).round() as u32;
    Line::Keyframe {
        scan: keyframe.number,
        pose: numbers(keyframe.map_from_scan),
        noise_m: keyframe.noise_m,
        moving: keyframe.moving.clone(),
        turn_motion: Some(keyframe.scan.turn_motion())
            .filter(|m| *m != Pose::IDENTITY)
            .map(numbers),
        ranges_mm: keyframe
            .scan
            .measured_ranges_m()
            .iter()
            .map(millimetres)
            .collect(),
    }
}

fn edge_line(edge: &SavedEdge) -> Line {
    let rows = edge.information.rows;
    // Seven digits of the information are plenty.
    let short = |v: f64| format!("{v:.6e}").parse().unwrap_or(v);
    Line::Edge {
        edge: [edge.from, edge.to],
        motion: numbers(edge.motion),
        information: [
            rows[0][0], rows[0][1], rows[0][2], rows[1][1], rows[1][2], rows[2][2],
        ]
        .map(short),
        is_loop: edge.is_loop,
    }
}

/// Rounded to 1 µm and 1 µrad.
fn numbers(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.theta_rad].map(|v| (v * 1e6).round() / 1e6 + 0.0)
}

/// Reads the keyframes at `path`.
///
/// # Errors
/// No file, not packed, a line that is no such line or cannot be.
pub fn read_keyframes(path: &Path) -> Result<KeyframeFile, KeyframeFileError> {
    let name = path.display().to_string();
    let unreadable = |source| KeyframeFileError::Unreadable {
        name: name.clone(),
        source,
    };
    let file = File::open(path).map_err(unreadable)?;
    let text = BufReader::new(MultiGzDecoder::new(BufReader::new(file)).take(MOST_BYTES));
    let mut reading = Reading::default();
    for (number, line) in text.lines().enumerate() {
        let line = line.map_err(unreadable)?;
        let parsed = serde_json::from_str(&line).map_err(|source| KeyframeFileError::Json {
            name: name.clone(),
            line: number + 1,
            source,
        })?;
        reading.take(parsed).map_err(|fault| KeyframeFileError::Content {
            name: name.clone(),
            line: number + 1,
            fault,
        })?;
    }
    reading.finish().map_err(|fault| KeyframeFileError::Content {
        name: name.clone(),
        line: 1,
        fault,
    })
}

#[derive(Default)]
struct Reading {
    has_head: bool,
    geometry: Option<ScanGeometry>,
    file: KeyframeFile,
}

impl Reading {
    fn take(&mut self, line: Line) -> Result<(), String> {
        match line {
            Line::Head {
                format,
                version,
                scans,
            } => {
                if format != FORMAT || version > VERSION {
                    return Err(format!(
                        "\"{format}\" version {version}; \"{FORMAT}\" up to version {VERSION} is expected"
                    ));
                }
                self.has_head = true;
                self.file.scans = scans;
            }
            Line::Geometry {
                first_bearing_rad,
                step_rad,
                beams,
                min_range_m,
                max_range_m,
            } => {
                let geometry =
                    ScanGeometry::new(first_bearing_rad, step_rad, beams).map_err(|e| e.to_string())?;
                self.geometry = Some(geometry.with_limits(min_range_m, max_range_m));
            }
            Line::Keyframe {
                scan,
                pose,
                noise_m,
                moving,
                turn_motion,
                ranges_mm,
            } => {
                let geometry = self.geometry.ok_or("a keyframe before any geometry")?;
                let ranges_m = ranges_mm.iter().map(|&mm| f64::from(mm) / 1e3).collect();
                if !(0.0..1.0).contains(&noise_m) {
                    return Err(format!("a noise of {noise_m} m; less than 1 is expected"));
                }
                let measured = Scan::new(geometry, ranges_m).map_err(|e| e.to_string())?;
                let turn_motion = turn_motion.map(motion_of).transpose()?;
                self.file.saved.keyframes.push(SavedKeyframe {
                    number: scan,
                    scan: turn_motion.map_or_else(|| measured.clone(), |m| measured.straightened(m)),
                    noise_m,
                    moving,
                    map_from_scan: pose_of(pose)?,
                });
            }
            Line::Edge {
                edge,
                motion,
                information,
                is_loop,
            } => self.file.saved.edges.push(SavedEdge {
                from: edge[0],
                to: edge[1],
                motion: pose_of(motion)?,
                information: information_of(information)?,
                is_loop,
            }),
        }
        Ok(())
    }

    fn finish(self) -> Result<KeyframeFile, String> {
        if !self.has_head {
            return Err(format!("no line with the format \"{FORMAT}\""));
        }
        let keyframes = &self.file.saved.keyframes;
        let count = keyframes.len();
        if let Some(e) = self
            .file
            .saved
            .edges
            .iter()
            .find(|e| e.from >= count || e.to >= count)
        {
            return Err(format!(
                "an edge from {} to {}, but there are {count} keyframes",
                e.from, e.to
            ));
        }
        let is_counted = keyframes.windows(2).all(|w| w[0].number < w[1].number)
            && keyframes.last().is_none_or(|k| k.number < self.file.scans);
        if !is_counted {
            return Err(format!(
                "the scans of the keyframes do not grow, or reach {}",
                self.file.scans
            ));
        }
        Ok(self.file)
    }
}

fn pose_of([x, y, theta_rad]: [f64; 3]) -> Result<Pose, String> {
    let is_there = [x, y].iter().all(|v| v.abs() <= FARTHEST_M) && theta_rad.abs() <= 10.0;
    is_there
        .then(|| Pose::new(x, y, theta_rad))
        .ok_or_else(|| format!("the pose ({x}, {y}, {theta_rad}) is no place in a building"))
}

/// The motion of a scanner while its beam goes round.
fn motion_of(motion: [f64; 3]) -> Result<Pose, String> {
    let [x, y, theta_rad] = motion;
    let is_small = x.abs().max(y.abs()) <= MOST_TURN_M && theta_rad.abs() <= MOST_TURN_RAD;
    is_small.then(|| Pose::new(x, y, theta_rad)).ok_or_else(|| {
        format!("({x}, {y}, {theta_rad}) is no motion of a scanner while its beam goes round once")
    })
}

fn information_of(cells: [f64; 6]) -> Result<Information, String> {
    let [xx, xy, xt, yy, yt, tt] = cells;
    if cells.iter().any(|c| !c.is_finite()) || xx < 0.0 || yy < 0.0 || tt < 0.0 {
        return Err("the information of an edge is none".to_owned());
    }
    Ok(Information {
        rows: [[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]],
    })
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_scan_taken_on_the_move_comes_back_as_it_was_made_straight() {
        let geometry = ScanGeometry::new(-1.0, 0.01, 201).unwrap();
        let ranges_m = (0..201).map(|k| {
            if k == 7 {
                f64::NAN
            } else {
                2.0 + 0.001 * f64::from(k)
            }
        });
        let turn_motion = Pose::new(0.08, -0.01, 0.05);
        let scan = Scan::new(geometry, ranges_m.collect())
            .unwrap()
            .straightened(turn_motion);
        let written = KeyframeFile {
            saved: SavedMap {
                keyframes: vec![SavedKeyframe {
                    number: 0,
                    scan: scan.clone(),
                    noise_m: 0.01,
                    moving: Vec::new(),
                    map_from_scan: Pose::IDENTITY,
                }],
                edges: Vec::new(),
            },
            scans: 1,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("keyframes.jsonl.gz");
        write_keyframes(&mut File::create(&path).unwrap(), &written).unwrap();
        let read = read_keyframes(&path).unwrap();
        let back = &read.saved.keyframes[0].scan;
        assert_eq!(back.turn_motion(), turn_motion);
        for beam in 0..201 {
            match (scan.point(beam), back.point(beam)) {
                (Some(a), Some(b)) => assert!(a.distance(b) < 1e-6),
                (a, b) => assert!(a.is_none() && b.is_none(), "beam {beam}"),
            }
        }
    }
}
