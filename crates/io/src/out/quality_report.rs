//! How well the scans of a log were placed, summed up for `report.json`.

use std::collections::BTreeMap;

use polymapper_core::mapper::LooseStretch;
use serde::Serialize;

use super::decimals::{rounded_3, rounded_4};
use super::{Outcome, TrajectoryRow};

/// See the module. Of the moments at which the scans were placed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct QualityReport {
    /// Scans by where their pose came from.
    pub won: BTreeMap<&'static str, usize>,
    /// Scans whose pose led the best other one by less than is clear.
    pub narrow_lead: usize,
    /// Of the beams that the map says something of, the share that ends on it: the median over the scans, ..
    pub fit_median: Option<f64>,
    /// .. and the largest of the worst twentieth.
    pub fit_worst_twentieth: Option<f64>,
    /// Scans by the number of directions that the walls alone tell.
    pub rank: RankReport,
    /// Scans whose place the walls leave open along a direction.
    pub open: usize,
    /// The largest standard deviation of the place of a scan in the map, metres, ..
    pub largest_sigma_m: Option<f64>,
    /// .. and which scan that is.
    pub largest_sigma_scan: Option<usize>,
    /// Where the finished map hangs together loosely, and may be wrong.
    pub loose: Vec<LooseReport>,
}

/// A stretch of the way that is known poorly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LooseReport {
    /// The last scan before it ..
    pub from_scan: usize,
    /// .. and the first behind it.
    pub to_scan: usize,
    /// Standard deviation of the motion along it or along its worst step, metres.
    pub sigma_m: f64,
    /// Standard deviation of the turn there, radians.
    pub sigma_rad: f64,
}

impl From<LooseStretch> for LooseReport {
    fn from(stretch: LooseStretch) -> Self {
        Self {
            from_scan: stretch.from_scan,
            to_scan: stretch.to_scan,
            sigma_m: rounded_3(stretch.sigma_m),
            sigma_rad: rounded_4(stretch.sigma_rad),
        }
    }
}

/// Scans by rank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RankReport {
    /// The walls tell the place and the heading.
    pub three: usize,
    /// They leave one direction open.
    pub two: usize,
    /// They leave more open.
    pub less: usize,
}

impl QualityReport {
    /// Of all `rows` and the loose stretches of the map; a lead below `clear_lead` is not clear.
    #[must_use]
    pub fn of(rows: &[TrajectoryRow], loose: &[LooseStretch], clear_lead: f64) -> Self {
        let mut report = Self {
            loose: loose.iter().copied().map(LooseReport::from).collect(),
            ..Self::default()
        };
        let mut fits = Vec::new();
        for row in rows {
            let quality = &row.quality;
            if let Some(origin) = quality.won {
                *report.won.entry(origin.name()).or_default() += 1;
            }
            report.narrow_lead += usize::from(quality.lead.is_some_and(|lead| lead < clear_lead));
            report.open += usize::from(quality.open_rad.is_some());
            match quality.rank {
                Some(3) => report.rank.three += 1,
                Some(2) => report.rank.two += 1,
                Some(_) => report.rank.less += 1,
                None => {}
            }
            fits.extend(quality.fit);
            let is_placed = matches!(row.outcome, Outcome::Placed { .. });
            let sigma_m = quality.covariance.filter(|_| is_placed).map(|c| c.widest_m());
            if sigma_m > report.largest_sigma_m {
                (report.largest_sigma_m, report.largest_sigma_scan) = (sigma_m, Some(row.scan));
            }
        }
        fits.sort_by(f64::total_cmp);
        report.fit_median = fits.get(fits.len() / 2).copied().map(rounded_3);
        report.fit_worst_twentieth = fits.get(fits.len() / 20).copied().map(rounded_3);
        report.largest_sigma_m = report.largest_sigma_m.map(rounded_4);
        report
    }
}

#[cfg(test)]
mod tests {
    use polymapper_core::align::Covariance;
    use polymapper_core::geometry::Pose;
    use polymapper_core::mapper::{Origin, Quality};

    use super::*;

    #[test]
    fn scans_are_counted_by_what_is_known_of_them() {
        let row = |scan, is_placed, sigma_m: f64, rank, fit| TrajectoryRow {
            scan,
            stamp_s: None,
            outcome: if is_placed {
                let map_from_scan = Pose::IDENTITY;
                Outcome::Placed { map_from_scan }
            } else {
                let reason = "apart".to_owned();
                Outcome::NotPlaced { reason }
            },
            recognised: None,
            quality: Quality {
                won: Some(Origin::Search),
                lead: Some(fit),
                fit: Some(fit),
                rank: Some(rank),
                open_rad: (rank < 3).then_some(0.0),
                covariance: Some(Covariance {
                    rows: [[sigma_m * sigma_m, 0.0, 0.0], [0.0; 3], [0.0; 3]],
                }),
                ..Quality::default()
            },
        };
        let unknown = TrajectoryRow {
            quality: Quality::default(),
            ..row(4, true, 0.0, 3, 0.0)
        };
        let rows = [
            row(0, true, 0.01, 3, 0.9),
            row(1, true, 0.50, 2, 0.8),
            row(2, false, 2.0, 1, 0.1),
            row(3, true, 0.20, 3, 0.7),
            unknown,
        ];
        let report = QualityReport::of(&rows, &[], 0.15);
        assert_eq!(report.won, BTreeMap::from([("search", 4)]));
        assert_eq!((report.narrow_lead, report.open), (1, 2));
        assert_eq!((report.rank.three, report.rank.two, report.rank.less), (2, 1, 1));
        assert_eq!(report.fit_worst_twentieth, Some(0.1));
        assert_eq!(report.fit_median, Some(0.8));
        assert_eq!(report.largest_sigma_m, Some(0.5), "scan 2 has no place");
        assert_eq!(report.largest_sigma_scan, Some(1));
        assert_eq!(QualityReport::of(&[], &[], 0.15), QualityReport::default());
    }
}
