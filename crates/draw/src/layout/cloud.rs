//! Point clouds thinned to what the page can show.
//!
//! In: any number of points, pixels. Out: at most one dot a cell of the page, the cell being as wide as a dot.
//! A cloud of few points is left as it is. How often a cell is hit against the mean of all hit cells gives one
//! of three strengths, so that walls seen by every scan stand out against stray returns. Order of the points
//! does not matter, and two million of them cost one pass.

use crate::plate::{Px, PxBox};

/// Up to this many points in the frame are drawn where they are.
const FEW: usize = 4000;

/// Dots by strength, the faintest first: (share of the full colour, places).
pub(super) fn thin(points: &[Px], frame: PxBox, cell_px: f64) -> Vec<(f64, Vec<Px>)> {
    let inside: Vec<Px> = points
        .iter()
        .copied()
        .filter(|p| p.is_finite() && frame.contains(*p))
        .collect();
    if inside.len() <= FEW {
        return vec![(1.0, inside)];
    }
    let columns = (frame.width / cell_px) as usize + 1;
    let rows = (frame.height / cell_px) as usize + 1;
    let mut hits = vec![0_u32; columns * rows];
    for p in &inside {
        let column = ((p.x - frame.left) / cell_px) as usize;
        let row = ((p.y - frame.top) / cell_px) as usize;
        if let Some(cell) = hits.get_mut(row * columns + column) {
            *cell = cell.saturating_add(1);
        }
    }
    let filled = hits.iter().filter(|n| **n > 0).count().max(1);
    let mean = inside.len() as f64 / filled as f64;
    let mut classes = vec![(0.35, Vec::new()), (0.65, Vec::new()), (1.0, Vec::new())];
    for (k, n) in hits.iter().enumerate().filter(|(_, n)| **n > 0) {
        let strength = f64::from(*n) / mean;
        let class = usize::from(strength > 0.12) + usize::from(strength > 0.5);
        let (column, row) = (k % columns, k / columns);
        classes[class].1.push(Px::new(
            frame.left + (column as f64 + 0.5) * cell_px,
            frame.top + (row as f64 + 0.5) * cell_px,
        ));
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: PxBox = PxBox {
        left: 0.0,
        top: 0.0,
        width: 100.0,
        height: 50.0,
    };

    #[test]
    fn few_points_stay_where_they_are() {
        let points = [Px::new(1.25, 2.5), Px::new(f64::NAN, 1.0), Px::new(500.0, 1.0)];
        assert_eq!(thin(&points, FRAME, 2.0), [(1.0, vec![Px::new(1.25, 2.5)])]);
    }

    #[test]
    fn many_points_become_a_dot_a_cell_and_rare_ones_are_faint() {
        let mut points = vec![Px::new(20.0, 20.0); 100_000];
        points.push(Px::new(70.0, 30.0));
        let classes = thin(&points, FRAME, 2.0);
        assert_eq!(classes.iter().map(|c| c.1.len()).collect::<Vec<_>>(), [1, 0, 1]);
        let mut reversed = points.clone();
        reversed.reverse();
        assert_eq!(thin(&reversed, FRAME, 2.0), classes);
    }
}
