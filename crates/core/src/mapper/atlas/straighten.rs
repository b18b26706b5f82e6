//! Keyframes made straight again when it has become clearer how far the scanner moves while its beam goes round.

use std::sync::Arc;

use super::Atlas;
use super::shown::Shown;
use crate::extract::Extraction;
use crate::keyframe::Keyframe;
use crate::mapper::Settings;

impl Atlas {
    /// Makes all keyframes straight again with `share` of the motion from scan to scan in a turn of the beam; the map around
    /// is made anew.
    pub fn straighten(&mut self, share: f64, settings: &Settings) {
        if self.keyframes.is_empty() {
            return;
        }
        for keyframe in &mut self.keyframes {
            straighten(keyframe, share, settings);
        }
        self.renew_local(settings);
    }
}

fn straighten(keyframe: &mut Keyframe, share: f64, settings: &Settings) {
    let turn_motion = keyframe.step.scaled(share);
    if turn_motion == keyframe.scan.turn_motion() {
        return;
    }
    let scan = keyframe.scan.straightened(turn_motion);
    let shown = Shown::by(&scan, keyframe.extraction.noise_m, settings);
    keyframe.is_moving = still_moving(keyframe, &shown.extraction);
    keyframe.extraction = shown.extraction;
    keyframe.points = shown.points;
    keyframe.middle = shown.middle;
    keyframe.disordered_runs = shown.disordered_runs;
    keyframe.scan = Arc::new(scan);
}

/// Which polylines are moving: those whose middle beam was on one that was.
fn still_moving(keyframe: &Keyframe, extraction: &Extraction) -> Vec<bool> {
    let beams = keyframe.scan.geometry().beams();
    let after = |first: usize, beam: usize| (beam + beams - first) % beams;
    let was_moving = |beam: usize| {
        keyframe
            .extraction
            .polylines
            .iter()
            .zip(&keyframe.is_moving)
            .any(|(p, moving)| *moving && after(p.first_beam, beam) <= after(p.first_beam, p.last_beam))
    };
    extraction
        .polylines
        .iter()
        .map(|p| was_moving((p.first_beam + after(p.first_beam, p.last_beam) / 2) % beams))
        .collect()
}
