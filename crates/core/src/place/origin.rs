//! Where a pose came from: which of the guesses it was aligned from, or which way a scan goes that no guess explains.

/// See the module. In the order in which they are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Origin {
    /// The map begins with this scan: there was nothing to be placed in.
    First,
    /// The scanner moves on as before, or as odometry says.
    Predicted,
    /// It has stopped.
    Standing,
    /// It moves on as before, or nearly: a wider guess.
    Wide,
    /// It makes a step that it has made before.
    AsBefore,
    /// The polylines of the scan were matched by shape with those of the map (paper section 3.3).
    Shape,
    /// All poses in a window were searched.
    Search,
    /// It is in a map that was left when the scanner was lost.
    Back,
    /// It fits nowhere, and begins a map of its own.
    Apart,
}

impl Origin {
    /// All of them, in order.
    pub const ALL: [Self; 9] = [
        Self::First,
        Self::Predicted,
        Self::Standing,
        Self::Wide,
        Self::AsBefore,
        Self::Shape,
        Self::Search,
        Self::Back,
        Self::Apart,
    ];

    /// Its name in files: `first`, `predicted`, `standing`, `wide`, `as_before`, `shape`, `search`, `back`, `apart`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Predicted => "predicted",
            Self::Standing => "standing",
            Self::Wide => "wide",
            Self::AsBefore => "as_before",
            Self::Shape => "shape",
            Self::Search => "search",
            Self::Back => "back",
            Self::Apart => "apart",
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|origin| origin.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_origin_is_found_by_its_name() {
        for origin in Origin::ALL {
            assert_eq!(Origin::named(origin.name()), Some(origin));
        }
        assert_eq!(Origin::named("luck"), None);
    }
}
