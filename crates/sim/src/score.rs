//! A map against the true walls.
//!
//! In: the map's polylines, the motion that lays the map over the world, and the truth. Out: [`MapScore`].
//! Map and walls are sampled every 5 cm, and every sample counts with the length it stands for:
//!
//! - precision: share of the map that lies within 5 cm (2 cm) of a wall, seen or not;
//! - recall: share of the wall that some beam hit that lies within 5 cm (2 cm) of the map;
//! - F = 2·precision·recall / (precision + recall);
//! - doubled: share of the map with another side within 0.15 m that runs parallel (10°) and faces the same way,
//!   where the true walls have none (the castors of a chair have);
//! - people: share of the map farther than 0.15 m from every wall and within 0.3 m of where somebody was.

use std::collections::BTreeSet;

use polymapper_core::geometry::{Point, Polyline, Pose, Segment};

use crate::seen::{PIECE_M, SeenWalls};
use crate::sides::SideGrid;
use crate::simulate::SimLog;

/// Farther from every wall than this is no wall. Also how near a doubled wall lies.
const NEAR_M: f64 = 0.15;
/// Nearer than this to where somebody was is that person.
const PERSON_M: f64 = 0.3;
/// Sides whose directions differ by less face the same way, cosine of 10°.
const PARALLEL_COS: f64 = 0.984_807_753_012_208;

/// What a map is measured against.
#[derive(Clone, Debug)]
pub struct MapTruth<'a> {
    /// All walls, world frame.
    pub walls: &'a [Polyline],
    /// What of them was seen.
    pub seen: &'a SeenWalls,
    /// All places where somebody was, world frame.
    pub people: Vec<Point>,
}

impl SimLog {
    /// What a map of this log is measured against.
    #[must_use]
    pub fn map_truth(&self) -> MapTruth<'_> {
        MapTruth {
            walls: self.walls(),
            seen: &self.seen,
            people: self.people.concat(),
        }
    }
}

/// How well map and walls agree at some distance. Shares of length, 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Share of the map that lies on a wall.
    pub precision_ratio: f64,
    /// Share of the seen wall that lies on the map.
    pub recall_ratio: f64,
}

impl Agreement {
    /// Harmonic mean of precision and recall; 0 when both are 0.
    #[must_use]
    pub fn f_score(self) -> f64 {
        let sum = self.precision_ratio + self.recall_ratio;
        if sum > 0.0 {
            2.0 * self.precision_ratio * self.recall_ratio / sum
        } else {
            0.0
        }
    }
}

/// How good a map is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapScore {
    /// Length of the map, metres.
    pub map_length_m: f64,
    /// Length of wall that was seen, metres.
    pub seen_length_m: f64,
    /// Agreement at 5 cm.
    pub within_5cm: Agreement,
    /// Agreement at 2 cm.
    pub within_2cm: Agreement,
    /// Median distance to the nearest wall over the map that lies within 0.15 m of one, metres; `None` when nothing does.
    pub median_error_m: Option<f64>,
    /// Share of the map that has another side beside it, as a wall drawn twice does.
    pub doubled_ratio: f64,
    /// Share of the map that shows people.
    pub people_ratio: f64,
}

/// Measures a map; `world_from_map` is the true pose of the first scan when the map frame is that of the first scan,
/// or comes from [`crate::fit_trajectory`].
#[must_use]
pub fn score_map(map: &[Polyline], world_from_map: Pose, truth: &MapTruth<'_>) -> MapScore {
    let map: Vec<Polyline> = map.iter().map(|p| p.transformed(world_from_map)).collect();
    let (map_grid, walls) = (SideGrid::new(&map), SideGrid::new(truth.walls));
    let (map_owners, wall_owners) = (owners(&map), owners(truth.walls));
    let people = places(&truth.people);

    let mut score = MapScore {
        seen_length_m: truth.seen.length_m(),
        ..MapScore::default()
    };
    let mut errors: Vec<(f64, f64)> = Vec::new();
    for (k, &side) in map_grid.sides().iter().enumerate() {
        for sample in samples(side) {
            let weight_m = sample.length_m;
            score.map_length_m += weight_m;
            let wall = walls.nearest(sample.at, NEAR_M);
            match wall {
                Some((_, off_m)) => errors.push((off_m, weight_m)),
                None if is_near(&people, sample.at) => score.people_ratio += weight_m,
                None => {}
            }
            let truly_double = |(wall, _)| is_doubled(&walls, &wall_owners, wall, sample.at);
            if is_doubled(&map_grid, &map_owners, k, sample.at) && !wall.is_some_and(truly_double) {
                score.doubled_ratio += weight_m;
            }
        }
    }
    let on_wall = |within_m| {
        errors
            .iter()
            .filter(|e| e.0 <= within_m)
            .map(|e| e.1)
            .sum::<f64>()
    };
    score.within_5cm.precision_ratio = share(on_wall(0.05), score.map_length_m);
    score.within_2cm.precision_ratio = share(on_wall(0.02), score.map_length_m);
    score.within_5cm.recall_ratio = recall(truth.seen, &map_grid, 0.05);
    score.within_2cm.recall_ratio = recall(truth.seen, &map_grid, 0.02);
    score.median_error_m = weighted_median(errors);
    score.doubled_ratio = share(score.doubled_ratio, score.map_length_m);
    score.people_ratio = share(score.people_ratio, score.map_length_m);
    score
}

fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// A point of a side and the length it stands for.
struct Sample {
    at: Point,
    length_m: f64,
}

fn samples(side: Segment) -> impl Iterator<Item = Sample> {
    let length_m = side.length_m();
    // The bound (5 km) keeps a stray vertex in a map from taking for ever.
    let count = ((length_m / PIECE_M).round() as usize).clamp(1, 100_000);
    (0..count).map(move |k| Sample {
        at: side.at((k as f64 + 0.5) / count as f64),
        length_m: length_m / count as f64,
    })
}

fn recall(seen: &SeenWalls, map: &SideGrid, within_m: f64) -> f64 {
    let found = seen
        .pieces()
        .filter(|piece| map.nearest(piece.middle, within_m).is_some());
    share(found.map(|piece| piece.length_m).sum(), seen.length_m())
}

/// For every side: the polyline it belongs to, its place in it, and how many sides that has if it is closed.
struct Owner {
    polyline: usize,
    order: usize,
    sides_of_loop: Option<usize>,
}

fn owners(map: &[Polyline]) -> Vec<Owner> {
    let of_one = |(polyline, p): (usize, &Polyline)| {
        let sides = p.sides().len();
        let sides_of_loop = (p.first() == p.last()).then_some(sides);
        (0..sides).map(move |order| Owner {
            polyline,
            order,
            sides_of_loop,
        })
    };
    map.iter().enumerate().flat_map(of_one).collect()
}

impl Owner {
    /// Whether two sides are one, or meet in a vertex.
    fn touches(&self, other: &Self) -> bool {
        let apart = self.order.abs_diff(other.order);
        self.polyline == other.polyline && (apart <= 1 || self.sides_of_loop.is_some_and(|n| apart + 1 == n))
    }
}

/// Whether another side, not a neighbour on the same polyline, runs beside side `k` at `p`, facing the same way.
fn is_doubled(map: &SideGrid, owners: &[Owner], k: usize, p: Point) -> bool {
    let Some(along) = map.sides()[k].direction() else {
        return false;
    };
    map.near(p, NEAR_M).into_iter().any(|(other, _)| {
        let side = map.sides()[other];
        let d = side.b - side.a;
        let foot = (p - side.a).dot(d) / d.dot(d);
        !owners[k].touches(&owners[other])
            && side.direction().is_some_and(|dir| dir.dot(along) > PARALLEL_COS)
            && (0.0..=1.0).contains(&foot)
    })
}

/// Places rounded to 5 cm, sorted by column, so that near ones are found fast and standing still costs nothing.
fn places(people: &[Point]) -> BTreeSet<(i64, i64)> {
    let round = |v: f64| (v / PIECE_M).round() as i64;
    people
        .iter()
        .filter(|p| p.is_finite())
        .map(|p| (round(p.x), round(p.y)))
        .collect()
}

fn is_near(places: &BTreeSet<(i64, i64)>, p: Point) -> bool {
    let reach = (PERSON_M / PIECE_M).ceil() as i64 + 1;
    let (x, y) = ((p.x / PIECE_M).round() as i64, (p.y / PIECE_M).round() as i64);
    (x - reach..=x + reach).any(|column| {
        places
            .range((column, y - reach)..=(column, y + reach))
            .any(|&(cx, cy)| p.distance(Point::new(cx as f64, cy as f64) * PIECE_M) <= PERSON_M)
    })
}

/// The value with half of the weight below it.
fn weighted_median(mut values: Vec<(f64, f64)>) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * values.iter().map(|v| v.1).sum::<f64>();
    let mut below = 0.0;
    values.into_iter().find_map(|(value, weight)| {
        below += weight;
        (below >= half).then_some(value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Plan, PlanKind};

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect()).unwrap()
    }

    /// A room of 4 m by 2 m, seen all round.
    fn room() -> Vec<Polyline> {
        vec![line(&[
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 2.0),
            (0.0, 2.0),
            (0.0, 0.0),
        ])]
    }

    fn score(map: &[Polyline], people: Vec<Point>) -> MapScore {
        let (walls, seen) = (room(), SeenWalls::everything(&room()));
        let truth = MapTruth {
            walls: &walls,
            seen: &seen,
            people,
        };
        score_map(map, Pose::IDENTITY, &truth)
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 0.006
    }

    #[test]
    fn the_truth_is_a_perfect_map_of_every_plan() {
        for kind in PlanKind::ALL {
            let plan = Plan::new(kind, 1);
            let seen = SeenWalls::everything(plan.walls());
            let truth = MapTruth {
                walls: plan.walls(),
                seen: &seen,
                people: Vec::new(),
            };
            let score = score_map(plan.walls(), Pose::IDENTITY, &truth);
            assert!(
                (score.within_2cm.f_score() - 1.0).abs() < 1e-12,
                "{kind} {score:?}"
            );
            assert!(score.doubled_ratio < 1e-3, "{kind} {score:?}");
            assert!(score.median_error_m.unwrap() < 1e-12);
        }
    }

    #[test]
    fn half_a_map_has_half_the_recall() {
        let score = score(&[line(&[(0.0, 0.0), (4.0, 0.0), (4.0, 2.0)])], Vec::new());
        assert!(near(score.within_5cm.precision_ratio, 1.0));
        // The ends of the walls that are missing lie within 5 cm of the map.
        assert!(near(score.within_5cm.recall_ratio, 0.5 + 0.1 / 12.0), "{score:?}");
        assert!(near(score.within_5cm.f_score(), 2.0 * 0.508 / 1.508));
    }

    #[test]
    fn a_wall_three_centimetres_off_passes_at_five_and_fails_at_two() {
        let score = score(&[line(&[(0.0, 0.03), (4.0, 0.03)])], Vec::new());
        assert!(near(score.within_5cm.precision_ratio, 1.0));
        assert!(near(score.within_2cm.precision_ratio, 0.0), "{score:?}");
        assert!(near(score.median_error_m.unwrap(), 0.03));
    }

    #[test]
    fn a_wall_drawn_twice_is_doubled_and_the_two_sides_of_a_thin_wall_are_not() {
        let twice = [line(&[(0.0, 0.0), (4.0, 0.0)]), line(&[(2.0, 0.1), (4.0, 0.1)])];
        assert!(near(score(&twice, Vec::new()).doubled_ratio, 4.0 / 6.0));
        let thin = [line(&[(0.0, 0.0), (4.0, 0.0)]), line(&[(4.0, -0.1), (0.0, -0.1)])];
        assert!(near(score(&thin, Vec::new()).doubled_ratio, 0.0));
        let bend = [line(&[(0.0, 0.0), (2.0, 0.0), (4.0, 0.05)])];
        assert!(
            near(score(&bend, Vec::new()).doubled_ratio, 0.0),
            "a side is not its neighbour's double"
        );
    }

    #[test]
    fn a_person_in_the_map_shows() {
        let map = [
            line(&[(0.0, 0.0), (3.0, 0.0)]),
            line(&[(2.0, 1.0), (2.5, 1.0)]),
            line(&[(1.0, 1.0), (1.5, 1.0)]),
        ];
        let score = score(&map, vec![Point::new(2.25, 1.1)]);
        assert!(near(score.people_ratio, 0.5 / 4.0), "{score:?}");
        assert!(near(score.within_5cm.precision_ratio, 3.0 / 4.0));
    }

    #[test]
    fn somebody_close_to_a_wall_does_not_make_the_wall_a_person() {
        let score = score(&room(), vec![Point::new(2.0, 0.1)]);
        assert!(near(score.people_ratio, 0.0));
    }

    #[test]
    fn a_map_in_its_own_frame_is_moved_first() {
        let (walls, seen) = (room(), SeenWalls::everything(&room()));
        let truth = MapTruth {
            walls: &walls,
            seen: &seen,
            people: Vec::new(),
        };
        let world_from_map = Pose::new(1.0, 1.0, 0.5);
        let map: Vec<Polyline> = room()
            .iter()
            .map(|p| p.transformed(world_from_map.inverse()))
            .collect();
        assert!(near(
            score_map(&map, world_from_map, &truth).within_2cm.f_score(),
            1.0
        ));
    }

    #[test]
    fn a_stray_vertex_far_away_costs_precision_and_nothing_else() {
        let mut map = room();
        map.push(line(&[(0.0, 1.0), (1e12, -1e11)]));
        let score = score(&map, Vec::new());
        assert!(near(score.within_2cm.recall_ratio, 1.0) && score.within_2cm.precision_ratio < 1e-6);
    }

    #[test]
    fn an_empty_map_scores_nothing() {
        let score = score(&[], Vec::new());
        assert_eq!(score.within_5cm, Agreement::default());
        assert_eq!((score.within_5cm.f_score(), score.median_error_m), (0.0, None));
    }
}
