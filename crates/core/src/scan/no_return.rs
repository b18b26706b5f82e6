//! The range that a log writes for "no return", found from its ranges.
//!
//! In go the raw ranges of one scan after the other, out comes the range from which on they are no returns, as soon as
//! there is one. Ranges are counted in cells of 1 cm. Within 0.2 m of the longest range seen, the lowest cell is the
//! code that
//!
//! - holds 30 readings or more,
//! - holds four times as many as the 0.1 m below it, and
//! - was read on 8 different beams with a neighbouring beam 0.3 m or more nearer.
//!
//! A wall does not do that: ranges to a wall run up to its far end, where the 0.1 m below hold as many readings as the
//! last centimetre; noise spreads what is far over several cells. What a standing scanner sees of a far wall comes on
//! the same few beams. A quiet round room with the scanner in its middle has no jumps. A range that is longer by more
//! than 0.2 m takes the code back, since nothing is farther than no return.
//!
//! Real codes are not always one value: SICK scanners have nine (8.183 to 8.191 m), and logs whose ranges were
//! worked over spread theirs (51.05 to 51.16 m); hence the 0.2 m. In the seven real logs at hand that hold codes below
//! 80 m, these are read 620 to 11139 times and 0 to 8 readings lie in the 0.1 m below (142 under 6724 in the one
//! whose scanner reaches 8 m); in the five that hold none, nothing is taken for one.

use std::collections::BTreeMap;

use super::ScanGeometry;

/// Cells to a metre.
const CELLS_PER_M: f64 = 100.0;
/// Codes lie within so many cells of the longest range.
const BAND_CELLS: usize = 20;
/// Cells below a code that are nearly empty.
const BELOW_CELLS: usize = 10;
/// Readings that make a code; a scanner that turns on the spot reads a far wall through a narrow gap 20 times or so.
const LEAST_READINGS: u32 = 30;
/// How many times as many readings as below.
const LEAST_RATIO: u32 = 4;
/// Different beams on which a code stands beside something nearer.
const LEAST_BEAMS: usize = 8;
/// How much nearer, metres.
const JUMP_M: f64 = 0.3;

/// Follows the longest ranges of a log and tells which of them are no returns.
#[derive(Clone, Debug, Default)]
pub struct NoReturnCode {
    /// Readings by cell; as long as the longest range asks for, at most 8000 cells.
    readings: Vec<u32>,
    /// For cells that were read beside something nearer: on which beams, up to `LEAST_BEAMS` of them.
    beams: BTreeMap<usize, Vec<usize>>,
    code: Option<usize>,
}

impl NoReturnCode {
    /// Counts the raw ranges of the next scan, metres, in the order of the beams.
    pub fn observe(&mut self, ranges_m: &[f64]) {
        for (beam, &range_m) in ranges_m.iter().enumerate() {
            let Some(cell) = cell(range_m) else { continue };
            if cell >= self.readings.len() {
                self.readings.resize(cell + 1, 0);
            }
            self.readings[cell] = self.readings[cell].saturating_add(1);
            let before = beam.checked_sub(1).and_then(|b| ranges_m.get(b));
            let after = ranges_m.get(beam + 1);
            let is_nearer = |other: &&f64| is_possible(**other) && **other < range_m - JUMP_M;
            if before.filter(is_nearer).or(after.filter(is_nearer)).is_some() {
                let beams = self.beams.entry(cell).or_default();
                if beams.len() < LEAST_BEAMS && !beams.contains(&beam) {
                    beams.push(beam);
                }
            }
        }
        let lowest = self.readings.len().saturating_sub(BAND_CELLS + 1);
        self.code = (lowest..self.readings.len()).find(|&cell| self.stands_out(cell));
    }

    /// Ranges at or above this are no returns, metres; `None` while no code is known.
    #[must_use]
    pub fn from_m(&self) -> Option<f64> {
        self.code.map(|cell| (cell as f64 - 0.5) / CELLS_PER_M)
    }

    fn stands_out(&self, cell: usize) -> bool {
        let here = self.readings[cell];
        let below: u32 = self.readings[cell.saturating_sub(BELOW_CELLS)..cell]
            .iter()
            .fold(0, |sum, &n| sum.saturating_add(n));
        here >= LEAST_READINGS
            && here / LEAST_RATIO >= below
            && self.beams.get(&cell).is_some_and(|b| b.len() >= LEAST_BEAMS)
    }
}

/// The cell of a range; `None` for what is no return anyway.
fn cell(range_m: f64) -> Option<usize> {
    is_possible(range_m).then(|| (range_m * CELLS_PER_M).round() as usize)
}

fn is_possible(range_m: f64) -> bool {
    (ScanGeometry::SHORTEST_RANGE_M..ScanGeometry::LONGEST_RANGE_M).contains(&range_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Observes `scans` scans of 181 beams; `range_m(scan, bearing_rad)`.
    fn after(scans: usize, range_m: impl Fn(usize, f64) -> f64) -> NoReturnCode {
        let mut code = NoReturnCode::default();
        for scan in 0..scans {
            let ranges: Vec<f64> = (0..181)
                .map(|beam| range_m(scan, f64::from(beam - 90).to_radians()))
                .collect();
            code.observe(&ranges);
        }
        code
    }

    /// A room 6 m deep and 4 m wide, the scanner at its back wall, `x_m` ahead of it; whole centimetres.
    fn room_m(x_m: f64, bearing_rad: f64) -> f64 {
        let ahead_m = (6.0 - x_m) / bearing_rad.cos().max(1e-9);
        let aside_m = 2.0 / bearing_rad.sin().abs().max(1e-9);
        (ahead_m.min(aside_m) * 100.0).round() / 100.0
    }

    /// A glass door that gives no return lies ahead, seen under other bearings as the scanner turns.
    fn with_door(scan: usize, bearing_rad: f64, code_m: f64) -> f64 {
        let turned_rad = (scan % 20) as f64 * 0.05 - 0.5;
        if (bearing_rad - turned_rad).abs() < 0.1 {
            code_m
        } else {
            room_m(0.5, bearing_rad)
        }
    }

    #[test]
    fn what_recurs_at_the_top_is_a_code() {
        let code = after(20, |scan, b| with_door(scan, b, 29.9));
        assert!((code.from_m().unwrap() - 29.895).abs() < 1e-9);
    }

    #[test]
    fn several_codes_beside_each_other_are_all_found() {
        // As SICK scanners write them: nine values, 1 mm apart.
        let code = after(40, |scan, b| with_door(scan, b, [8.183, 8.187, 8.191][scan % 3]));
        let from_m = code.from_m().unwrap();
        assert!(from_m <= 8.183 && from_m > 8.1, "{from_m}");
    }

    #[test]
    fn walls_are_no_code() {
        // The far corners are the longest range of every scan.
        assert_eq!(after(300, |_, b| room_m(0.0, b)).from_m(), None);
        assert_eq!(after(300, |scan, b| room_m(0.01 * scan as f64, b)).from_m(), None);
    }

    #[test]
    fn a_round_room_is_no_code() {
        assert_eq!(after(300, |_, _| 5.0).from_m(), None);
    }

    #[test]
    fn a_far_wall_behind_a_gap_is_no_code_for_a_scanner_that_stands() {
        let code = after(300, |_, b| if b.abs() < 0.04 { 20.0 } else { room_m(0.0, b) });
        assert_eq!(code.from_m(), None);
    }

    #[test]
    fn a_longer_range_takes_the_code_back() {
        let mut code = after(20, |scan, b| with_door(scan, b, 8.0));
        assert!(code.from_m().is_some());
        code.observe(&[3.0, 9.0, 3.0]);
        assert_eq!(code.from_m(), None);
    }

    #[test]
    fn any_number_is_taken() {
        let mut code = NoReturnCode::default();
        code.observe(&[]);
        code.observe(&[
            f64::NAN,
            f64::INFINITY,
            -1.0,
            0.0,
            1e300,
            81.91,
            f64::NEG_INFINITY,
        ]);
        assert_eq!(code.from_m(), None);
    }
}
