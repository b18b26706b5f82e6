//! Scene → plate: where everything goes.
//!
//! In: a [`Scene`]. Out: a [`Plate`] whose longer side is [`Scene::longest_side_px`] (a little more when a
//! caption is very long). The number of columns is the one that shows the world largest, without leaving much of the page empty.

mod arrange;
mod cloud;
mod compose;
mod furniture;
mod label;
mod marks;
mod page;
mod view;
mod views;

use crate::colour::Colour;
use crate::plate::{Ink, Pen};
use crate::scene::Stroke;

pub(crate) use page::plate;

fn ink(colour: Colour, opacity: f64) -> Ink {
    Ink {
        colour,
        opacity: opacity.clamp(0.0, 1.0),
    }
}

fn pen_of(stroke: &Stroke, unit: f64) -> Pen {
    let width = (stroke.width_px * unit).clamp(0.2, 200.0);
    Pen {
        colour: stroke.colour,
        width,
        dashes: marks::dashes(stroke.dash, width, unit),
        opacity: stroke.opacity.clamp(0.0, 1.0),
        butt: stroke.flat,
    }
}
