//! `polymapper import`: a map that was edited by hand, read back.

use std::path::PathBuf;

use polymapper_io::Georef;
use polymapper_io::import::{ImportOptions, Imported, import};
use polymapper_io::out::{AtomicFile, MapFile, read_map, write_map};

use crate::Finish;
use crate::talk::say;

#[derive(clap::Args)]
pub struct ImportArgs {
    /// Drawing to read: SVG, DXF, JSON-FG or GeoJSON
    pub drawing: PathBuf,
    /// Map to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The map that was exported: vertices that did not move keep the evidence they rest on
    #[arg(long, value_name = "MAP")]
    pub base: Option<PathBuf>,
    /// Where the map lies on Earth, as it was given to `export`: for drawings in degrees or UTM
    #[arg(long, value_name = "LAT,LON,BEARING", allow_hyphen_values = true)]
    pub georef: Option<Georef>,
    /// Metres in a unit of a drawing that does not say
    #[arg(long, value_name = "METRES", value_parser = scale)]
    pub metres_per_unit: Option<f64>,
}

fn scale(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|v| (1e-6..=1e6).contains(v))
        .ok_or_else(|| "metres from 0.000001 to 1000000 are expected".to_owned())
}

/// Runs the command.
pub fn run(args: &ImportArgs) -> anyhow::Result<Finish> {
    let base = args.base.as_deref().map(read_map).transpose()?;
    let partial = base.as_ref().and_then(|file| file.partial.clone());
    let turned_rad = base.as_ref().map_or(0.0, |file| file.turned_rad);
    let options = ImportOptions {
        base: base.map(|file| file.map),
        georef: args.georef,
        metres_per_unit: args.metres_per_unit,
    };
    let imported = import(&args.drawing, &options)?;
    tell(&imported);
    let skipped = !imported.skipped.is_empty();
    let file = MapFile {
        map: imported.map,
        partial,
        turned_rad,
    };
    AtomicFile::write(&args.output, |f| write_map(f, &file))?;
    say(format_args!("map: {}", args.output.display()));
    Ok(Finish::with_loss(skipped))
}

fn tell(imported: &Imported) {
    for note in &imported.notes {
        say(format_args!("note: {note}"));
    }
    for (what, count) in &imported.skipped {
        say(format_args!("left out: {count} × {what}"));
    }
    let map = &imported.map;
    let vertices: usize = map.polylines.iter().map(|p| p.vertices.len()).sum();
    let boxes = match map.eraser_boxes.len() {
        0 => String::new(),
        n => format!(", {n} eraser boxes"),
    };
    say(format_args!(
        "{}: {} polylines ({} with their id, {} new), {vertices} vertices{boxes}",
        imported.format,
        map.polylines.len(),
        imported.kept_ids,
        imported.new_ids
    ));
}
