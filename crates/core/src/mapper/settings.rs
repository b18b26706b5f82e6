use crate::align::AlignSettings;
use crate::eraser::EraserSettings;
use crate::extract::ExtractSettings;
use crate::merge::MergeSettings;
use crate::moving::MovingSettings;
use crate::placement::PlaceSettings;
use crate::recognise::RecogniseSettings;

/// All settings of the mapper. The defaults serve every scanner.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// Scan → polylines.
    pub extract: ExtractSettings,
    /// Alignment.
    pub align: AlignSettings,
    /// Finding the pose.
    pub place: PlaceSettings,
    /// Finding what has no stable shape.
    pub eraser: EraserSettings,
    /// Finding moving objects.
    pub moving: MovingSettings,
    /// Merging.
    pub merge: MergeSettings,
    /// Closing loops.
    pub recognise: RecogniseSettings,
}
