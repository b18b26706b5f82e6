//! Vertices of chains moved to where the squared range residuals of the beams are least.
//!
//! A beam of direction e that hits the side a–b at share s, normal n, has the range r̂ with ∂r̂/∂a = (1−s) n/(n·e) and
//! ∂r̂/∂b = s n/(n·e). Gauss-Newton on the vertices of a chain is a block tridiagonal system with 2 × 2 blocks; inner
//! vertices move freely, end vertices on their rays. A step that does not lower the cost is damped, then given up.

use super::fit::Line;
use crate::geometry::Point;

/// Rounds of Gauss-Newton; the gain of a fourth is below 1 % of the residual.
const ROUNDS: usize = 4;

/// A chain of vertices with the returns it explains.
pub(super) struct Refine<'a> {
    /// Returns of the chain, counter-clockwise.
    pub(super) points: &'a [Point],
}

#[derive(Clone, Copy, Debug, Default)]
struct Block {
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Block {
    fn add(&mut self, n: Point, w: f64) {
        self.xx += w * n.x * n.x;
        self.xy += w * n.x * n.y;
        self.yy += w * n.y * n.y;
    }
}

/// Normal equations: `diagonal[v]`, `next[v]` (to vertex v+1, symmetric as it is w·n nᵀ), `gradient[v]`.
struct Equations {
    diagonal: Vec<Block>,
    next: Vec<Block>,
    gradient: Vec<Point>,
    cost: f64,
}

impl Refine<'_> {
    /// The vertices, refined.
    pub(super) fn run(&self, mut vertices: Vec<Point>) -> Vec<Point> {
        let Some(mut equations) = self.equations(&vertices) else {
            return vertices;
        };
        let mut damping = 1e-3;
        for _ in 0..ROUNDS {
            let moved = equations.step(&vertices, damping);
            match self.equations(&moved) {
                Some(better) if better.cost < equations.cost && in_order(&moved) => {
                    let gain = equations.cost - better.cost;
                    (vertices, equations) = (moved, better);
                    damping *= 0.1;
                    if gain < 1e-3 * equations.cost {
                        break;
                    }
                }
                _ => damping *= 30.0,
            }
        }
        vertices
    }

    /// Normal equations and cost at `vertices`; `None` when a beam has no reading on its side.
    fn equations(&self, vertices: &[Point]) -> Option<Equations> {
        let count = vertices.len();
        let mut out = Equations {
            diagonal: vec![Block::default(); count],
            next: vec![Block::default(); count],
            gradient: vec![Point::default(); count],
            cost: 0.0,
        };
        let mut v = 0;
        let mut line = side_line(vertices[0], vertices[1])?;
        for &p in self.points {
            while v + 2 < count && vertices[v + 1].cross(p) > 0.0 {
                v += 1;
                line = side_line(vertices[v], vertices[v + 1])?;
            }
            let range_m = p.norm();
            let hit = line.on_ray_of(p)?;
            let residual_m = hit.norm() - range_m;
            let along = vertices[v + 1] - vertices[v];
            let share = ((hit - vertices[v]).dot(along) / along.dot(along)).clamp(0.0, 1.0);
            let rate = range_m / line.normal.dot(p);
            let n = line.normal * rate;
            out.cost += residual_m * residual_m;
            out.diagonal[v].add(n, (1.0 - share) * (1.0 - share));
            out.diagonal[v + 1].add(n, share * share);
            out.next[v].add(n, share * (1.0 - share));
            out.gradient[v] += n * ((1.0 - share) * residual_m);
            out.gradient[v + 1] += n * (share * residual_m);
        }
        Some(out)
    }
}

/// The line through two vertices, with its normal away from the origin.
fn side_line(a: Point, b: Point) -> Option<Line> {
    let normal = (b - a).left().unit()?;
    let offset_m = normal.dot(a);
    Some(Line { normal, offset_m })
}

/// Whether the vertices still turn counter-clockwise round the origin.
fn in_order(vertices: &[Point]) -> bool {
    vertices.windows(2).all(|w| w[0].cross(w[1]) > 0.0)
}

impl Equations {
    /// The vertices after one damped step: block elimination forth and back.
    fn step(&self, vertices: &[Point], damping: f64) -> Vec<Point> {
        let count = vertices.len();
        let mut pivots: Vec<Block> = Vec::with_capacity(count);
        let mut sides: Vec<Point> = Vec::with_capacity(count);
        for v in 0..count {
            let mut d = self.diagonal[v];
            let mut g = -self.gradient[v];
            let scale = damping * (d.xx + d.yy) + 1e-12;
            d.xx += scale;
            d.yy += scale;
            if v > 0 {
                let inverse = invert(pivots[v - 1]);
                let b = self.next_of(v - 1, vertices);
                // d −= bᵀ inverse b, g −= bᵀ inverse · side
                let ib = times(inverse, b);
                d.xx -= b[0][0] * ib[0][0] + b[1][0] * ib[1][0];
                d.xy -= b[0][0] * ib[0][1] + b[1][0] * ib[1][1];
                d.yy -= b[0][1] * ib[0][1] + b[1][1] * ib[1][1];
                let s = apply(inverse, sides[v - 1]);
                g = g - Point::new(b[0][0] * s.x + b[1][0] * s.y, b[0][1] * s.x + b[1][1] * s.y);
            }
            if v == 0 || v + 1 == count {
                (d, g) = on_ray(d, g, vertices[v]);
            }
            pivots.push(d);
            sides.push(g);
        }
        let mut moved = vertices.to_vec();
        let mut last = Point::default();
        for v in (0..count).rev() {
            let mut g = sides[v];
            if v + 1 < count {
                let b = self.next_of(v, vertices);
                g = g - Point::new(
                    b[0][0] * last.x + b[0][1] * last.y,
                    b[1][0] * last.x + b[1][1] * last.y,
                );
                if v == 0 {
                    (_, g) = on_ray(pivots[v], g, vertices[v]);
                }
            }
            last = apply(invert(pivots[v]), g);
            moved[v] = vertices[v] + last;
        }
        moved
    }

    /// Coupling of vertex v to v+1, end vertices seen along their rays only.
    fn next_of(&self, v: usize, vertices: &[Point]) -> [[f64; 2]; 2] {
        let b = self.next[v];
        let mut m = [[b.xx, b.xy], [b.xy, b.yy]];
        let count = vertices.len();
        if v == 0
            && let Some(e) = vertices[0].unit()
        {
            let row = [e.x * m[0][0] + e.y * m[1][0], e.x * m[0][1] + e.y * m[1][1]];
            m = [[e.x * row[0], e.x * row[1]], [e.y * row[0], e.y * row[1]]];
        }
        if v + 2 == count
            && let Some(e) = vertices[count - 1].unit()
        {
            let column = [m[0][0] * e.x + m[0][1] * e.y, m[1][0] * e.x + m[1][1] * e.y];
            m = [
                [column[0] * e.x, column[0] * e.y],
                [column[1] * e.x, column[1] * e.y],
            ];
        }
        m
    }
}

/// A block and its side reduced to the direction of the ray through `p`; stiff across it.
fn on_ray(d: Block, g: Point, p: Point) -> (Block, Point) {
    let Some(e) = p.unit() else { return (d, g) };
    let along = e.x * e.x * d.xx + 2.0 * e.x * e.y * d.xy + e.y * e.y * d.yy;
    let across = along.max(1e-9);
    let f = e.left();
    let block = Block {
        xx: along * e.x * e.x + across * f.x * f.x,
        xy: along * e.x * e.y + across * f.x * f.y,
        yy: along * e.y * e.y + across * f.y * f.y,
    };
    (block, e * g.dot(e))
}

fn invert(b: Block) -> Block {
    let det = (b.xx * b.yy - b.xy * b.xy).max(1e-300);
    Block {
        xx: b.yy / det,
        xy: -b.xy / det,
        yy: b.xx / det,
    }
}

fn apply(b: Block, p: Point) -> Point {
    Point::new(b.xx * p.x + b.xy * p.y, b.xy * p.x + b.yy * p.y)
}

fn times(b: Block, m: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [
        [b.xx * m[0][0] + b.xy * m[1][0], b.xx * m[0][1] + b.xy * m[1][1]],
        [b.xy * m[0][0] + b.yy * m[1][0], b.xy * m[0][1] + b.yy * m[1][1]],
    ]
}
