//! A map that was edited by hand, read back: SVG, DXF, GeoJSON or JSON-FG.
//!
//! In goes a file that an export wrote and a drawing program or GIS changed; out comes a map. The kind of file is
//! recognised by its content. Lines that still carry an id keep it, new ones get the next free one; what is no
//! line is counted and told. Files are hostile until shown otherwise: their size and what they unfold to have
//! limits, and nothing in them can make the program panic.

mod dxf;
mod geojson;
mod path_data;
mod shapes;
mod svg;
mod transform;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use polymapper_core::map::Map;

use crate::georef::Georef;
use crate::out::{MAP_FORMAT, MapFileError, map_from_json};
use shapes::Shapes;

/// The largest file that is read. A map of a hundred thousand vertices takes 5 MB; the worst of this size,
/// positions of GeoJSON without end, take 0.55 GB of memory.
const MOST_BYTES: u64 = 16 << 20;

/// What the user knows about the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// The map that was exported: vertices that did not move keep what they rest on.
    pub base: Option<Map>,
    /// Where the map lies on Earth, for files in longitude and latitude or UTM.
    pub georef: Option<Georef>,
    /// Metres in a unit of the drawing, where the file does not say.
    pub metres_per_unit: Option<f64>,
}

/// A map that was read back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// The map.
    pub map: Map,
    /// Name of the kind of file.
    pub format: &'static str,
    /// Lines that brought their id.
    pub kept_ids: usize,
    /// Lines that got a new id.
    pub new_ids: usize,
    /// What could not be used, and how often.
    pub skipped: BTreeMap<String, usize>,
    /// What was assumed, in words.
    pub notes: Vec<String>,
}

/// Why a file gives no map.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The system does not give the file.
    #[error("{name} cannot be read")]
    Unreadable {
        /// Name of the file.
        name: String,
        /// What the system says.
        source: io::Error,
    },
    /// More than is read.
    #[error("{name} is larger than {limit}, the most that is read")]
    TooLarge {
        /// Name of the file.
        name: String,
        /// The limit, with its unit.
        limit: String,
    },
    /// None of the formats.
    #[error("{name} is no SVG, DXF (text), GeoJSON, JSON-FG or map.json; it begins with {head}")]
    Unrecognised {
        /// Name of the file.
        name: String,
        /// What it begins with.
        head: String,
    },
    /// It is the format, but wrong.
    #[error("{name}: {fault}")]
    Content {
        /// Name of the file.
        name: String,
        /// What was found, what was expected, where.
        fault: String,
    },
    /// It is a map.json, but wrong.
    #[error(transparent)]
    Map(#[from] MapFileError),
}

/// Reads the map in the file at `path`.
///
/// # Errors
/// No file, one that is too large, no known format, or content that makes no map.
pub fn import(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let name = path.display().to_string();
    let bytes = match read(path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(ImportError::Unreadable { name, source }),
    };
    if bytes.len() as u64 > MOST_BYTES {
        let limit = format!("{} MiB", MOST_BYTES >> 20);
        return Err(ImportError::TooLarge { name, limit });
    }
    import_bytes(&name, &bytes, options)
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads the map in a file that is in memory, as [`import`] does; `name` is for messages.
///
/// # Errors
/// As [`import`].
pub fn import_bytes(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}');
    let content = |fault| ImportError::Content {
        name: name.to_owned(),
        fault,
    };
    let (format, shapes) = match text.trim_start().chars().next() {
        Some('<') => ("SVG", svg::read(text, options).map_err(content)?),
        Some('{') if is_map(text) => {
            let map = map_from_json(text, name)?.map;
            ("map.json", Shapes::of_map(map))
        }
        Some('{') => ("GeoJSON", geojson::read(text, options).map_err(content)?),
        _ if dxf::recognise(text) => ("DXF", dxf::read(text, options).map_err(content)?),
        _ => {
            return Err(ImportError::Unrecognised {
                name: name.to_owned(),
                head: head(text),
            });
        }
    };
    shapes.into_map(format, options.base.as_ref()).map_err(content)
}

fn is_map(text: &str) -> bool {
    let start: String = text.chars().filter(|c| !c.is_whitespace()).take(64).collect();
    start.starts_with(&format!("{{\"format\":\"{MAP_FORMAT}\""))
}

/// What the file begins with, fit for a message.
fn head(text: &str) -> String {
    match text.trim_start().get(..1) {
        None if text.trim_start().is_empty() => "nothing".to_owned(),
        _ => format!("{:?}", text.trim_start().chars().take(24).collect::<String>()),
    }
}
