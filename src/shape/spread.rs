//! Whether a set of points spans enough space to carry a surface, and how finely its coordinates resolve it.

use crate::vector::{cross, minus, norm};

use super::error::ShapeError;
use super::repair::Repair;

/// Largest coordinate: squared areas and their sums stay far inside f64.
const MAX_COORDINATE: f64 = 1e30;

/// Smallest size, as the longest side of the bounding box, for the same reason at the other end.
const MIN_EXTENT: f64 = 1e-30;

/// Points thinner than this multiple of their length are a line: it is the rounding of f32 coordinates (2⁻²⁴) with room for
/// a diagonal line of them.
const LINE_WIDTH: f64 = 1e-6;

/// A scan smaller than this multiple of its distance from the origin is reported: f32 files keep no shape at all there.
const FAR_OFF: f64 = 1e-6;

/// Refuses finite points that are too large, all in one place or on one line; reports a scan far from the origin.
pub(super) fn check(points: &[[f64; 3]]) -> Result<Option<Repair>, ShapeError> {
    for (index, p) in points.iter().enumerate() {
        if let Some(&value) = p.iter().find(|c| c.abs() > MAX_COORDINATE) {
            return Err(ShapeError::CoordinateTooLarge { index, value, limit: MAX_COORDINATE });
        }
    }

    let mut low = points[0];
    let mut high = points[0];
    for p in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let extent = minus(high, low).into_iter().fold(0.0, f64::max);
    let reach = low.iter().chain(&high).fold(0.0_f64, |m, c| m.max(c.abs()));
    if extent <= 4.0 * f64::EPSILON * reach {
        return Err(ShapeError::AllEqual { points: points.len() });
    }
    if extent < MIN_EXTENT {
        return Err(ShapeError::ExtentTooSmall { extent, limit: MIN_EXTENT });
    }
    let width = width(points) / extent;
    if width < LINE_WIDTH {
        return Err(ShapeError::Collinear { points: points.len(), width });
    }
    Ok(Repair::counted("far-from-origin", usize::from(extent < FAR_OFF * reach), || {
        format!(
            "the scan is {extent:.3e} units across but lies {reach:.3e} units from the origin; a file with single-precision \
             numbers has lost its shape there, so move the scan to the origin before saving it"
        )
    }))
}

/// Largest distance of a point from the line through the first point and the one farthest from it.
fn width(points: &[[f64; 3]]) -> f64 {
    let along =
        points.iter().map(|&p| minus(p, points[0])).fold([0.0; 3], |a, d| if norm(d) > norm(a) { d } else { a });
    let length = norm(along);
    let along = along.map(|c| c / length);
    points.iter().map(|&p| norm(cross(minus(p, points[0]), along))).fold(0.0, f64::max)
}
