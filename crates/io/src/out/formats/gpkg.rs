//! GeoPackage 1.3 (OGC 12-128r17): a table for each layer, geometries in metres.
//!
//! Coordinate system −1, "undefined Cartesian", in the map frame, or the UTM zone of a map with a place on Earth.
//! The database is made in memory and written in one go; nothing in it depends on the clock.

use std::io::Write;

use polymapper_core::geometry::Point;
use rusqlite::{Connection, params};

use super::features::{Feature, features};
use super::geojson::{on_grid, zone};
use super::{ERASER_BOXES, ExportError, Place, Subject, WALLS, WAY};
use crate::georef::UtmZone;

const UNDEFINED_CARTESIAN: i32 = -1;
/// "GPKG" as a number, the mark of the format in a SQLite file.
const APPLICATION_ID: u32 = 0x4750_4B47;
const VERSION: u32 = 10_300;
/// The format wants a time of the last change; the clock would make other bytes every time.
const LAST_CHANGE: &str = "1970-01-01T00:00:00.000Z";

const TABLES: &str = "
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY,
  organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
  description TEXT DEFAULT '', last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,
  geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name), CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
INSERT INTO gpkg_spatial_ref_sys VALUES
  ('Undefined Cartesian SRS', -1, 'NONE', -1, 'undefined', 'undefined Cartesian coordinate reference system'),
  ('Undefined geographic SRS', 0, 'NONE', 0, 'undefined', 'undefined geographic coordinate reference system'),
  ('WGS 84 geodetic', 4326, 'EPSG', 4326, 'GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],UNIT[\"degree\",0.0174532925199433,AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]]', 'longitude and latitude');
";

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let utm = zone(subject, place)?;
    let features = features(subject);
    if let Some(feature) = features.iter().find(|f| i64::try_from(f.id).is_err()) {
        return Err(place.unfit(format!("the id {} is above 2^63 - 1", feature.id)));
    }
    let bytes = database(subject, utm, &features).map_err(|source| place.failed(source))?;
    place.write(0, |f| f.write_all(&bytes))
}

fn database(subject: &Subject<'_>, utm: Option<UtmZone>, features: &[Feature]) -> rusqlite::Result<Vec<u8>> {
    let mut connection = Connection::open_in_memory()?;
    connection.pragma_update(None, "application_id", APPLICATION_ID)?;
    connection.pragma_update(None, "user_version", VERSION)?;
    let work = connection.transaction()?;
    work.execute_batch(TABLES)?;
    let srs = utm.map_or(UNDEFINED_CARTESIAN, |zone| i32::from(zone.epsg()));
    if let Some(zone) = utm {
        let name = format!(
            "WGS 84 / UTM zone {}{}",
            zone.number,
            if zone.south { 'S' } else { 'N' }
        );
        work.execute(
            "INSERT INTO gpkg_spatial_ref_sys VALUES (?1, ?2, 'EPSG', ?2, ?3, '')",
            params![name, srs, wkt(&name, zone)],
        )?;
    }
    for (layer, kind) in [
        (WALLS, "LINESTRING"),
        (ERASER_BOXES, "POLYGON"),
        (WAY, "LINESTRING"),
    ] {
        let rows: Vec<(&Feature, Vec<Point>)> = features
            .iter()
            .filter(|f| f.layer == layer)
            .map(|f| (f, f.points.iter().map(|&p| on_grid(subject, utm, p)).collect()))
            .collect();
        if layer == WALLS || !rows.is_empty() {
            table(&work, &layer.replace(' ', "_"), kind, srs, &rows)?;
        }
    }
    work.commit()?;
    Ok(connection.serialize("main")?.to_vec())
}

fn table(
    work: &Connection,
    name: &str,
    kind: &str,
    srs: i32,
    rows: &[(&Feature, Vec<Point>)],
) -> rusqlite::Result<()> {
    let points = || rows.iter().flat_map(|(_, points)| points);
    let least = |of: fn(&Point) -> f64| points().map(of).reduce(f64::min);
    let most = |of: fn(&Point) -> f64| points().map(of).reduce(f64::max);
    work.execute(
        "INSERT INTO gpkg_contents VALUES (?1, 'features', ?1, '', ?2, ?3, ?4, ?5, ?6, ?7)",
        params![
            name,
            LAST_CHANGE,
            least(|p| p.x),
            least(|p| p.y),
            most(|p| p.x),
            most(|p| p.y),
            srs
        ],
    )?;
    work.execute_batch(&format!(
        "CREATE TABLE {name} (id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {kind}, vertices INTEGER, \
         observations TEXT, sigma_m TEXT)"
    ))?;
    work.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?1, 'geom', ?2, ?3, 0, 0)",
        params![name, kind, srs],
    )?;
    let mut insert = work.prepare(&format!("INSERT INTO {name} VALUES (?1, ?2, ?3, ?4, ?5)"))?;
    for (feature, points) in rows {
        let evidence = |key: &str| feature.properties.get(key).map(ToString::to_string);
        insert.execute(params![
            feature.id.cast_signed(),
            geometry(points, feature.is_area, srs),
            points.len() as i64,
            evidence("observations"),
            evidence("sigma_m")
        ])?;
    }
    Ok(())
}

/// GeoPackage binary: "GP", version, flags (little endian, envelope of x and y), coordinate system, envelope,
/// then the geometry as well-known binary.
fn geometry(points: &[Point], is_area: bool, srs: i32) -> Vec<u8> {
    const LITTLE_ENDIAN_WITH_ENVELOPE: u8 = 0b0000_0011;
    const EMPTY_LITTLE_ENDIAN: u8 = 0b0001_0001;
    let mut bytes = vec![b'G', b'P', 0];
    let mut put = |b: &[u8]| bytes.extend_from_slice(b);
    let bound = |of: fn(&Point) -> f64, pick: fn(f64, f64) -> f64| points.iter().map(of).reduce(pick);
    let envelope = [
        bound(|p| p.x, f64::min),
        bound(|p| p.x, f64::max),
        bound(|p| p.y, f64::min),
        bound(|p| p.y, f64::max),
    ];
    put(&[if points.is_empty() {
        EMPTY_LITTLE_ENDIAN
    } else {
        LITTLE_ENDIAN_WITH_ENVELOPE
    }]);
    put(&srs.to_le_bytes());
    envelope
        .iter()
        .flatten()
        .for_each(|value| put(&value.to_le_bytes()));
    let ring: Vec<&Point> = points.iter().chain(points.first().filter(|_| is_area)).collect();
    put(&[1]);
    if is_area {
        put(&3_u32.to_le_bytes());
        put(&1_u32.to_le_bytes());
    } else {
        put(&2_u32.to_le_bytes());
    }
    put(&(ring.len() as u32).to_le_bytes());
    for p in ring {
        put(&p.x.to_le_bytes());
        put(&p.y.to_le_bytes());
    }
    bytes
}

fn wkt(name: &str, zone: UtmZone) -> String {
    let false_northing = if zone.south { 10_000_000 } else { 0 };
    format!(
        "PROJCS[\"{name}\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,\
         AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],\
         UNIT[\"degree\",0.0174532925199433,AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]],\
         PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",{}],\
         PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",{false_northing}],\
         UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],AUTHORITY[\"EPSG\",\"{}\"]]",
        zone.central_meridian_deg(),
        zone.epsg()
    )
}
