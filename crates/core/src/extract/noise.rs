//! Scan → the scanner's range noise.
//!
//! On a straight wall the inverse range u = 1/r obeys u₋ + u₊ = 2 cos(Δφ) u, so of three neighbouring beams the
//! middle one has the residual e = r − 2 cos(Δφ) / (u₋ + u₊), whose variance is about 1.5 σ². The median of |e|
//! over the scan is blind to corners and edges as long as they are less than half of the beams:
//! σ = median |e| / (0.6745 · √1.5).

use crate::scan::Scan;

/// No scanner is trusted to be better than this, metres: millimetre-exact ranges (simulators) would otherwise make
/// every rounding error a feature.
pub const NOISE_FLOOR_M: f64 = 0.003;

/// Noise assumed where a scan cannot tell, metres: an ordinary indoor scanner.
pub const NOISE_DEFAULT_M: f64 = 0.010;

/// Distances within a triple, in beams. Low-cost scanners repeat and smooth ranges from beam to beam, so that neighbours agree better
/// than the wall does; the larger of the two estimates stands.
const LAGS: [usize; 2] = [1, 3];

/// Fewest triples of neighbouring returns that an estimate rests on.
const FEWEST_TRIPLES: usize = 20;

/// Standard deviation of the ranges in metres, estimated from the scan itself, at least [`NOISE_FLOOR_M`]; `None`
/// for a scan with too few neighbouring returns.
///
/// Meant to be smoothed over scans by the caller (a running median, say): a single scan in clutter reads too high.
#[must_use]
pub fn estimate_noise_m(scan: &Scan) -> Option<f64> {
    LAGS.iter()
        .filter_map(|&lag| middle_noise_m(scan, lag))
        .max_by(f64::total_cmp)
        .map(|noise_m| noise_m.max(NOISE_FLOOR_M))
}

/// The estimate from triples of returns `lag` beams apart.
fn middle_noise_m(scan: &Scan, lag: usize) -> Option<f64> {
    let bend = 2.0 * (lag as f64 * scan.geometry().step_rad()).cos();
    let mut residuals_m: Vec<f64> = scan
        .ranges_m()
        .windows(2 * lag + 1)
        .map(|w| (w[lag] - bend / (1.0 / w[0] + 1.0 / w[2 * lag])).abs())
        .filter(|e| e.is_finite())
        .collect();
    if residuals_m.len() < FEWEST_TRIPLES {
        return None;
    }
    let middle = residuals_m.len() / 2;
    let (_, median_m, _) = residuals_m.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median_m / (0.6745 * 1.5_f64.sqrt()))
}

/// Noise of a scanner over many scans.
///
/// Single scans of cluttered places give estimates up to ten times too high, and the noise of a scanner does not
/// change: the lower quartile of the estimates so far, followed by steps that shrink to 2 % (Robbins and Monro 1951).
#[derive(Clone, Copy, Debug, Default)]
pub struct RunningNoise {
    sigma_m: Option<f64>,
    scans: u32,
}

impl RunningNoise {
    /// Takes the next scan into account.
    pub fn observe(&mut self, scan: &Scan) {
        const QUANTILE: f64 = 0.25;
        let Some(now_m) = estimate_noise_m(scan) else {
            return;
        };
        self.scans += 1;
        let gain = (1.0 / f64::from(self.scans)).max(0.02);
        self.sigma_m = Some(match self.sigma_m {
            None => now_m,
            Some(before_m) if now_m > before_m => before_m * (gain * QUANTILE).exp(),
            Some(before_m) => before_m * (-gain * (1.0 - QUANTILE)).exp(),
        });
    }

    /// Standard deviation of a range, metres; `None` before the first scan that tells.
    #[must_use]
    pub fn sigma_m(&self) -> Option<f64> {
        self.sigma_m
    }
}
