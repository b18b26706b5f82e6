use crate::adjust::AdjustSettings;
use crate::align::AlignSettings;
use crate::extract::ExtractSettings;
use crate::loops::RecogniseSettings;
use crate::merge::MergeSettings;
use crate::merge::eraser::EraserSettings;
use crate::merge::moving::MovingSettings;
use crate::place::PlaceSettings;

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
    /// Adjusting poses and walls together.
    pub adjust: AdjustSettings,
}
