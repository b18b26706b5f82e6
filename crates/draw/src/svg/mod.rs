//! A plate as SVG text.
//!
//! Panels and layers are groups that Inkscape shows as layers. The drawing is in pixels, y down; each panel's
//! group says how to get back to metres: `x_m = data-x0-m + x · data-metres-per-px` and
//! `y_m = data-y0-m − y · data-metres-per-px`. Paths are written as moves between hundredths of a pixel, so that
//! rounding does not add up along a line. Titles, captions and legends carry their length, because a viewer
//! without the font takes another, which may be wider than the page has room for. The same scene gives the same
//! bytes.

mod number;
mod word;

use std::fmt::Write as _;

use crate::font::{self, SUBSCRIPT_DROP, SUBSCRIPT_SIZE};
use crate::layout;
use crate::plate::{Anchor, Ink, Item, Pen, Plate, PlateLayer, PlatePanel, Px, Text};
use crate::scene::{Face, Scene};
use number::{dots, number, path, significant};
use word::{escaped, id_part};

const FONTS: &str = "'Noto Sans','DejaVu Sans',Verdana,Arial,sans-serif";

/// Draws a scene as SVG.
#[must_use]
pub fn to_svg(scene: &Scene) -> String {
    let mut svg = Svg::default();
    svg.plate(&layout::plate(scene));
    svg.text
}

#[derive(Default)]
struct Svg {
    text: String,
}

impl Svg {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn plate(&mut self, plate: &Plate) {
        let (width, height) = (number(plate.width), number(plate.height));
        self.line(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
             width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\">"
        ));
        if !plate.title.is_empty() {
            self.line(&format!("<title>{}</title>", escaped(&plate.title)));
        }
        self.line(&format!(
            "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
        ));
        for (k, panel) in plate.panels.iter().enumerate() {
            self.panel(k + 1, panel);
        }
        if !plate.page.is_empty() {
            self.line("<g id=\"page\" inkscape:groupmode=\"layer\" inkscape:label=\"title and caption\">");
            self.items(&plate.page);
            self.line("</g>");
        }
        self.line("</svg>");
    }

    fn panel(&mut self, number: usize, panel: &PlatePanel) {
        self.line(&format!(
            "<g id=\"panel{number}\" inkscape:groupmode=\"layer\" inkscape:label=\"{}\" data-metres-per-px=\"{}\" \
             data-x0-m=\"{}\" data-y0-m=\"{}\">",
            escaped(&panel.name),
            significant(panel.metres_per_px),
            significant(panel.x0_m),
            significant(panel.y0_m),
        ));
        for (k, layer) in panel.layers.iter().enumerate() {
            self.layer(
                &format!("panel{number}-{}-{}", k + 1, id_part(&layer.name)),
                layer,
            );
        }
        self.line("</g>");
    }

    fn layer(&mut self, id: &str, layer: &PlateLayer) {
        let label = escaped(&layer.name);
        self.line(&format!(
            "<g id=\"{id}\" inkscape:groupmode=\"layer\" inkscape:label=\"{label}\">"
        ));
        self.items(&layer.items);
        self.line("</g>");
    }

    fn items(&mut self, items: &[Item]) {
        for item in items {
            self.item(item);
        }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Lines { lines, pen } => self.lines(lines, pen),
            Item::Raster { lines, pen } => {
                let paths: String = lines.iter().map(|line| path(line, false)).collect();
                self.line(&format!(
                    "<path d=\"{paths}\" fill=\"none\"{}/>",
                    pen_of(Some(pen))
                ));
            }
            Item::Area { corners, fill, pen } => {
                let path = path(corners, true);
                self.line(&format!(
                    "<path d=\"{path}\"{}{}/>",
                    fill_of(fill.as_ref()),
                    pen_of(pen.as_ref())
                ));
            }
            Item::Dots {
                centres,
                radius,
                colour,
            } => {
                self.line(&format!(
                    "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>",
                    dots(centres),
                    colour.hex(),
                    number(2.0 * radius)
                ));
            }
            Item::Circle {
                centre,
                radius,
                fill,
                pen,
            } => self.line(&format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}{}/>",
                number(centre.x),
                number(centre.y),
                number(*radius),
                fill_of(fill.as_ref()),
                pen_of(pen.as_ref())
            )),
            Item::Text(text) => self.words(text),
        }
    }

    /// Lines of one pen: one path each, so that each can be taken hold of in an editor.
    fn lines(&mut self, lines: &[Vec<Px>], pen: &Pen) {
        if let [line] = lines {
            self.line(&format!(
                "<path d=\"{}\" fill=\"none\"{}/>",
                path(line, false),
                pen_of(Some(pen))
            ));
            return;
        }
        self.line(&format!("<g fill=\"none\"{}>", pen_of(Some(pen))));
        for line in lines {
            self.line(&format!("<path d=\"{}\"/>", path(line, false)));
        }
        self.line("</g>");
    }

    fn words(&mut self, text: &Text) {
        let mut style = String::new();
        if text.anchor == Anchor::Middle {
            style.push_str(" text-anchor=\"middle\"");
        }
        match text.face {
            Face::Regular => {}
            Face::Bold => style.push_str(" font-weight=\"bold\""),
            Face::Italic => style.push_str(" font-style=\"italic\""),
        }
        if text.halo {
            let width = number(0.22 * text.size);
            let _ = write!(
                style,
                " stroke=\"#ffffff\" stroke-width=\"{width}\" paint-order=\"stroke\""
            );
        }
        // Labels stand free and are short; viewers disagree about the length of text with a subscript.
        let length = text.size * font::width(&text.text, text.face);
        if length > 0.0 && !text.halo {
            let _ = write!(
                style,
                " textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"",
                number(length)
            );
        }
        let mut body = escaped(&text.text);
        if !text.subscript.is_empty() {
            let _ = write!(
                body,
                "<tspan dy=\"{}\" font-size=\"{}\" font-style=\"normal\">{}</tspan>",
                number(SUBSCRIPT_DROP * text.size),
                number(SUBSCRIPT_SIZE * text.size),
                escaped(&text.subscript)
            );
        }
        self.line(&format!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"{style}>{body}</text>",
            number(text.x),
            number(text.y),
            number(text.size),
            text.colour.hex()
        ));
    }
}

fn fill_of(fill: Option<&Ink>) -> String {
    match fill {
        None => " fill=\"none\"".to_owned(),
        Some(ink) => format!(
            " fill=\"{}\"{}",
            ink.colour.hex(),
            opacity("fill-opacity", ink.opacity)
        ),
    }
}

fn pen_of(pen: Option<&Pen>) -> String {
    let Some(pen) = pen else { return String::new() };
    let mut style = format!(
        " stroke=\"{}\" stroke-width=\"{}\"",
        pen.colour.hex(),
        number(pen.width)
    );
    style.push_str(&opacity("stroke-opacity", pen.opacity));
    if !pen.dashes.is_empty() {
        let dashes: Vec<String> = pen.dashes.iter().map(|d| number(*d)).collect();
        let _ = write!(style, " stroke-dasharray=\"{}\"", dashes.join(" "));
    }
    if pen.butt {
        style.push_str(" stroke-linecap=\"butt\"");
    }
    style
}

fn opacity(name: &str, value: f64) -> String {
    if value < 1.0 {
        format!(" {name}=\"{}\"", number(value))
    } else {
        String::new()
    }
}
