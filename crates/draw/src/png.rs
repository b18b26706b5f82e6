//! A plate as PNG: the same items as the SVG, drawn with anti-aliasing.

use png::{BitDepth, ColorType, Encoder, PixelDimensions, Unit};
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};
use ttf_parser::OutlineBuilder;

use crate::colour::{Colour, palette};
use crate::font::{self, SUBSCRIPT_DROP, SUBSCRIPT_SIZE};
use crate::layout;
use crate::plate::{Anchor, Ink, Item, Pen, Plate, Px, Text};
use crate::scene::{Face, Scene};

/// Neither side of a picture is longer, whatever the caption.
const LONGEST_PX: f64 = 2400.0;
/// Pixels a metre of paper: a page of 2000 px is 17 cm wide, at 300 dots an inch.
const PRINT_PX_A_METRE: u32 = 11_811;
/// Dots drawn in one go; small enough for the rasteriser's edge lists.
const DOTS_AT_ONCE: usize = 512;

/// Why a picture was not made.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// There is no memory for the pixels.
    #[error("no memory for a picture of {width} by {height} pixels")]
    Memory {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The pixels could not be encoded.
    #[error("the picture cannot be encoded as PNG")]
    Encoding(#[from] png::EncodingError),
}

/// Draws a scene as PNG, white ground, 8 bit RGB.
///
/// # Errors
/// No memory for the pixels, or a failure of the encoder.
pub fn to_png(scene: &Scene) -> Result<Vec<u8>, PngError> {
    let plate = layout::plate(scene);
    let pixmap = raster(&plate)?;
    let rgb: Vec<u8> = pixmap
        .data()
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, pixmap.width(), pixmap.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: PRINT_PX_A_METRE,
        yppu: PRINT_PX_A_METRE,
        unit: Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

fn raster(plate: &Plate) -> Result<Pixmap, PngError> {
    let shrink = (LONGEST_PX / plate.width.max(plate.height)).min(1.0);
    let (width, height) = (
        (plate.width * shrink).ceil() as u32,
        (plate.height * shrink).ceil() as u32,
    );
    let pixmap = Pixmap::new(width.max(1), height.max(1)).ok_or(PngError::Memory { width, height })?;
    let mut canvas = Canvas {
        pixmap,
        shrink: Transform::from_scale(shrink as f32, shrink as f32),
    };
    canvas.pixmap.fill(Color::WHITE);
    for layer in plate.panels.iter().flat_map(|panel| &panel.layers) {
        canvas.items(&layer.items);
    }
    canvas.items(&plate.page);
    Ok(canvas.pixmap)
}

struct Canvas {
    pixmap: Pixmap,
    shrink: Transform,
}

impl Canvas {
    fn items(&mut self, items: &[Item]) {
        for item in items {
            self.item(item);
        }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Lines { lines, pen } | Item::Raster { lines, pen } => {
                let mut path = PathBuilder::new();
                for line in lines {
                    trace(line, &mut path);
                }
                self.draw(path.finish(), None, Some(pen));
            }
            Item::Area { corners, fill, pen } => {
                let mut path = PathBuilder::new();
                trace(corners, &mut path);
                path.close();
                self.draw(path.finish(), fill.as_ref(), pen.as_ref());
            }
            Item::Dots {
                centres,
                radius,
                colour,
            } => {
                for some in centres.chunks(DOTS_AT_ONCE) {
                    self.draw(
                        dots(some, *radius),
                        Some(&Ink {
                            colour: *colour,
                            opacity: 1.0,
                        }),
                        None,
                    );
                }
            }
            Item::Circle {
                centre,
                radius,
                fill,
                pen,
            } => {
                let circle = PathBuilder::from_circle(centre.x as f32, centre.y as f32, *radius as f32);
                self.draw(circle, fill.as_ref(), pen.as_ref());
            }
            Item::Text(text) => self.words(text),
        }
    }

    /// A path without extent (`None`) leaves nothing.
    fn draw(&mut self, path: Option<Path>, fill: Option<&Ink>, pen: Option<&Pen>) {
        let Some(path) = path else { return };
        if let Some(ink) = fill {
            self.pixmap.fill_path(
                &path,
                &paint(ink.colour, ink.opacity),
                FillRule::Winding,
                self.shrink,
                None,
            );
        }
        if let Some(pen) = pen {
            let stroke = Stroke {
                width: pen.width as f32,
                line_cap: if pen.butt { LineCap::Butt } else { LineCap::Round },
                line_join: LineJoin::Round,
                dash: StrokeDash::new(pen.dashes.iter().map(|d| *d as f32).collect(), 0.0),
                ..Stroke::default()
            };
            self.pixmap
                .stroke_path(&path, &paint(pen.colour, pen.opacity), &stroke, self.shrink, None);
        }
    }

    fn words(&mut self, text: &Text) {
        let width = text.size * font::width_with_subscript(&text.text, &text.subscript, text.face);
        let left = match text.anchor {
            Anchor::Start => text.x,
            Anchor::Middle => text.x - 0.5 * width,
        };
        let mut outlines = Outlines(PathBuilder::new());
        font::outline(&text.text, text.face, text.size, left, text.y, &mut outlines);
        if !text.subscript.is_empty() {
            let after = left + text.size * font::width(&text.text, text.face);
            let (size, base) = (SUBSCRIPT_SIZE * text.size, text.y + SUBSCRIPT_DROP * text.size);
            font::outline(&text.subscript, Face::Regular, size, after, base, &mut outlines);
        }
        let Some(path) = outlines.0.finish() else { return };
        if text.halo {
            let rim = Pen {
                colour: palette::WHITE,
                width: 0.22 * text.size,
                dashes: Vec::new(),
                opacity: 1.0,
                butt: false,
            };
            self.draw(Some(path.clone()), None, Some(&rim));
        }
        self.draw(
            Some(path),
            Some(&Ink {
                colour: text.colour,
                opacity: 1.0,
            }),
            None,
        );
    }
}

fn paint(colour: Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    paint.set_color_rgba8(
        colour.red,
        colour.green,
        colour.blue,
        (opacity * 255.0).round() as u8,
    );
    paint
}

fn trace(points: &[Px], path: &mut PathBuilder) {
    for (k, p) in points.iter().enumerate() {
        if k == 0 {
            path.move_to(p.x as f32, p.y as f32);
        } else {
            path.line_to(p.x as f32, p.y as f32);
        }
    }
}

/// Larger dots are round; smaller ones eight-sided, which no eye tells apart and costs a third.
const ROUND_FROM_PX: f64 = 2.5;

/// Discs; small ones as octagons of the same area.
fn dots(centres: &[Px], radius: f64) -> Option<Path> {
    let (long, short) = (1.03 * radius * 0.9239, 1.03 * radius * 0.3827);
    let corners = [
        (long, short),
        (short, long),
        (-short, long),
        (-long, short),
        (-long, -short),
        (-short, -long),
        (short, -long),
        (long, -short),
    ];
    let mut path = PathBuilder::new();
    for centre in centres {
        if radius >= ROUND_FROM_PX {
            path.push_circle(centre.x as f32, centre.y as f32, radius as f32);
            continue;
        }
        trace(&corners.map(|(x, y)| *centre + Px::new(x, y)), &mut path);
        path.close();
    }
    path.finish()
}

struct Outlines(PathBuilder);

impl OutlineBuilder for Outlines {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
