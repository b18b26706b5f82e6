//! What a map can be exported to: one file a format, listed in [`FORMATS`].
//!
//! In goes a [`Subject`]: the map, and the trajectory and the scans where they are known. Out come files beside
//! each other whose names begin alike, each whole or not at all, the same bytes for the same input. What a format
//! cannot say is told in the notes, what it cannot do without is an error that says how to give it.
//! `docs/exports.md` describes every format for those who use it.

mod carmen;
mod dxf;
mod extent;
mod features;
mod g2o;
mod geojson;
mod gpkg;
mod grid;
mod kitti;
mod mcap;
mod nav2;
mod nav2_vector;
mod png;
mod rmf;
mod subject;
mod svg;
mod text;
mod tum;

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};

use super::atomic::{AtomicFile, OutputError};
pub use subject::{ExportOptions, PlacedScan, ScanSource, Subject};

pub(crate) use dxf::XDATA_APPLICATION;
pub(crate) use features::ENGINEERING_2D;
pub(crate) use svg::{FRAME_ID, POLYLINE_ID, UNIT_ATTRIBUTE};

/// Layer of the walls, in every format that has layers.
pub(crate) const WALLS: &str = "walls";
/// Layer of the boxes around what has no stable shape.
pub(crate) const ERASER_BOXES: &str = "eraser boxes";
/// Layer of the way of the scanner.
pub(crate) const WAY: &str = "way";

/// Why an export was not written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Something is missing that the format cannot do without.
    #[error("{format} needs {what}")]
    Needs {
        /// Name of the format.
        format: &'static str,
        /// What is missing and how to give it.
        what: &'static str,
    },
    /// The map does not fit the format.
    #[error("{format} cannot hold this map: {why}")]
    Unfit {
        /// Name of the format.
        format: &'static str,
        /// Why, with the numbers.
        why: String,
    },
    /// The scans could not be read again.
    #[error("the scans cannot be used for the export")]
    Scans(#[source] Box<dyn Error + Send + Sync>),
    /// The library that writes the format failed.
    #[error("{format} could not be made")]
    Library {
        /// Name of the format.
        format: &'static str,
        /// What the library says.
        source: Box<dyn Error + Send + Sync>,
    },
}

/// A format that maps can be exported to.
pub struct ExportFormat {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is and who opens it, in a line.
    pub about: &'static str,
    /// What is put behind the common name of the files; the main file first.
    pub endings: &'static [&'static str],
    /// What it makes use of.
    pub uses: Uses,
    write: fn(&Subject<'_>, &Place<'_>) -> Result<(), ExportError>,
}

/// What a format makes use of beyond the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uses {
    /// The map alone.
    Map,
    /// The way of the scanner, if it is known.
    Way,
    /// The scans at their poses, if they are known.
    Scans,
}

/// Every format, in the order of the documentation.
pub const FORMATS: &[ExportFormat] = &[
    ExportFormat {
        name: "nav2",
        about: "occupancy grid for Nav2 and ROS map_server; free space from the scans",
        endings: &[".yaml", ".pgm"],
        uses: Uses::Scans,
        write: nav2::write,
    },
    ExportFormat {
        name: "nav2-vector",
        about: "parameters of the Nav2 vector object server",
        endings: &[".vector.yaml"],
        uses: Uses::Map,
        write: nav2_vector::write,
    },
    ExportFormat {
        name: "rmf",
        about: "Open-RMF building, for traffic_editor and rmf_site",
        endings: &[".building.yaml"],
        uses: Uses::Map,
        write: rmf::write,
    },
    ExportFormat {
        name: "dxf",
        about: "DXF R12 in metres with layers, for CAD; can be edited and imported",
        endings: &[".dxf"],
        uses: Uses::Way,
        write: dxf::write,
    },
    ExportFormat {
        name: "svg",
        about: "SVG in millimetres with layers, for Inkscape; can be edited and imported",
        endings: &[".layers.svg"],
        uses: Uses::Way,
        write: svg::write,
    },
    ExportFormat {
        name: "png",
        about: "picture",
        endings: &[".png"],
        uses: Uses::Way,
        write: png::write,
    },
    ExportFormat {
        name: "json-fg",
        about: "OGC JSON-FG in metres, for GDAL and QGIS; can be edited and imported",
        endings: &[".fg.json"],
        uses: Uses::Way,
        write: geojson::write_json_fg,
    },
    ExportFormat {
        name: "geojson",
        about: "GeoJSON (RFC 7946), longitude and latitude; needs --georef",
        endings: &[".geojson"],
        uses: Uses::Way,
        write: geojson::write_rfc_7946,
    },
    ExportFormat {
        name: "gpkg",
        about: "GeoPackage in metres, or UTM with --georef; for QGIS, ArcGIS, PostGIS",
        endings: &[".gpkg"],
        uses: Uses::Way,
        write: gpkg::write,
    },
    ExportFormat {
        name: "mcap",
        about: "ROS 2 messages (scan, path, markers, grid, tf), for Foxglove, Lichtblick, rosbag2",
        endings: &[".mcap"],
        uses: Uses::Scans,
        write: mcap::write,
    },
    ExportFormat {
        name: "tum",
        about: "trajectory, for evo",
        endings: &[".tum"],
        uses: Uses::Way,
        write: tum::write,
    },
    ExportFormat {
        name: "kitti",
        about: "trajectory, for evo and KITTI tools",
        endings: &[".kitti"],
        uses: Uses::Way,
        write: kitti::write,
    },
    ExportFormat {
        name: "g2o",
        about: "trajectory as a pose graph, for g2o_viewer and solvers",
        endings: &[".g2o"],
        uses: Uses::Way,
        write: g2o::write,
    },
    ExportFormat {
        name: "carmen",
        about: "CARMEN log with the poses of the map, for gmapping, carmen and others",
        endings: &[".corrected.log"],
        uses: Uses::Scans,
        write: carmen::write,
    },
];

/// The format with this name.
#[must_use]
pub fn format_named(name: &str) -> Option<&'static ExportFormat> {
    FORMATS.iter().find(|f| f.name == name)
}

impl ExportFormat {
    /// Writes the files of the format into `folder`, which is there; their names begin with `stem`. Returns what
    /// was written.
    ///
    /// # Errors
    /// Something is missing that the format needs, the map does not fit it, or a file cannot be written.
    pub fn write(
        &self,
        subject: &Subject<'_>,
        folder: &Path,
        stem: &str,
    ) -> Result<Vec<PathBuf>, ExportError> {
        let place = Place {
            format: self,
            folder,
            stem,
        };
        (self.write)(subject, &place)?;
        Ok(self.endings.iter().map(|ending| place.path(ending)).collect())
    }

    /// What the user should know about the export, in words: what it does without, what was assumed.
    #[must_use]
    pub fn notes(&self, subject: &Subject<'_>) -> Vec<&'static str> {
        let mut notes = Vec::new();
        match (self.name, subject.trajectory.is_some(), subject.scans.is_some()) {
            ("nav2", _, false) => {
                notes.push(
                    "no scans, so no free space: only the walls are in the grid, everything else is unknown",
                );
            }
            ("mcap", true, false) => {
                notes.push("no scans: /scan is left out, and the grid has walls and no free space");
            }
            ("mcap", false, false) => {
                notes.push(
                    "no scans, no trajectory: only the lines and the grid of walls, without free space",
                );
            }
            _ => {}
        }
        if self.name == "mcap" && subject.trajectory.is_some() && !subject.has_usable_stamps() {
            notes.push(
                "the stamps of the log do not grow from scan to scan: the scans are taken as 0.1 s apart",
            );
        }
        notes
    }
}

impl fmt::Debug for ExportFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("ExportFormat").field(&self.name).finish()
    }
}

/// Where the files of an export go.
struct Place<'a> {
    format: &'a ExportFormat,
    folder: &'a Path,
    stem: &'a str,
}

impl Place<'_> {
    fn path(&self, ending: &str) -> PathBuf {
        self.folder.join(self.file_name(ending))
    }

    fn file_name(&self, ending: &str) -> String {
        format!("{}{ending}", self.stem)
    }

    /// Writes the file with the ending numbered `which` in the table.
    fn write(
        &self,
        which: usize,
        write: impl FnOnce(&mut AtomicFile) -> std::io::Result<()>,
    ) -> Result<(), ExportError> {
        let ending = self.format.endings.get(which).copied().unwrap_or_default();
        Ok(AtomicFile::write(&self.path(ending), write)?)
    }

    /// Begins the file with the ending numbered `which`, for content that comes piece by piece.
    fn create(&self, which: usize) -> Result<AtomicFile, ExportError> {
        let ending = self.format.endings.get(which).copied().unwrap_or_default();
        Ok(AtomicFile::create(&self.path(ending))?)
    }

    fn needs(&self, what: &'static str) -> ExportError {
        ExportError::Needs {
            format: self.format.name,
            what,
        }
    }

    fn unfit(&self, why: String) -> ExportError {
        ExportError::Unfit {
            format: self.format.name,
            why,
        }
    }

    /// The error of what makes the content.
    fn failed(&self, source: impl Into<Box<dyn Error + Send + Sync>>) -> ExportError {
        ExportError::Library {
            format: self.format.name,
            source: source.into(),
        }
    }
}
