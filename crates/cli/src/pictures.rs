//! The pictures of a build: `map.svg` and `map.png`.

use std::io::Write;
use std::path::Path;

use polymapper_core::geometry::Pose;
use polymapper_core::map::Map;
use polymapper_core::mapper::Quality;
use polymapper_draw::{Scene, TrajectoryPoint, map_picture, to_png, to_svg};
use polymapper_io::out::{AtomicFile, Outcome, TrajectoryRow};

/// Name of the picture that every program shows.
pub const PNG: &str = "map.png";

/// A place with a larger standard deviation than this is drawn as uncertain, metres: rooms and door frames tell it to a centimetre or two.
const UNCERTAIN_M: f64 = 0.1;

/// Draws the map with the way of the scanner, titled by the name of the log.
pub fn write(folder: &Path, map: &Map, rows: &[TrajectoryRow], log_name: &str) -> anyhow::Result<()> {
    let title = Path::new(log_name)
        .file_name()
        .map_or_else(|| log_name.into(), |name| name.to_string_lossy());
    let scene = scene(map, rows, &title);
    AtomicFile::write(&folder.join("map.svg"), |f| {
        f.write_all(to_svg(&scene).as_bytes())
    })?;
    let png = to_png(&scene)?;
    AtomicFile::write(&folder.join(PNG), |f| f.write_all(&png))?;
    Ok(())
}

/// The picture of a map with the way of the scanner.
pub fn scene(map: &Map, rows: &[TrajectoryRow], title: &str) -> Scene {
    let way: Vec<TrajectoryPoint> = rows.iter().map(point).collect();
    map_picture(map, &way, title)
}

fn point(row: &TrajectoryRow) -> TrajectoryPoint {
    let (map_from_scan, placed) = match row.outcome {
        Outcome::Placed { map_from_scan } => (map_from_scan, true),
        Outcome::NotPlaced { .. } => (Pose::IDENTITY, false),
    };
    TrajectoryPoint {
        map_from_scan,
        placed,
        is_uncertain: is_uncertain(&row.quality),
    }
}

/// Whether the walls left the place open, or walls and motion together did not tell it well.
fn is_uncertain(quality: &Quality) -> bool {
    let sigma_m = quality.covariance.map(|c| c.widest_m());
    quality.open_rad.is_some() || sigma_m.is_some_and(|sigma_m| sigma_m > UNCERTAIN_M)
}
