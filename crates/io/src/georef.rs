//! Where on Earth a map lies: map frame ⇄ WGS 84 ⇄ UTM.
//!
//! In goes where the map's origin lies and where its x axis points. The map is laid on the plane that touches the
//! ellipsoid at the origin (east, north, up), its points are taken to Earth-centred coordinates and from there to
//! latitude and longitude; the height of the plane above the ellipsoid, 0.08 m at 1 km, is dropped. UTM is the
//! transverse Mercator projection by Krüger's series (Karney 2011, "Transverse Mercator with an accuracy of a few
//! nanometers", to n⁴: 1 µm inside a zone).

use std::str::FromStr;

use polymapper_core::geometry::Point;

/// Half of the longest axis of the WGS 84 ellipsoid, metres.
const A_M: f64 = 6_378_137.0;
/// Flattening of the WGS 84 ellipsoid.
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Square of its eccentricity.
const E2: f64 = FLATTENING * (2.0 - FLATTENING);
/// Beyond these UTM is not defined, degrees.
const UTM_LATITUDES_DEG: [f64; 2] = [-80.0, 84.0];

/// Latitude and longitude, WGS 84.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geographic {
    /// North of the equator, radians.
    pub latitude_rad: f64,
    /// East of Greenwich, radians.
    pub longitude_rad: f64,
}

/// Where the frame of a map lies on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Georef {
    origin: Geographic,
    /// Direction of the map's x axis, clockwise from true north, radians.
    bearing_rad: f64,
}

/// Why a place on Earth cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GeorefError {
    /// Not three numbers.
    #[error(
        "\"{found}\": latitude, longitude and bearing of the map's x axis in degrees are expected, such as 48.0123,7.8345,90"
    )]
    Form {
        /// What was given.
        found: String,
    },
    /// A number out of its range.
    #[error("{what} is {found}°, {low}° to {high}° are expected")]
    Range {
        /// Which number.
        what: &'static str,
        /// What was given.
        found: f64,
        /// Least that can be.
        low: f64,
        /// Most that can be.
        high: f64,
    },
}

impl FromStr for Georef {
    type Err = GeorefError;

    /// Reads `lat,lon,bearing` in degrees; the bearing is that of the map's x axis, clockwise from true north.
    fn from_str(text: &str) -> Result<Self, GeorefError> {
        let numbers: Vec<f64> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
        let (3, &[latitude, longitude, bearing]) = (text.split(',').count(), numbers.as_slice()) else {
            return Err(GeorefError::Form {
                found: text.to_owned(),
            });
        };
        // At the poles themselves east and north mean nothing.
        within("the latitude", latitude, -89.9, 89.9)?;
        within("the longitude", longitude, -180.0, 180.0)?;
        within("the bearing", bearing, -360.0, 360.0)?;
        Ok(Self {
            origin: Geographic {
                latitude_rad: latitude.to_radians(),
                longitude_rad: longitude.to_radians(),
            },
            bearing_rad: bearing.to_radians(),
        })
    }
}

fn within(what: &'static str, found: f64, low: f64, high: f64) -> Result<(), GeorefError> {
    if (low..=high).contains(&found) {
        return Ok(());
    }
    Err(GeorefError::Range {
        what,
        found,
        low,
        high,
    })
}

impl Georef {
    /// The point `p` of the map, metres, on Earth.
    #[must_use]
    pub fn earth_from_map(&self, p: Point) -> Geographic {
        geographic(self.earth_centred(self.east_north(p), 0.0)).0
    }

    /// Where a place on Earth lies in the map, metres: the inverse of [`Georef::earth_from_map`].
    #[must_use]
    pub fn map_from_earth(&self, place: Geographic) -> Point {
        let mut height_m = 0.0;
        let mut p = Point::new(0.0, 0.0);
        // The height of the touching plane above the place depends on where it is: known after one round to 1 µm.
        for _ in 0..3 {
            p = self.map_point(self.touching(earth_centred(place, height_m)));
            height_m = geographic(self.earth_centred(self.east_north(p), 0.0)).1;
        }
        p
    }

    /// The UTM zone of the origin; `None` towards the poles, where there is none.
    #[must_use]
    pub fn utm(&self) -> Option<UtmZone> {
        let latitude_deg = self.origin.latitude_rad.to_degrees();
        let number = ((self.origin.longitude_rad.to_degrees() + 180.0) / 6.0).floor() + 1.0;
        (UTM_LATITUDES_DEG[0]..=UTM_LATITUDES_DEG[1])
            .contains(&latitude_deg)
            .then(|| UtmZone {
                number: number.clamp(1.0, 60.0) as u16,
                south: latitude_deg < 0.0,
            })
    }

    fn east_north(&self, p: Point) -> Point {
        let (sin, cos) = self.bearing_rad.sin_cos();
        Point::new(sin * p.x - cos * p.y, cos * p.x + sin * p.y)
    }

    fn map_point(&self, p: Point) -> Point {
        let (sin, cos) = self.bearing_rad.sin_cos();
        Point::new(sin * p.x + cos * p.y, sin * p.y - cos * p.x)
    }

    /// East, north, up at the origin → Earth-centred.
    fn earth_centred(&self, p: Point, up_m: f64) -> [f64; 3] {
        let [x, y, z] = earth_centred(self.origin, 0.0);
        let [east, north, up] = self.axes();
        let along = |k: usize| east[k] * p.x + north[k] * p.y + up[k] * up_m;
        [x + along(0), y + along(1), z + along(2)]
    }

    /// Earth-centred → east, north at the origin.
    fn touching(&self, place: [f64; 3]) -> Point {
        let origin = earth_centred(self.origin, 0.0);
        let [east, north, _] = self.axes();
        let along = |axis: [f64; 3]| (0..3).map(|k| axis[k] * (place[k] - origin[k])).sum();
        Point::new(along(east), along(north))
    }

    fn axes(&self) -> [[f64; 3]; 3] {
        let (sin_lat, cos_lat) = self.origin.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.origin.longitude_rad.sin_cos();
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    }
}

fn earth_centred(place: Geographic, height_m: f64) -> [f64; 3] {
    let (sin, cos) = place.latitude_rad.sin_cos();
    let normal_m = A_M / (1.0 - E2 * sin * sin).sqrt();
    let from_axis_m = (normal_m + height_m) * cos;
    let (sin_lon, cos_lon) = place.longitude_rad.sin_cos();
    [
        from_axis_m * cos_lon,
        from_axis_m * sin_lon,
        (normal_m * (1.0 - E2) + height_m) * sin,
    ]
}

/// Latitude, longitude, and the height above the ellipsoid. Each round shrinks the error of the latitude by e².
fn geographic([x, y, z]: [f64; 3]) -> (Geographic, f64) {
    let from_axis_m = x.hypot(y);
    let mut latitude_rad = z.atan2(from_axis_m * (1.0 - E2));
    let mut normal_m = A_M;
    for _ in 0..6 {
        let sin = latitude_rad.sin();
        normal_m = A_M / (1.0 - E2 * sin * sin).sqrt();
        latitude_rad = (z + E2 * normal_m * sin).atan2(from_axis_m);
    }
    let (sin, cos) = latitude_rad.sin_cos();
    let height_m = from_axis_m * cos + z * sin - normal_m * (1.0 - E2 * sin * sin);
    let place = Geographic {
        latitude_rad,
        longitude_rad: y.atan2(x),
    };
    (place, height_m)
}

/// A zone of the Universal Transverse Mercator grid on WGS 84.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UtmZone {
    /// 1 to 60, eastwards from 180° W.
    pub number: u16,
    /// South of the equator, where northings begin at −10 000 km.
    pub south: bool,
}

impl UtmZone {
    /// Code in the EPSG register.
    #[must_use]
    pub fn epsg(self) -> u16 {
        (if self.south { 32_700 } else { 32_600 }) + self.number
    }

    /// Longitude of the zone's middle, degrees.
    #[must_use]
    pub fn central_meridian_deg(self) -> f64 {
        f64::from(self.number) * 6.0 - 183.0
    }

    /// Easting and northing, metres.
    #[must_use]
    pub fn project(self, place: Geographic) -> Point {
        const SCALE: f64 = 0.9996;
        let n = FLATTENING / (2.0 - FLATTENING);
        let (n2, n3, n4) = (n * n, n * n * n, n * n * n * n);
        let radius_m = A_M / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0);
        let alpha = [
            n / 2.0 - 2.0 / 3.0 * n2 + 5.0 / 16.0 * n3 + 41.0 / 180.0 * n4,
            13.0 / 48.0 * n2 - 3.0 / 5.0 * n3 + 557.0 / 1440.0 * n4,
            61.0 / 240.0 * n3 - 103.0 / 140.0 * n4,
            49_561.0 / 161_280.0 * n4,
        ];
        let e = E2.sqrt();
        let sin = place.latitude_rad.sin();
        let t = (sin.atanh() - e * (e * sin).atanh()).sinh();
        let from_middle_rad = place.longitude_rad - self.central_meridian_deg().to_radians();
        let xi = t.atan2(from_middle_rad.cos());
        let eta = (from_middle_rad.sin() / (1.0 + t * t).sqrt()).atanh();
        let (mut east, mut north) = (eta, xi);
        for (k, a) in alpha.iter().enumerate() {
            let twice = 2.0 * (k as f64 + 1.0);
            north += a * (twice * xi).sin() * (twice * eta).cosh();
            east += a * (twice * xi).cos() * (twice * eta).sinh();
        }
        let false_northing_m = if self.south { 1e7 } else { 0.0 };
        Point::new(
            500_000.0 + SCALE * radius_m * east,
            false_northing_m + SCALE * radius_m * north,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(latitude_deg: f64, longitude_deg: f64) -> Geographic {
        Geographic {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
        }
    }

    #[test]
    fn x_points_where_the_bearing_says_and_y_to_its_left() {
        let east: Georef = "48.0,7.8,90".parse().unwrap();
        let ahead = east.earth_from_map(Point::new(100.0, 0.0));
        assert!((ahead.longitude_rad.to_degrees() - 7.8).abs() > 0.001);
        assert!((ahead.latitude_rad.to_degrees() - 48.0).abs() < 1e-7);
        // A minute of latitude is about 1852 m (1853 m at 48°).
        let left = east.earth_from_map(Point::new(0.0, 1853.0));
        assert!((left.latitude_rad.to_degrees() - 48.0 - 1.0 / 60.0).abs() < 1e-5);
    }

    #[test]
    fn there_and_back_is_a_micrometre_near_and_far() {
        let georef: Georef = "-33.86,151.21,-123.4".parse().unwrap();
        for p in [
            Point::new(0.0, 0.0),
            Point::new(-80.0, 250.0),
            Point::new(5000.0, -9000.0),
        ] {
            let back = georef.map_from_earth(georef.earth_from_map(p));
            assert!(back.distance(p) < 1e-6, "{p:?} {back:?}");
        }
    }

    /// The CN Tower in Toronto, the usual worked example: 43°38'33.24" N 79°23'13.7" W is 630 084 m E, 4 833 438
    /// m N in zone 17.
    #[test]
    fn utm_of_a_known_tower() {
        let tower = place(
            43.0 + 38.0 / 60.0 + 33.24 / 3600.0,
            -(79.0 + 23.0 / 60.0 + 13.7 / 3600.0),
        );
        let zone = UtmZone {
            number: 17,
            south: false,
        };
        assert!(zone.project(tower).distance(Point::new(630_084.0, 4_833_438.0)) < 1.0);
        assert_eq!(zone.epsg(), 32617);
    }

    #[test]
    fn what_is_no_place_is_refused_with_words() {
        let fault = |text: &str| text.parse::<Georef>().unwrap_err().to_string();
        assert!(fault("48.1,7.8").contains("latitude, longitude and bearing"));
        assert!(fault("48.1,7.8,x").contains("are expected, such as"));
        assert!(fault("148.1,7.8,0").contains("the latitude is 148.1°"));
        assert!(fault("NaN,7.8,0").contains("the latitude is NaN°"));
    }
}
