//! GeoJSON and JSON-FG → lines.
//!
//! A feature lies in its `place`, in the system that `coordRefSys` names: metres of the map frame
//! ("Engineering2D"), or UTM. Where there is no `place` it lies in `geometry`, in longitude and latitude. Both
//! UTM and degrees need the place of the map on Earth, as the export had it.

use polymapper_core::geometry::Point;
use serde_json::Value;

use super::ImportOptions;
use super::shapes::{Line, Role, Shapes};
use crate::georef::{Geographic, Georef, UtmZone};
use crate::out::ENGINEERING_2D;

pub(super) fn read(text: &str, options: &ImportOptions) -> Result<Shapes, String> {
    let root: Value = serde_json::from_str(text).map_err(|e| format!("no JSON: {e}"))?;
    let mut shapes = Shapes::default();
    match (root["type"].as_str(), root["features"].as_array()) {
        (Some("FeatureCollection"), Some(features)) => {
            for (k, one) in features.iter().enumerate() {
                feature(one, &root, options, &mut shapes).map_err(|fault| format!("feature {k}: {fault}"))?;
            }
        }
        (Some("Feature"), _) => feature(&root, &Value::Null, options, &mut shapes)?,
        (Some(other), _) => {
            let other: String = other.chars().take(40).collect();
            return Err(format!("`type` is \"{other}\", a FeatureCollection is expected"));
        }
        (None, _) => {
            return Err("no GeoJSON: `type` is missing, \"FeatureCollection\" is expected".to_owned());
        }
    }
    Ok(shapes)
}

fn feature(
    feature: &Value,
    root: &Value,
    options: &ImportOptions,
    shapes: &mut Shapes,
) -> Result<(), String> {
    let properties = &feature["properties"];
    let layer = [
        &properties["layer"],
        &feature["featureType"],
        &root["featureType"],
    ];
    let layer = layer.into_iter().find_map(Value::as_str).unwrap_or("");
    let role = Role::of_layer(layer);
    if role == Role::Nothing {
        return Ok(());
    }
    let (geometry, system) = if feature["place"].is_object() {
        let stated = [&feature["coordRefSys"], &root["coordRefSys"]];
        let stated = stated.into_iter().find(|v| !v.is_null()).unwrap_or(&Value::Null);
        (&feature["place"], System::stated(stated, options)?)
    } else if feature["geometry"].is_object() {
        (&feature["geometry"], System::degrees(options)?)
    } else {
        shapes.skip("feature without a geometry");
        return Ok(());
    };
    let Some(lines) = lines(geometry) else {
        let kind: String = geometry["type"]
            .as_str()
            .unwrap_or("?")
            .chars()
            .take(40)
            .collect();
        shapes.skip(&kind);
        return Ok(());
    };
    let mut id = id_of(properties).or_else(|| id_of(feature));
    for coordinates in lines {
        let points = points(coordinates, &system)?;
        let line = Line {
            id: id.take(),
            evidence: evidence(properties, points.len()),
            points,
        };
        shapes.add(role, line)?;
    }
    Ok(())
}

fn id_of(holder: &Value) -> Option<u64> {
    let id = &holder["id"];
    id.as_u64().or_else(|| id.as_str()?.parse().ok())
}

/// The position lists of the lines of a geometry, rings of areas included; `None` for points and worse.
fn lines(geometry: &Value) -> Option<Vec<&Value>> {
    let coordinates = &geometry["coordinates"];
    let items = |value: &'_ Value| value.as_array().map(Vec::len).unwrap_or_default();
    let each = |value: &'static str| value == geometry["type"].as_str().unwrap_or("");
    if each("LineString") {
        Some(vec![coordinates])
    } else if each("MultiLineString") || each("Polygon") {
        Some((0..items(coordinates)).map(|k| &coordinates[k]).collect())
    } else if each("MultiPolygon") {
        let rings = |k: usize| (0..items(&coordinates[k])).map(move |r| &coordinates[k][r]);
        Some((0..items(coordinates)).flat_map(rings).collect())
    } else {
        None
    }
}

fn points(coordinates: &Value, system: &System) -> Result<Vec<Point>, String> {
    let positions = coordinates
        .as_array()
        .ok_or("`coordinates` is no list of positions")?;
    let point = |position: &Value| {
        let number = |k: usize| position[k].as_f64();
        let (Some(x), Some(y)) = (number(0), number(1)) else {
            let found: String = position.to_string().chars().take(40).collect();
            return Err(format!("the position {found} is no pair of numbers"));
        };
        system.map_point(x, y)
    };
    positions.iter().map(point).collect()
}

/// What the vertices rest on; empty unless the properties have it for all of them.
fn evidence(properties: &Value, vertices: usize) -> Vec<(u32, f64)> {
    // Some programs write lists into properties as text.
    let list = |key: &str| -> Option<Vec<Value>> {
        let value = &properties[key];
        let parsed = value.as_str().and_then(|text| serde_json::from_str(text).ok());
        parsed
            .unwrap_or(value.clone())
            .as_array()
            .cloned()
            .filter(|l| l.len() == vertices)
    };
    let (Some(observations), Some(sigma_m)) = (list("observations"), list("sigma_m")) else {
        return Vec::new();
    };
    let count = |v: &Value| v.as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(0);
    let sigma = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
    observations
        .iter()
        .zip(&sigma_m)
        .map(|(n, s)| (count(n), sigma(s)))
        .collect()
}

/// What the numbers of a position mean.
enum System {
    Metres(f64),
    Degrees(Georef),
    Utm(Georef, UtmZone),
}

impl System {
    /// What a `coordRefSys` names.
    fn stated(name: &Value, options: &ImportOptions) -> Result<Self, String> {
        let uri = name.as_str().or_else(|| name["href"].as_str());
        let Some(uri) = uri else {
            // By the standard longitude and latitude.
            return Self::degrees(options);
        };
        if uri == ENGINEERING_2D || uri == "[OGC:Engineering2D]" {
            return Ok(Self::Metres(1.0));
        }
        if uri.contains("CRS84") {
            return Self::degrees(options);
        }
        let shown: String = uri.chars().take(80).collect();
        let zone = uri
            .rsplit(['/', ':'])
            .next()
            .and_then(|code| zone(code.trim_end_matches(']')));
        let zone = zone.ok_or_else(|| {
            format!("`coordRefSys` is {shown}; the map frame ({ENGINEERING_2D}), UTM or CRS84 are expected")
        })?;
        let georef = options.georef.ok_or_else(|| {
            format!("it lies in {shown}: give --georef lat,lon,bearing as the export had it")
        })?;
        Ok(Self::Utm(georef, zone))
    }

    fn degrees(options: &ImportOptions) -> Result<Self, String> {
        match (options.georef, options.metres_per_unit) {
            (Some(georef), _) => Ok(Self::Degrees(georef)),
            (None, Some(scale)) => Ok(Self::Metres(scale)),
            (None, None) => Err("a GeoJSON `geometry` is longitude and latitude: give --georef lat,lon,bearing as the export had it, or \
                                 --metres-per-unit 1 if the numbers are metres of the map"
                .to_owned()),
        }
    }

    fn map_point(&self, x: f64, y: f64) -> Result<Point, String> {
        match *self {
            Self::Metres(scale) => Ok(Point::new(x * scale, y * scale)),
            Self::Degrees(georef) => {
                if !(x.abs() <= 540.0 && y.abs() <= 90.0) {
                    return Err(format!(
                        "({x}, {y}) is no longitude and latitude; if the numbers are metres, give --metres-per-unit 1 and no --georef"
                    ));
                }
                Ok(georef.map_from_earth(Geographic {
                    latitude_rad: y.to_radians(),
                    longitude_rad: x.to_radians(),
                }))
            }
            Self::Utm(georef, zone) => Ok(from_utm(georef, zone, Point::new(x, y))),
        }
    }
}

fn zone(code: &str) -> Option<UtmZone> {
    let code: u16 = code.parse().ok()?;
    let number = code % 100;
    ((code / 100 == 326 || code / 100 == 327) && (1..=60).contains(&number)).then_some(UtmZone {
        number,
        south: code / 100 == 327,
    })
}

/// Where a point of the grid is in the map, by Newton's method: the grid is the map turned and hardly stretched,
/// so that every round gains many digits.
fn from_utm(georef: Georef, zone: UtmZone, target: Point) -> Point {
    const STEP_M: f64 = 1.0;
    let project = |p: Point| zone.project(georef.earth_from_map(p));
    let mut p = Point::new(0.0, 0.0);
    for _ in 0..6 {
        let here = project(p);
        let along_x = project(p + Point::new(STEP_M, 0.0)) - here;
        let along_y = project(p + Point::new(0.0, STEP_M)) - here;
        let missing = target - here;
        let area = along_x.x * along_y.y - along_x.y * along_y.x;
        p += Point::new(
            (missing.x * along_y.y - missing.y * along_y.x) / area,
            (along_x.x * missing.y - along_x.y * missing.x) / area,
        );
    }
    p
}
