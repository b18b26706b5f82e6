//! 3 × 3 matrices: the pieces that systems of planar poses (x, y, heading) are made of.

/// A 3 × 3 matrix, row by row.
pub(crate) type Matrix = [[f64; 3]; 3];
/// A column of three.
pub(crate) type Column = [f64; 3];

pub(crate) const ZERO: Matrix = [[0.0; 3]; 3];

/// a · b.
pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = ZERO;
    for (row, line) in out.iter_mut().zip(a) {
        for (c, cell) in row.iter_mut().enumerate() {
            *cell = line[0] * b[0][c] + line[1] * b[1][c] + line[2] * b[2][c];
        }
    }
    out
}

/// aᵀ.
pub(crate) fn transposed(a: &Matrix) -> Matrix {
    [
        [a[0][0], a[1][0], a[2][0]],
        [a[0][1], a[1][1], a[2][1]],
        [a[0][2], a[1][2], a[2][2]],
    ]
}

/// aᵀ · b.
pub(crate) fn transposed_product(a: &Matrix, b: &Matrix) -> Matrix {
    product(&transposed(a), b)
}

/// a · v.
pub(crate) fn times(a: &Matrix, v: Column) -> Column {
    a.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// aᵀ · v.
pub(crate) fn transposed_times(a: &Matrix, v: Column) -> Column {
    times(&transposed(a), v)
}

/// a += b.
pub(crate) fn add_to(a: &mut Matrix, b: &Matrix) {
    for (x, y) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *x += y;
    }
}

/// a −= b.
pub(crate) fn subtract_from(a: &mut Matrix, b: &Matrix) {
    for (x, y) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *x -= y;
    }
}

/// Replaces a by ½ (a + aᵀ): what rounding has put on one side of the diagonal only is taken out.
pub(crate) fn make_symmetric(a: &mut Matrix) {
    for r in 0..3 {
        for c in 0..r {
            let mean = 0.5 * (a[r][c] + a[c][r]);
            a[r][c] = mean;
            a[c][r] = mean;
        }
    }
}

/// a⁻¹; `None` when it is singular.
pub(crate) fn inverted(a: &Matrix) -> Option<Matrix> {
    let cofactor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1]
    };
    let determinant = (0..3).map(|c| a[0][c] * cofactor(0, c)).sum::<f64>();
    if !determinant.is_finite() || determinant.abs() < 1e-300 {
        return None;
    }
    let mut out = ZERO;
    for (r, row) in out.iter_mut().enumerate() {
        for (c, cell) in row.iter_mut().enumerate() {
            *cell = cofactor(c, r) / determinant;
        }
    }
    Some(out)
}
