//! What scans have besides the body: plates, walls, boxes, turntables, as meshes of small triangles.

use std::collections::BTreeMap;

use glam::DVec3;

use super::shell::border;

/// A thing of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Thing {
    /// Metres.
    pub points: Vec<DVec3>,
    /// Over `points`.
    pub triangles: Vec<[u32; 3]>,
}

impl Thing {
    /// A rectangle from `corner` along `u` and `v`, in squares of about `spacing`, facing along `u × v`.
    pub fn rectangle(corner: DVec3, u: DVec3, v: DVec3, spacing: f64) -> Self {
        let steps = |way: DVec3| (way.length() / spacing).ceil().max(1.0) as usize;
        let (columns, rows) = (steps(u), steps(v));
        let at = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
        let mut thing = Self::default();
        for j in 0..=rows {
            for i in 0..=columns {
                thing.points.push(corner + u * (i as f64 / columns as f64) + v * (j as f64 / rows as f64));
                if i < columns && j < rows {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    thing.triangles.extend(if (i + j) % 2 == 0 {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    });
                }
            }
        }
        thing
    }

    /// A level square of side `side` around `centre`.
    pub fn plate(centre: DVec3, side: f64, spacing: f64) -> Self {
        let half = 0.5 * side;
        Self::rectangle(centre - DVec3::new(half, 0.0, half), side * DVec3::Z, side * DVec3::X, spacing)
    }

    /// A box whose top has its middle at `top`; edges are not shared between its faces.
    pub fn block(top: DVec3, size: DVec3, spacing: f64) -> Self {
        let (x, y, z) = (size.x * DVec3::X, size.y * DVec3::Y, size.z * DVec3::Z);
        let low = top - 0.5 * x - 0.5 * z - y;
        let faces = [(low, x, z), (low + y, z, x), (low, y, x), (low + z, x, y), (low, z, y), (low + x, y, z)];
        faces.into_iter().fold(Self::default(), |all, (corner, u, v)| all.with(&Self::rectangle(corner, u, v, spacing)))
    }

    /// A turntable: a level disc of `radius` with a rim of `thickness`, its top around `centre`.
    pub fn disc(centre: DVec3, radius: f64, thickness: f64, spacing: f64) -> Self {
        let rings = (radius / spacing).ceil().max(2.0) as usize;
        let around = (std::f64::consts::TAU * radius / spacing).ceil() as usize;
        let mut points = vec![centre];
        // The last ring is the lower edge of the rim.
        for ring in 1..=rings + 1 {
            let r = radius * ring.min(rings) as f64 / rings as f64;
            let down = if ring > rings { thickness } else { 0.0 };
            points.extend((0..around).map(|k| {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / around as f64).sin_cos();
                centre + DVec3::new(r * cos, -down, r * sin)
            }));
        }
        let at = |ring: usize, k: usize| (1 + (ring - 1) * around + k % around) as u32;
        let mut triangles: Vec<[u32; 3]> = (0..around).map(|k| [0, at(1, k + 1), at(1, k)]).collect();
        for (ring, k) in (1..=rings).flat_map(|ring| (0..around).map(move |k| (ring, k))) {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
        Self { points, triangles }
    }

    /// Both, apart.
    pub fn with(mut self, other: &Self) -> Self {
        let first = self.points.len() as u32;
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        self
    }

    /// Which points of `body` a point of the thing becomes one with: the nearest within `reach`.
    pub fn fused(&self, body: &[DVec3], reach: f64) -> BTreeMap<u32, u32> {
        let low: Vec<(u32, DVec3)> = (0..).zip(body.iter().copied()).filter(|(_, p)| p.y < reach).collect();
        let nearest = |p: &DVec3| {
            let best = low.iter().min_by(|a, b| a.1.distance_squared(*p).total_cmp(&b.1.distance_squared(*p)))?;
            (best.1.distance(*p) < reach).then_some(best.0)
        };
        (0..).zip(&self.points).filter_map(|(i, p)| Some((i, nearest(p)?))).collect()
    }

    /// Square metres.
    pub fn area(&self) -> f64 {
        let at = |v: u32| self.points[v as usize];
        0.5 * self.triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).length()).sum::<f64>()
    }

    /// How many points are on a border.
    pub fn rim(&self) -> usize {
        border(&self.triangles).len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_have_the_area_and_the_borders_of_their_form() {
        let plate = Thing::plate(DVec3::ZERO, 0.7, 0.05);
        assert!((plate.area() - 0.49).abs() < 1e-12 && plate.rim() == 4 * 14);
        let up = plate.triangles.iter().all(|t| {
            let [p, q, r] = t.map(|v| plate.points[v as usize]);
            (q - p).cross(r - p).y > 0.0
        });
        assert!(up);
        let block = Thing::block(DVec3::Y, DVec3::new(0.4, 0.5, 0.4), 0.1);
        assert!((block.area() - (2.0 * 0.16 + 4.0 * 0.2)).abs() < 1e-12);
        let disc = Thing::disc(DVec3::ZERO, 0.5, 0.03, 0.03);
        assert!((disc.area() - (0.25 + 0.03) * std::f64::consts::PI).abs() < 0.01, "{}", disc.area());
    }
}
