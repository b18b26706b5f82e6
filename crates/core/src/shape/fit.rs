//! How two groups of arcs lie on each other where one or both may have been cut by occlusion.
//!
//! A cut shortens the side before the first turn or behind the last one, or takes turns away altogether. So
//! an open end is trimmed until the turns agree, and what is trimmed is priced by its length.

use super::tangent::{arc_dissimilarity, turning_variance_rad2};
use super::{Part, Shape};

/// Price of a metre that stays unmatched at an end, m·rad² a metre: as much as a metre matched with a direction
/// error of 8° rms. That lies well above what noise makes of a true match (2° to 3° rms) and below a
/// different shape (a corner on a wall: 45° rms).
pub(super) const UNMATCHED_RAD2: f64 = 0.02;

/// More surplus turns than this are not tried one by one at both ends, only all at one end.
const SURPLUS_TRIED: usize = 4;

/// A stretch of a shape with the vertices in it that turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span<'a> {
    pub shape: &'a Shape,
    pub part: Part,
    first_turn: usize,
    turns: usize,
}

impl<'a> Span<'a> {
    /// The arcs `from..to` of a shape.
    pub fn of_arcs(shape: &'a Shape, from: usize, to: usize) -> Self {
        let (first, last) = (&shape.arcs()[from], &shape.arcs()[to - 1]);
        Self {
            shape,
            part: Part::new(first.part.from_m, last.part.to_m),
            first_turn: first.turns.start,
            turns: last.turns.end - first.turns.start,
        }
    }

    /// Arc length of turn `k` of this span.
    fn turn_m(&self, k: usize) -> f64 {
        self.shape.tangent().vertex_m(self.first_turn + k)
    }

    /// Length from the span's start, or from the last of `skipped` turns, to the first turn that counts.
    fn lead_m(&self, skipped: usize) -> f64 {
        let from_m = match skipped.checked_sub(1) {
            Some(k) => self.turn_m(k),
            None => self.part.from_m,
        };
        self.turn_m(skipped) - from_m
    }

    /// The same at the other end.
    fn tail_m(&self, skipped: usize) -> f64 {
        let to_m = match skipped.checked_sub(1) {
            Some(k) => self.turn_m(self.turns - 1 - k),
            None => self.part.to_m,
        };
        to_m - self.turn_m(self.turns - 1 - skipped)
    }
}

/// The best way found to lay one span on another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// m·rad².
    pub cost: f64,
    pub c: Part,
    pub d: Part,
}

/// Which ends of a pair may be trimmed: those where nothing of either polyline is matched beyond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Open {
    pub start: bool,
    pub end: bool,
}

/// Lays span `c` on span `d`. What costs more than `budget` need not be told exactly, only to cost more.
pub(super) fn fit(c: Span<'_>, d: Span<'_>, open: Open, budget: f64) -> Fit {
    if !open.start && !open.end {
        return trimmed(c, c.part, d, d.part, budget);
    }
    match (c.turns, d.turns) {
        (0, 0) => straight_on_straight(c, c.part, d, d.part),
        (0, _) => {
            let on_side = straight_on_straight(c, c.part, d, longest_side(d, open));
            cheaper(on_side, straight_on_straight(c, c.part, d, d.part))
        }
        (_, 0) => {
            let on_side = straight_on_straight(c, longest_side(c, open), d, d.part);
            cheaper(on_side, straight_on_straight(c, c.part, d, d.part))
        }
        _ => turn_on_turn(c, d, open, budget),
    }
}

fn cheaper(a: Fit, b: Fit) -> Fit {
    if a.cost <= b.cost { a } else { b }
}

/// S_a of two parts, and the price of what of either span lies outside.
fn trimmed(c: Span<'_>, c_part: Part, d: Span<'_>, d_part: Part, budget: f64) -> Fit {
    let price = unmatched(c, c_part) + unmatched(d, d_part);
    let matched = if price > budget {
        0.0
    } else {
        arc_dissimilarity(c.shape.tangent(), c_part, d.shape.tangent(), d_part)
    };
    Fit {
        cost: matched + price,
        c: c_part,
        d: d_part,
    }
}

fn unmatched(span: Span<'_>, part: Part) -> f64 {
    UNMATCHED_RAD2 * (span.part.length_m() - part.length_m()).max(0.0)
}

/// Two walls: either may be a part of the other, and nothing says which. Both are reported whole; the
/// longer one pays for what the other cannot cover.
fn straight_on_straight(c: Span<'_>, c_part: Part, d: Span<'_>, d_part: Part) -> Fit {
    let (lc_m, ld_m) = (c_part.length_m(), d_part.length_m());
    let variance = turning_variance_rad2(c.shape.tangent(), c_part, d.shape.tangent(), d_part);
    Fit {
        cost: lc_m.min(ld_m) * variance
            + UNMATCHED_RAD2 * (lc_m - ld_m).abs()
            + unmatched(c, c_part)
            + unmatched(d, d_part),
        c: c_part,
        d: d_part,
    }
}

/// The part of a bent span that a wall lies on: the other sides of its corners may be out of sight. The longest side
/// leaves least unmatched; only sides next to an open end can be had alone.
fn longest_side(bent: Span<'_>, open: Open) -> Part {
    let side = |k: usize| {
        let from_m = if k == 0 {
            bent.part.from_m
        } else {
            bent.turn_m(k - 1)
        };
        let to_m = if k == bent.turns {
            bent.part.to_m
        } else {
            bent.turn_m(k)
        };
        Part::new(from_m, to_m)
    };
    let tried = match open {
        Open {
            start: true,
            end: true,
        } => 0..bent.turns + 1,
        Open { start: true, .. } => bent.turns..bent.turns + 1,
        Open { .. } => 0..1,
    };
    let longer = |a: Part, b: Part| if b.length_m() > a.length_m() { b } else { a };
    tried.map(side).reduce(longer).unwrap_or(bent.part)
}

/// Two bent spans: surplus turns of one of them lie beyond the ends of the other, or are details inside.
fn turn_on_turn(c: Span<'_>, d: Span<'_>, open: Open, budget: f64) -> Fit {
    let surplus = c.turns.abs_diff(d.turns);
    let mut best = with_skips(c, d, open, (0, 0), budget);
    if surplus == 0 {
        return best;
    }
    let mut try_start = |skipped: usize| {
        let skips = (skipped, surplus - skipped);
        best = cheaper(best, with_skips(c, d, open, skips, budget.min(best.cost)));
    };
    match open {
        Open {
            start: true,
            end: true,
        } if surplus <= SURPLUS_TRIED => (0..=surplus).for_each(try_start),
        Open {
            start: true,
            end: true,
        } => [0, surplus].into_iter().for_each(try_start),
        Open { start: true, .. } => try_start(surplus),
        Open { .. } => try_start(0),
    }
    best
}

/// Trims the open ends so that both spans have the same length before their first counted turn and behind
/// their last; the span with more turns leaves out some at its start and some at its end.
fn with_skips(c: Span<'_>, d: Span<'_>, open: Open, skips: (usize, usize), budget: f64) -> Fit {
    let (at_start, at_end) = skips;
    let c_has_more = c.turns >= d.turns;
    let skip = |has_more: bool, n: usize| if has_more { n } else { 0 };
    let (c_start, c_end) = (skip(c_has_more, at_start), skip(c_has_more, at_end));
    let (d_start, d_end) = (skip(!c_has_more, at_start), skip(!c_has_more, at_end));
    let (mut c_part, mut d_part) = (c.part, d.part);
    if open.start {
        let lead_m = c.lead_m(c_start).min(d.lead_m(d_start));
        c_part.from_m = c.turn_m(c_start) - lead_m;
        d_part.from_m = d.turn_m(d_start) - lead_m;
    }
    if open.end {
        let tail_m = c.tail_m(c_end).min(d.tail_m(d_end));
        c_part.to_m = c.turn_m(c.turns - 1 - c_end) + tail_m;
        d_part.to_m = d.turn_m(d.turns - 1 - d_end) + tail_m;
    }
    trimmed(c, c_part, d, d_part, budget)
}
