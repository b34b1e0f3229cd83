//! The quadric error of Garland, Heckbert: *Surface simplification using quadric error metrics* (1997).

use glam::{DMat3, DVec3};

/// Sum of squared distances to planes, weighted by area: `xᵀA x − 2 bᵀx + c`.
#[derive(Clone, Copy)]
pub struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
    area: f64,
}

impl Quadric {
    /// No planes.
    pub const ZERO: Self = Self { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0, area: 0.0 };

    /// The plane of one triangle.
    pub fn of_triangle([p, q, r]: [DVec3; 3]) -> Self {
        let normal = (q - p).cross(r - p);
        let area = normal.length() / 2.0;
        let n = normal.normalize_or_zero();
        let d = n.dot(p);
        let a = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        Self { a: a * area, b: n * (d * area), c: d * d * area, area }
    }

    /// The planes of both.
    pub fn plus(self, o: Self) -> Self {
        Self { a: self.a + o.a, b: self.b + o.b, c: self.c + o.c, area: self.area + o.area }
    }

    /// Mean squared distance of `x` to the planes.
    pub fn at(&self, x: DVec3) -> f64 {
        ((x.dot(self.a * x) - 2.0 * self.b.dot(x) + self.c) / self.area.max(f64::MIN_POSITIVE)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_the_mean_squared_distance_to_the_planes() {
        // The planes x = 4 and y = 1, the second with three times the area.
        let x = Quadric::of_triangle([DVec3::X * 4.0, DVec3::new(4.0, 1.0, 0.0), DVec3::new(4.0, 0.0, 1.0)]);
        let y = Quadric::of_triangle([DVec3::Y, DVec3::new(0.0, 1.0, 3.0), DVec3::new(1.0, 1.0, 0.0)]);
        assert!(Quadric::ZERO.plus(x).at(DVec3::new(4.0, 7.0, -2.0)).abs() < 1e-12);
        let both = x.plus(y).at(DVec3::new(2.0, 3.0, 5.0));
        assert!((both - (0.25 * 4.0 + 0.75 * 4.0)).abs() < 1e-12);
        let off = x.plus(y).at(DVec3::new(4.0, 3.0, 5.0));
        assert!((off - 0.75 * 4.0).abs() < 1e-12);
    }
}
