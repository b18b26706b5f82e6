//! For show: how a scan's shapes compare with those of the scan before, at the poses that they have.
//!
//! The mapper matches by shape only where its prediction fails; the page can show the matching of any scan (the paper's
//! Fig. 3), made when it is asked for. And the convex arcs that the matching compares.

use polymapper_core::geometry::{Polyline, Pose};
use polymapper_core::matching::correspondences_at;
use polymapper_core::shape::{Bend, convex_arcs};
use serde::Serialize;

use crate::record::{Chain, Detail, PairRecord, PoseRecord, polyline, rounded};

/// What the page shows beside a scan.
#[derive(Debug, Serialize)]
pub struct Comparison {
    /// Number of the scan.
    pub n: usize,
    /// For each of its polylines, the maximal convex arcs.
    pub arcs: Vec<Vec<ArcRecord>>,
    /// Polylines of the earlier scan that it is compared with, in that scan's laser frame.
    pub reference: Vec<Chain>,
    /// Which belong together.
    pub pairs: Vec<PairRecord>,
}

/// A maximal convex arc: how it bends (−1 right, 0 straight, 1 left), and from where to where along the polyline,
/// millimetres.
pub type ArcRecord = (i8, i64, i64);

/// Compares `scan` with `before`, given where the scan lies in the frame of the earlier one.
pub fn compare(scan: &Detail, before: Option<(&Detail, PoseRecord)>) -> Comparison {
    let ours = polylines(&scan.polylines);
    let pairs = before.map_or_else(Vec::new, |(before, [x, y, theta_rad])| {
        let theirs = polylines(&before.polylines);
        correspondences_at(&ours, &theirs, Pose::new(x, y, theta_rad))
            .into_iter()
            .map(|c| PairRecord {
                scan: c.scan,
                reference: c.reference,
                cost_rad2: rounded(c.shape_cost_rad2, 1e4),
            })
            .collect()
    });
    Comparison {
        n: scan.n,
        arcs: ours.iter().map(arcs).collect(),
        reference: before.map_or_else(Vec::new, |(b, _)| b.polylines.clone()),
        pairs,
    }
}

fn polylines(chains: &[Chain]) -> Vec<Polyline> {
    chains.iter().filter_map(|c| polyline(c)).collect()
}

fn arcs(polyline: &Polyline) -> Vec<ArcRecord> {
    let millimetres = |m: f64| (m * 1e3).round() as i64;
    convex_arcs(polyline)
        .iter()
        .map(|arc| {
            let bend = match arc.bend {
                Bend::Straight => 0,
                Bend::Left => 1,
                Bend::Right => -1,
            };
            (bend, millimetres(arc.part.from_m), millimetres(arc.part.to_m))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_compared_with_itself_matches_every_polyline() {
        let scan = Detail {
            n: 1,
            polylines: vec![
                vec![-2000, -3000, 6000, 0, 0, 4000],
                vec![4000, 2500, -3000, 0, 0, -500],
            ],
            ..Detail::default()
        };
        let found = compare(&scan, Some((&scan, [0.0, 0.0, 0.0])));
        let pairs: Vec<_> = found
            .pairs
            .iter()
            .map(|p| (&p.scan[..], &p.reference[..]))
            .collect();
        assert_eq!(pairs, [(&[0][..], &[0][..]), (&[1][..], &[1][..])]);
        assert_eq!(found.arcs[0], [(1, 0, 10_000)]);
    }
}
