//! Letters: widths for the layout, outlines for the PNG.
//!
//! The font (Noto Sans, SIL Open Font Licence) is compiled in, so that a picture has the same text on every
//! machine and none is needed on a robot. No kerning: the captions are short and plain.

use std::sync::OnceLock;

use ttf_parser::{Face as Ttf, GlyphId, OutlineBuilder};

use crate::scene::Face;

/// Size of a subscript and how far it hangs below the base line, as shares of the text size.
pub(crate) const SUBSCRIPT_SIZE: f64 = 0.7;
/// See [`SUBSCRIPT_SIZE`].
pub(crate) const SUBSCRIPT_DROP: f64 = 0.22;

fn ttf(face: Face) -> Option<&'static Ttf<'static>> {
    static FACES: [OnceLock<Option<Ttf<'static>>>; 3] = [const { OnceLock::new() }; 3];
    let (slot, bytes) = match face {
        Face::Regular => (&FACES[0], notosans::REGULAR_TTF),
        Face::Bold => (&FACES[1], notosans::BOLD_TTF),
        Face::Italic => (&FACES[2], notosans::ITALIC_TTF),
    };
    slot.get_or_init(|| Ttf::parse(bytes, 0).ok()).as_ref()
}

fn glyph(ttf: &Ttf<'_>, letter: char) -> Option<GlyphId> {
    ttf.glyph_index(letter).or_else(|| ttf.glyph_index('?'))
}

/// Control characters have no picture; the SVG leaves them out as well.
fn letters(text: &str) -> impl Iterator<Item = char> + '_ {
    text.chars().filter(|letter| !letter.is_control())
}

fn advance(ttf: &Ttf<'_>, letter: char) -> f64 {
    let units = glyph(ttf, letter)
        .and_then(|g| ttf.glyph_hor_advance(g))
        .unwrap_or(0);
    f64::from(units) / f64::from(ttf.units_per_em())
}

/// Width of `text` at size 1.
pub(crate) fn width(text: &str, face: Face) -> f64 {
    ttf(face).map_or(0.0, |ttf| letters(text).map(|letter| advance(ttf, letter)).sum())
}

/// Width of `text` with a subscript, at size 1.
pub(crate) fn width_with_subscript(text: &str, subscript: &str, face: Face) -> f64 {
    width(text, face) + SUBSCRIPT_SIZE * width(subscript, Face::Regular)
}

/// Draws `text` with its base line from (x, y), pixels, y down.
pub(crate) fn outline(text: &str, face: Face, size: f64, x: f64, y: f64, pen: &mut dyn OutlineBuilder) {
    let Some(ttf) = ttf(face) else { return };
    let scale = size / f64::from(ttf.units_per_em());
    let mut left = x;
    for letter in letters(text) {
        if let Some(id) = glyph(ttf, letter) {
            ttf.outline_glyph(
                id,
                &mut Placed {
                    left,
                    base: y,
                    scale,
                    pen,
                },
            );
        }
        left += size * advance(ttf, letter);
    }
}

/// Breaks `text` into lines of at most `width_em` times the text size, and at most `most` lines; a text that
/// is longer ends in "…". A word longer than a line is left whole.
pub(crate) fn wrap(text: &str, face: Face, width_em: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split([' ', '\n', '\t']).filter(|word| !word.is_empty()) {
        let fits = |line: &String| width(line, face) + width(" ", face) + width(word, face) <= width_em;
        let full = lines.len() == most;
        match lines.last_mut() {
            Some(line) if fits(line) => {
                line.push(' ');
                line.push_str(word);
            }
            Some(line) if full => {
                line.push('…');
                break;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Glyph outlines in font units, moved to their place.
struct Placed<'a> {
    left: f64,
    base: f64,
    scale: f64,
    pen: &'a mut dyn OutlineBuilder,
}

impl Placed<'_> {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        let x = self.left + self.scale * f64::from(x);
        let y = self.base - self.scale * f64::from(y);
        (x as f32, y as f32)
    }
}

impl OutlineBuilder for Placed<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.pen.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.pen.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (x1, y1) = self.at(x1, y1);
        let (x, y) = self.at(x, y);
        self.pen.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (x1, y1) = self.at(x1, y1);
        let (x2, y2) = self.at(x2, y2);
        let (x, y) = self.at(x, y);
        self.pen.curve_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.pen.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_letters_of_captions_are_in_every_face() {
        for face in [Face::Regular, Face::Bold, Face::Italic] {
            let ttf = ttf(face).unwrap();
            for letter in "azAZ09 .,;:()[]/%–—·×²°θσäß…\u{2009}\u{a0}".chars() {
                assert!(ttf.glyph_index(letter).is_some(), "{letter:?} is not in {face:?}");
            }
        }
    }

    #[test]
    fn wrapping_keeps_every_word_and_the_width() {
        let text = "a caption of several words that does not fit into one line";
        let lines = wrap(text, Face::Regular, 10.0, 99);
        assert!(lines.len() > 1 && lines.iter().all(|l| width(l, Face::Regular) <= 10.0));
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn a_text_without_end_is_cut_with_an_ellipsis() {
        let lines = wrap(&"word ".repeat(1000), Face::Regular, 20.0, 3);
        assert_eq!(lines.len(), 3);
        assert!(lines[2].ends_with('…'));
    }
}
