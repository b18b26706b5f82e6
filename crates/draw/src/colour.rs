/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red, 0..=255.
    pub red: u8,
    /// Green, 0..=255.
    pub green: u8,
    /// Blue, 0..=255.
    pub blue: u8,
}

impl Colour {
    /// The colour `0xRRGGBB`.
    #[must_use]
    pub const fn rgb(hex: u32) -> Self {
        let [_, red, green, blue] = hex.to_be_bytes();
        Self { red, green, blue }
    }

    /// The colour mixed with white: `strength` 1 leaves it, 0 gives white.
    #[must_use]
    pub fn tint(self, strength: f64) -> Self {
        let strength = strength.clamp(0.0, 1.0);
        let mix = |c: u8| (255.0 + (f64::from(c) - 255.0) * strength).round() as u8;
        Self {
            red: mix(self.red),
            green: mix(self.green),
            blue: mix(self.blue),
        }
    }

    pub(crate) fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }
}

/// The few colours in use. The hues are those of Okabe and Ito (2008), told apart by colour-blind readers;
/// wherever two hues mean two things, a shape or dash differs as well, for prints without colour.
pub mod palette {
    use super::Colour;

    /// The paper.
    pub const WHITE: Colour = Colour::rgb(0xff_ffff);
    /// Walls and text.
    pub const INK: Colour = Colour::rgb(0x1b_2027);
    /// Text and lines of second rank.
    pub const GREY: Colour = Colour::rgb(0x6b_7480);
    /// Frames of panels.
    pub const PALE: Colour = Colour::rgb(0xc9_ced4);
    /// The side of a wall that is not free.
    pub const SHADE: Colour = Colour::rgb(0xe1_e5e9);
    /// Grid lines.
    pub const GRID: Colour = Colour::rgb(0xe6_eaee);
    /// Trajectory; second scan.
    pub const BLUE: Colour = Colour::rgb(0x00_72b2);
    /// First scan.
    pub const GREEN: Colour = Colour::rgb(0x00_9e73);
    /// Eraser boxes.
    pub const ORANGE: Colour = Colour::rgb(0xe6_9f00);
    /// What the reader is to look at.
    pub const VERMILION: Colour = Colour::rgb(0xd5_5e00);
}
