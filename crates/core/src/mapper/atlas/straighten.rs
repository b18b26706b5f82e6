//! Keyframes made straight again when it has become clearer how far the scanner moves while its beam goes round.

use std::sync::Arc;

use super::Atlas;
use crate::align::side_points;
use crate::extract::{ExtractSettings, Extraction, extract};
use crate::keyframe::{Keyframe, middle_of};
use crate::mapper::Settings;
use crate::merge::eraser::disordered_runs;

impl Atlas {
    /// Makes all keyframes straight again with `share` of the motion from scan to scan in a turn of the beam; the map around
    /// is made anew.
    pub fn straighten(&mut self, share: f64, settings: &Settings) {
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
    let extraction = extract(
        &scan,
        &ExtractSettings {
            noise_m: Some(keyframe.extraction.noise_m),
            ..settings.extract
        },
    );
    keyframe.is_moving = still_moving(keyframe, &extraction);
    keyframe.points = side_points(&scan, &extraction.polylines, extraction.noise_m).into();
    keyframe.middle = middle_of(&keyframe.points);
    keyframe.disordered_runs = disordered_runs(&scan, extraction.noise_m, &settings.eraser).into();
    keyframe.extraction = Arc::new(extraction);
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
