use super::{Point, Pose, Segment};

/// Why a list of points is not a polyline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PolylineError {
    /// A polyline has at least one side.
    #[error("a polyline needs two vertices or more, {0} given")]
    TooFewVertices(usize),
    /// A coordinate is NaN or infinite.
    #[error("vertex {0} has a coordinate that is not a number")]
    NotFinite(usize),
}

/// Two or more finite vertices joined by straight sides; free space on the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    vertices: Vec<Point>,
}

impl Polyline {
    /// Checks and takes the vertices.
    ///
    /// # Errors
    /// Fewer than two vertices, or one that is not finite.
    pub fn new(vertices: Vec<Point>) -> Result<Self, PolylineError> {
        if vertices.len() < 2 {
            return Err(PolylineError::TooFewVertices(vertices.len()));
        }
        match vertices.iter().position(|p| !p.is_finite()) {
            Some(k) => Err(PolylineError::NotFinite(k)),
            None => Ok(Self { vertices }),
        }
    }

    /// The vertices in order, at least two.
    #[must_use]
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// The first vertex.
    #[must_use]
    pub fn first(&self) -> Point {
        self.vertices[0]
    }

    /// The last vertex.
    #[must_use]
    pub fn last(&self) -> Point {
        self.vertices[self.vertices.len() - 1]
    }

    /// The sides in order, one fewer than vertices.
    pub fn sides(&self) -> impl ExactSizeIterator<Item = Segment> + '_ {
        self.vertices.windows(2).map(|w| Segment::new(w[0], w[1]))
    }

    /// Arc length, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.sides().map(Segment::length_m).sum()
    }

    /// The polyline seen from another frame: `a_from_b` of a polyline of frame b.
    #[must_use]
    pub fn transformed(&self, a_from_b: Pose) -> Self {
        Self {
            vertices: a_from_b.transform(&self.vertices).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polyline_needs_a_side_and_numbers() {
        assert_eq!(
            Polyline::new(vec![Point::default()]),
            Err(PolylineError::TooFewVertices(1))
        );
        let bad = vec![Point::default(), Point::new(f64::NAN, 0.0)];
        assert_eq!(Polyline::new(bad), Err(PolylineError::NotFinite(1)));
    }
}
