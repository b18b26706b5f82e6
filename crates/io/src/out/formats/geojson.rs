//! JSON-FG (OGC 21-045r1) in the map frame, and GeoJSON (RFC 7946) for maps with a place on Earth.
//!
//! GeoJSON knows longitude and latitude only; metres in it would be read as degrees. So the map frame goes into
//! the member `place` of JSON-FG, in the coordinate system for engineering drawings or, with a place on Earth, in
//! UTM; `geometry` is then null, or the same in longitude and latitude. One feature a line.

use std::io::{self, Write};

use polymapper_core::geometry::Point;
use serde_json::{Value, json};

use super::features::{ENGINEERING_2D, Feature, features};
use super::{ExportError, Place, Subject, WALLS};
use crate::georef::{Geographic, UtmZone};
use crate::out::decimals::rounded_4;

const CONFORMANCE: [&str; 2] = [
    "http://www.opengis.net/spec/json-fg-1/1.0/conf/core",
    "http://www.opengis.net/spec/json-fg-1/1.0/conf/types-schemas",
];

pub(super) fn write_json_fg(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let utm = zone(subject, place)?;
    let crs = utm.map_or(ENGINEERING_2D.to_owned(), |zone| {
        format!("http://www.opengis.net/def/crs/EPSG/0/{}", zone.epsg())
    });
    let head = [
        ("type", json!("FeatureCollection")),
        ("conformsTo", json!(CONFORMANCE)),
        ("coordRefSys", json!(crs)),
    ];
    place.write(0, |f| {
        write_collection(f, &head, &features(subject), |feature| {
            with_id(
                feature,
                json!({
                    "type": "Feature",
                    "featureType": feature.layer,
                    "time": null,
                    "place": geometry(feature, &|p| metres(on_grid(subject, utm, p))),
                    "geometry": earth(subject, feature),
                    "properties": feature.properties,
                }),
            )
        })
    })
}

pub(super) fn write_rfc_7946(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    if subject.options.georef.is_none() {
        return Err(place.needs(
            "a place on Earth, since GeoJSON knows longitude and latitude only: give --georef lat,lon,bearing, or take \
             json-fg, which holds metres",
        ));
    }
    let head = [("type", json!("FeatureCollection"))];
    place.write(0, |f| {
        write_collection(f, &head, &features(subject), |feature| {
            with_id(
                feature,
                json!({
                    "type": "Feature",
                    "geometry": earth(subject, feature),
                    "properties": feature.properties,
                }),
            )
        })
    })
}

/// Gives walls their id; ids are unique in a file, and only the walls have one.
fn with_id(feature: &Feature, mut json: Value) -> Value {
    if let (WALLS, Some(members)) = (feature.layer, json.as_object_mut()) {
        members.insert("id".to_owned(), feature.id.into());
    }
    json
}

/// The UTM zone of a map with a place on Earth.
pub(super) fn zone(subject: &Subject<'_>, place: &Place<'_>) -> Result<Option<UtmZone>, ExportError> {
    let Some(georef) = subject.options.georef else {
        return Ok(None);
    };
    let zone = georef.utm();
    let zone =
        zone.ok_or_else(|| place.unfit("it lies so near a pole that there is no UTM zone".to_owned()))?;
    Ok(Some(zone))
}

/// A point of the map in UTM, or as it is where the map has no place on Earth.
pub(super) fn on_grid(subject: &Subject<'_>, utm: Option<UtmZone>, p: Point) -> Point {
    match (subject.options.georef, utm) {
        (Some(georef), Some(zone)) => zone.project(georef.earth_from_map(p)),
        _ => p,
    }
}

fn metres(p: Point) -> Value {
    json!([rounded_4(p.x), rounded_4(p.y)])
}

/// The geometry in longitude and latitude; null where the map has no place on Earth.
fn earth(subject: &Subject<'_>, feature: &Feature) -> Value {
    match subject.options.georef {
        Some(georef) => geometry(feature, &|p| degrees(georef.earth_from_map(p))),
        None => Value::Null,
    }
}

/// Longitude, latitude in degrees to 9 decimals (0.1 mm).
fn degrees(place: Geographic) -> Value {
    let rounded = |angle_rad: f64| (angle_rad.to_degrees() * 1e9).round() / 1e9;
    json!([rounded(place.longitude_rad), rounded(place.latitude_rad)])
}

fn geometry(feature: &Feature, coordinates: &dyn Fn(Point) -> Value) -> Value {
    let points = feature.points.iter();
    if feature.is_area {
        let ring = points.chain(feature.points.first()).map(|&p| coordinates(p));
        json!({"type": "Polygon", "coordinates": [ring.collect::<Vec<_>>()]})
    } else {
        json!({"type": "LineString", "coordinates": points.map(|&p| coordinates(p)).collect::<Vec<_>>()})
    }
}

fn write_collection(
    out: &mut impl Write,
    head: &[(&str, Value)],
    features: &[Feature],
    json: impl Fn(&Feature) -> Value,
) -> io::Result<()> {
    for (k, (name, value)) in head.iter().enumerate() {
        write!(out, "{}\"{name}\": {value}", if k == 0 { "{" } else { ",\n" })?;
    }
    write!(out, ",\n\"features\": [")?;
    for (k, feature) in features.iter().enumerate() {
        write!(out, "{}{}", if k == 0 { "\n" } else { ",\n" }, json(feature))?;
    }
    writeln!(out, "]}}")
}
