//! `map.json` read back.
//!
//! In goes a file that [`super::write_map`] wrote, or a program that knows its description; everything that the rest
//! of the program relies on is checked.

use std::collections::BTreeSet;
use std::path::Path;
use std::{fs, io};

use polymapper_core::geometry::Point;
use polymapper_core::map::{EraserBox, Map, MapPolyline, MapVertex};
use serde::Deserialize;

use super::map_file::{BoxRecord, MAP_FORMAT, MAP_VERSION, MapFile, PolylineRecord};

/// Farther from the origin is no place in a building, metres.
pub(crate) const FARTHEST_M: f64 = 1e7;

/// Why a file is not a map.
#[derive(Debug, thiserror::Error)]
pub enum MapFileError {
    /// The system does not give the file.
    #[error("{name} cannot be read")]
    Unreadable {
        /// Name of the file.
        name: String,
        /// What the system says.
        source: io::Error,
    },
    /// Not JSON, or a field is missing or of another kind.
    #[error("{name} is no map")]
    Json {
        /// Name of the file.
        name: String,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// JSON of something else.
    #[error("{name} is no map: `format` is {found}, \"{MAP_FORMAT}\" is expected")]
    Format {
        /// Name of the file.
        name: String,
        /// What `format` holds.
        found: String,
    },
    /// A format from the future.
    #[error("{name} has map format version {found}; this program reads up to {MAP_VERSION}")]
    Version {
        /// Name of the file.
        name: String,
        /// The version of the file.
        found: u64,
    },
    /// A polyline or a box that cannot be.
    #[error("{name}, {what}: {fault}")]
    Content {
        /// Name of the file.
        name: String,
        /// Which one.
        what: String,
        /// What is wrong with it.
        fault: String,
    },
}

/// The two fields that say whether the rest can be read.
#[derive(Deserialize)]
struct Kind {
    #[serde(default)]
    format: serde_json::Value,
    #[serde(default)]
    version: u64,
}

#[derive(Deserialize)]
struct Record {
    #[serde(default)]
    partial: Option<String>,
    #[serde(default)]
    turned_rad: f64,
    polylines: Vec<PolylineRecord>,
    #[serde(default)]
    eraser_boxes: Vec<BoxRecord>,
}

/// Reads the map at `path`. Fields that are not known are left out; unknown standard deviations are NaN.
///
/// # Errors
/// No file, no JSON, another format or a later version, polylines or boxes that cannot be.
pub fn read_map(path: &Path) -> Result<MapFile, MapFileError> {
    let name = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|source| MapFileError::Unreadable {
        name: name.clone(),
        source,
    })?;
    map_from_json(&text, &name)
}

/// Reads a map from the text of its file; `name` is for messages.
///
/// # Errors
/// As [`read_map`].
pub(crate) fn map_from_json(text: &str, name: &str) -> Result<MapFile, MapFileError> {
    let json = |source| MapFileError::Json {
        name: name.to_owned(),
        source,
    };
    let kind: Kind = serde_json::from_str(text).map_err(json)?;
    if kind.format != MAP_FORMAT {
        return Err(MapFileError::Format {
            name: name.to_owned(),
            found: kind.format.to_string(),
        });
    }
    if kind.version > MAP_VERSION {
        return Err(MapFileError::Version {
            name: name.to_owned(),
            found: kind.version,
        });
    }
    let record: Record = serde_json::from_str(text).map_err(json)?;
    let content = |what: String| {
        move |fault| MapFileError::Content {
            name: name.to_owned(),
            what,
            fault,
        }
    };
    let mut map = Map::default();
    let mut ids = BTreeSet::new();
    for record in record.polylines {
        let what = content(format!("polyline {}", record.id));
        if !ids.insert(record.id) {
            return Err(what("the id is used twice".to_owned()));
        }
        map.polylines.push(polyline(record).map_err(what)?);
    }
    for (k, record) in record.eraser_boxes.iter().enumerate() {
        map.eraser_boxes
            .push(eraser_box(record).map_err(content(format!("eraser box {k}")))?);
    }
    Ok(MapFile {
        map,
        partial: record.partial,
        turned_rad: record.turned_rad,
    })
}

fn polyline(record: PolylineRecord) -> Result<MapPolyline, String> {
    let count = record.vertices.len();
    let fits = |name: &str, len: usize| match len {
        0 => Ok(()),
        n if n == count => Ok(()),
        n => Err(format!("{n} `{name}`, but {count} vertices")),
    };
    fits("observations", record.observations.len())?;
    fits("sigma_m", record.sigma_m.len())?;
    if count < 2 {
        return Err(format!("two vertices or more are expected, {count} found"));
    }
    record.vertices.iter().try_for_each(in_building)?;
    let vertex = |(k, &[x, y]): (usize, &[f64; 2])| MapVertex {
        point: Point::new(x, y),
        observations: record.observations.get(k).copied().unwrap_or(0),
        sigma_m: record.sigma_m.get(k).copied().flatten().unwrap_or(f64::NAN),
    };
    Ok(MapPolyline {
        id: record.id,
        vertices: record.vertices.iter().enumerate().map(vertex).collect(),
    })
}

/// Without the limit a number may be read that overflows when it is rounded to be written.
fn in_building(&[x, y]: &[f64; 2]) -> Result<(), String> {
    if x.abs() <= FARTHEST_M && y.abs() <= FARTHEST_M {
        return Ok(());
    }
    Err(format!(
        "a vertex at ({x:e}, {y:e}) m, at most {FARTHEST_M:e} m are expected"
    ))
}

fn eraser_box(record: &BoxRecord) -> Result<EraserBox, String> {
    let (min, max) = (record.min, record.max);
    in_building(&min)?;
    in_building(&max)?;
    if min[0] > max[0] || min[1] > max[1] {
        return Err(format!("`min` {min:?} is not below `max` {max:?}"));
    }
    Ok(EraserBox {
        min: Point::new(min[0], min[1]),
        max: Point::new(max[0], max[1]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::out::write_map;

    fn sample() -> MapFile {
        let vertex = |x, y, observations, sigma_m| MapVertex {
            point: Point::new(x, y),
            observations,
            sigma_m,
        };
        let polyline = |id| MapPolyline {
            id,
            vertices: vec![vertex(0.0, -1.25, 3, 0.004), vertex(12.3457, 2.0, 17, 0.001)],
        };
        MapFile {
            map: Map {
                polylines: vec![polyline(4), polyline(9)],
                eraser_boxes: vec![EraserBox {
                    min: Point::new(0.0, 0.5),
                    max: Point::new(1.0, 2.5),
                }],
            },
            partial: Some("stopped \"by hand\"".to_owned()),
            turned_rad: 0.0,
        }
    }

    fn text(file: &MapFile) -> String {
        let mut out = Vec::new();
        write_map(&mut out, file).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn what_is_written_is_read_back() {
        for file in [sample(), MapFile::default()] {
            assert_eq!(map_from_json(&text(&file), "map.json").unwrap(), file);
        }
    }

    #[test]
    fn a_polyline_is_a_line_with_numbers_of_four_decimals() {
        let mut file = sample();
        file.map.polylines[0].vertices[0].point = Point::new(1.000_049, -0.000_01);
        let text = text(&file);
        let line =
            r#"{"id":4,"vertices":[[1.0,0.0],[12.3457,2.0]],"observations":[3,17],"sigma_m":[0.004,0.001]},"#;
        assert!(text.lines().any(|l| l == line), "{text}");
    }

    #[test]
    fn a_file_that_is_no_map_says_why() {
        let good = text(&sample());
        let fault = |from: &str, to: &str| {
            let error = map_from_json(&good.replacen(from, to, 1), "m.json").unwrap_err();
            let detail = std::error::Error::source(&error).map(ToString::to_string);
            format!("{error}; {}", detail.unwrap_or_default())
        };
        assert!(
            fault("polymapper-map", "GeoJSON")
                .contains("`format` is \"GeoJSON\", \"polymapper-map\" is expected")
        );
        assert!(fault("\"version\": 1", "\"version\": 2").contains("version 2; this program reads up to 1"));
        assert!(fault("\"id\":9", "\"id\":4").contains("polyline 4: the id is used twice"));
        assert!(fault("[3,17]", "[3]").contains("polyline 4: 1 `observations`, but 2 vertices"));
        assert!(fault("[1.0,2.5]", "[-1.0,2.5]").contains("eraser box 0"));
        // Found by fuzzing: it was read, but what was written of it could not be.
        assert!(fault("12.3457", "1e305").contains("polyline 4: a vertex at (1e305, 2e0) m, at most 1e7 m"));
        assert!(fault("[1.0,2.5]", "[1.0,2.5e7]").contains("eraser box 0: a vertex at (1e0, 2.5e7) m"));
        assert!(fault("12.3457", "\"x\"").contains("at line 8 column"));
        assert!(fault("polylines", "lines").contains("missing field `polylines`"));
    }
}
