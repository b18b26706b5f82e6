//! Two scans matched by shape: the verdict on the result, and its picture (Fig. 3 of the paper).

use polymapper_core::extract::{ExtractSettings, extract};
use polymapper_core::geometry::{Point, Polyline, Pose, wrap_rad};
use polymapper_core::matching::{Hypothesis, Matching, match_polylines, unmoved};
use polymapper_core::scan::Scan;
use polymapper_draw::figures::{Apart, correspondence};
use polymapper_draw::{Extent, Layer, Panel, Scene, Stroke, palette};

/// Less of the scan's wall on walls of the other, less what was looked through, is chance: the median of 100 pairs of scans from all over
/// the Killian log is 0.36.
const LEAST_EXPLAINED: f64 = 0.4;
/// Two poses whose scores differ by less explain the walls alike. On the scale of the score: a tenth of the walls.
///
/// Of 515 pairs 1 m or 2 m (or as many times 30°) apart in the Killian, Intel and ACES logs 335 are sure, and all of those within 0.25 m and 3° of the
/// map. Of 95 pairs more than 5 m apart in the Killian log 3 are sure, and wrong: pieces of corridor that look alike.
const CLEAR_LEAD: f64 = 0.1;

/// What a matching is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// One pose leads clearly, and the walls fix it in every direction.
    Sure,
    /// Another pose explains the walls nearly as well, or the walls leave a direction open.
    Ambiguous,
    /// No pose explains a good part of the walls.
    None,
}

impl Verdict {
    pub fn word(self) -> &'static str {
        match self {
            Self::Sure => "sure",
            Self::Ambiguous => "ambiguous",
            Self::None => "none",
        }
    }

    fn of(hypotheses: &[Hypothesis]) -> Self {
        let Some(best) = hypotheses.first() else {
            return Self::None;
        };
        // Where more wall was looked through than not, the rest that fits is no argument.
        if best.explained_ratio - best.contradicted_ratio < LEAST_EXPLAINED {
            return Self::None;
        }
        let leads = hypotheses
            .get(1)
            .is_none_or(|next| best.score - next.score >= CLEAR_LEAD);
        if leads && best.unobservable.is_none() {
            Self::Sure
        } else {
            Self::Ambiguous
        }
    }
}

/// Two scans and how they match.
pub struct ShapeMatch {
    first: Vec<Polyline>,
    second: Vec<Polyline>,
    /// The second scan in the frame of the first.
    pub matching: Matching,
    pub verdict: Verdict,
}

impl ShapeMatch {
    /// Matches `second` to `first`, by their shape alone.
    pub fn of(first: &Scan, second: &Scan) -> Self {
        let (first, second) = (polylines(first), polylines(second));
        let matching = match_polylines(&second, &first, &unmoved());
        let verdict = Verdict::of(&matching.hypotheses);
        Self {
            first,
            second,
            matching,
            verdict,
        }
    }

    /// The best pose of the second scan in the frame of the first.
    pub fn first_from_second(&self) -> Option<Pose> {
        Some(self.matching.hypotheses.first()?.reference_from_scan)
    }

    /// Fig. 3: both scans as the scanner saw them, and the second moved to where the match puts it.
    ///
    /// `names` opens the caption: "a.log, scans 3 (green) and 9 (blue)".
    pub fn scene(&self, names: &str) -> Scene {
        let pairs: Vec<(usize, usize)> = self
            .matching
            .correspondences
            .iter()
            .flat_map(|c| {
                let scan = &c.scan;
                c.reference
                    .iter()
                    .flat_map(move |&r| scan.iter().map(move |&s| (r, s)))
            })
            .collect();
        let mut scene = correspondence(&self.first, &self.second, &pairs, Apart::AsGiven);
        for panel in &mut scene.panels {
            finish(panel, "as the scanner saw them");
            panel.layers.push(scanners(Pose::IDENTITY));
        }
        if let Some(pose) = self.first_from_second() {
            let moved: Vec<Polyline> = self.second.iter().map(|p| p.transformed(pose)).collect();
            for mut panel in correspondence(&self.first, &moved, &[], Apart::AsGiven).panels {
                finish(&mut panel, "second scan moved by the match");
                panel.layers.push(scanners(pose));
                panel.legend.clear();
                scene.panels.push(panel);
            }
        }
        scene.caption = format!("{names}. {}{}", scene.caption, self.words());
        scene
    }

    fn words(&self) -> String {
        let Some(best) = self.matching.hypotheses.first() else {
            return " No pose was found.".to_owned();
        };
        let along = match best.unobservable {
            Some(_) => ", but leave a direction open",
            None => "",
        };
        format!(
            " The match puts the second scan {} from the first ({}), by shape alone, without odometry; {:.0}\u{a0}% of its walls fit{along}. Rings: scanner.",
            apart(best.reference_from_scan),
            self.verdict.word(),
            100.0 * best.explained_ratio,
        )
    }
}

/// A motion in words: "1.24 m and 35°".
pub fn apart(motion: Pose) -> String {
    format!(
        "{:.2}\u{a0}m and {:.1}°",
        motion.translation().norm(),
        wrap_rad(motion.theta_rad).abs().to_degrees()
    )
}

/// Rings where the scanner stood.
fn scanners(first_from_second: Pose) -> Layer {
    let mut layer = Layer::new("scanner");
    for (at, colour, radius_px) in [
        (Point::default(), palette::GREEN, 11.0),
        (first_from_second.translation(), palette::BLUE, 7.0),
    ] {
        layer.marker(at, radius_px, palette::WHITE, Stroke::new(colour, 3.5));
    }
    layer
}

fn finish(panel: &mut Panel, title: &str) {
    title.clone_into(&mut panel.title);
    panel.extent = Extent::Robust;
}

fn polylines(scan: &Scan) -> Vec<Polyline> {
    extract(scan, &ExtractSettings::default())
        .polylines
        .into_iter()
        .map(|p| p.polyline)
        .collect()
}

#[cfg(test)]
mod tests {
    use polymapper_core::align::Information;

    use super::*;

    fn hypothesis(score: f64, explained_ratio: f64, unobservable: Option<Point>) -> Hypothesis {
        Hypothesis {
            reference_from_scan: Pose::IDENTITY,
            information: Information::default(),
            explained_ratio,
            contradicted_ratio: 0.0,
            score,
            unobservable,
        }
    }

    #[test]
    fn only_a_clear_lead_with_nothing_left_open_is_sure() {
        let good = hypothesis(0.9, 0.9, None);
        let corridor = hypothesis(0.9, 0.9, Some(Point::new(1.0, 0.0)));
        let (twin, far) = (hypothesis(0.85, 0.85, None), hypothesis(0.3, 0.5, None));
        assert_eq!(Verdict::of(&[good.clone(), far]), Verdict::Sure);
        assert_eq!(Verdict::of(std::slice::from_ref(&good)), Verdict::Sure);
        assert_eq!(Verdict::of(&[good, twin]), Verdict::Ambiguous);
        assert_eq!(Verdict::of(&[corridor]), Verdict::Ambiguous);
        assert_eq!(Verdict::of(&[hypothesis(0.1, 0.2, None)]), Verdict::None);
        assert_eq!(Verdict::of(&[]), Verdict::None);
    }
}
