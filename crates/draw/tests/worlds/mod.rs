//! Small worlds to draw, and ways to look at the drawings.

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::{EraserBox, Map, MapPolyline, MapVertex};
use polymapper_draw::{Layer, Panel, Scene, Stroke, TrajectoryPoint, map_picture, palette, to_png, to_svg};

/// A room of this size with its lower left corner at the origin, and nothing else.
pub fn closed_room(width_m: f64, height_m: f64) -> Scene {
    let corners = [
        (0.0, 0.0),
        (width_m, 0.0),
        (width_m, height_m),
        (0.0, height_m),
        (0.0, 0.0),
    ];
    let mut layer = Layer::new("walls");
    layer.line(
        corners.map(|(x, y)| Point::new(x, y)),
        Stroke::new(palette::INK, 6.0),
    );
    Scene::of(Panel::new("").with(layer))
}

pub fn map_polyline(corners: &[(f64, f64)]) -> MapPolyline {
    let vertex = |(x, y): &(f64, f64)| MapVertex {
        point: Point::new(*x, *y),
        observations: 1,
        sigma_m: 0.01,
    };
    MapPolyline {
        id: 0,
        vertices: corners.iter().map(vertex).collect(),
    }
}

/// A room of 4 m by 3 m with a door and a pillar.
pub fn room_map() -> Map {
    let room = [
        (2.5, 3.0),
        (0.0, 3.0),
        (0.0, 0.0),
        (4.0, 0.0),
        (4.0, 3.0),
        (3.5, 3.0),
    ];
    let pillar = [(1.0, 1.0), (1.0, 1.4), (1.4, 1.4), (1.4, 1.0), (1.0, 1.0)];
    let plant = EraserBox {
        min: Point::new(3.2, 0.2),
        max: Point::new(3.8, 0.8),
    };
    Map {
        polylines: vec![map_polyline(&room), map_polyline(&pillar)],
        eraser_boxes: vec![plant],
    }
}

/// The picture of [`room_map`] with a way through the door.
pub fn small_map() -> Scene {
    let way = [
        (2.0, 0.5, true),
        (2.2, 1.0, true),
        (2.5, 1.8, false),
        (2.8, 2.2, true),
        (3.0, 2.8, true),
    ];
    let way = way.map(|(x, y, placed)| TrajectoryPoint {
        map_from_scan: Pose::new(x, y, 1.2),
        placed,
        is_uncertain: false,
    });
    map_picture(&room_map(), &way, "Room & door")
}

/// A decoded PNG, RGB.
pub struct Image {
    pub width: u32,
    pub height: u32,
    rgb: Vec<u8>,
}

pub fn drawn(scene: &Scene) -> Image {
    let bytes = to_png(scene).expect("a picture");
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .expect("a PNG header");
    let mut rgb = vec![0; reader.output_buffer_size().expect("a size that fits")];
    let info = reader.next_frame(&mut rgb).expect("pixels");
    assert_eq!(info.color_type, png::ColorType::Rgb);
    Image {
        width: info.width,
        height: info.height,
        rgb,
    }
}

/// Brightness of the green of a pixel: 0 black, 255 paper.
pub fn ink_at(image: &Image, (x, y): (f64, f64)) -> u8 {
    let at = (y as usize * image.width as usize + x as usize) * 3;
    image.rgb[at + 1]
}

/// The pixel of a point of the world, by what the SVG says about its first panel.
pub fn pixel_of(scene: &Scene, (x_m, y_m): (f64, f64)) -> (f64, f64) {
    let svg = to_svg(scene);
    let value = |name: &str| -> f64 {
        let after = svg
            .split(&format!("data-{name}=\""))
            .nth(1)
            .expect("a panel with a scale");
        after
            .split('"')
            .next()
            .and_then(|v| v.parse().ok())
            .expect("a number")
    };
    let metres_per_px = value("metres-per-px");
    (
        (x_m - value("x0-m")) / metres_per_px,
        (value("y0-m") - y_m) / metres_per_px,
    )
}
