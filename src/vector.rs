//! Vectors in space.

pub(crate) type Vector = [f64; 3];

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn squared_distance(a: Vector, b: Vector) -> f64 {
    let d = minus(a, b);
    dot(d, d)
}

/// How far points reach along each axis; nothing reaches −∞.
pub(crate) fn extents(points: impl IntoIterator<Item = Vector>) -> Vector {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        for c in 0..3 {
            (low[c], high[c]) = (low[c].min(p[c]), high[c].max(p[c]));
        }
    }
    minus(high, low)
}

/// The longest side of the box around points without the outermost hundredth on each side; 0 around hardly any.
pub(crate) fn middle_side(points: impl Iterator<Item = Vector> + Clone) -> f64 {
    let side = |c: usize| {
        let mut along: Vec<f64> = points.clone().map(|p| p[c]).collect();
        along.sort_unstable_by(f64::total_cmp);
        let cut = along.len() / 100;
        match &along[cut..along.len() - cut] {
            [first, .., last] => last - first,
            _ => 0.0,
        }
    };
    (0..3).map(side).fold(0.0, f64::max)
}

/// The longest side of the box around points; 0 around none.
pub(crate) fn longest_side(points: impl IntoIterator<Item = Vector>) -> f64 {
    extents(points).into_iter().fold(0.0, f64::max)
}
