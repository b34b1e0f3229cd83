//! Small closed shells on the skin: eyes, teeth, buttons.

use glam::DVec3;

use super::shell::Shell;

/// Rings of a ball between its poles, and points on each.
const RINGS: usize = 5;
const AROUND: usize = 10;

/// A ball around `centre` stretched by `radii` along `axes` (unit vectors), over the vertex `below`.
pub fn ball(name: &str, centre: DVec3, axes: [DVec3; 3], radii: [f64; 3], below: u32) -> Shell {
    let place = |p: DVec3| centre + radii[0] * p.x * axes[0] + radii[1] * p.y * axes[1] + radii[2] * p.z * axes[2];
    let mut points = vec![place(DVec3::Z)];
    for ring in 1..=RINGS {
        let (s, c) = (std::f64::consts::PI * ring as f64 / (RINGS + 1) as f64).sin_cos();
        for k in 0..AROUND {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / AROUND as f64).sin_cos();
            points.push(place(DVec3::new(s * cos, s * sin, c)));
        }
    }
    points.push(place(DVec3::NEG_Z));
    let at = |ring: usize, k: usize| (1 + ring * AROUND + k % AROUND) as u32;
    let last = points.len() as u32 - 1;
    let mut triangles = Vec::new();
    for k in 0..AROUND {
        triangles.push([0, at(0, k), at(0, k + 1)]);
        for ring in 0..RINGS - 1 {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        triangles.push([last, at(RINGS - 1, k + 1), at(RINGS - 1, k)]);
    }
    Shell {
        name: name.to_owned(),
        below: vec![below; points.len()],
        points,
        triangles,
        covers: Vec::new(),
        open: false,
    }
}

/// Three axes at right angles, the last of them along `normal`.
pub fn frame(normal: DVec3) -> [DVec3; 3] {
    let n = normal.normalize_or(DVec3::Z);
    let across = DVec3::Y.cross(n).normalize_or(DVec3::X);
    [across, n.cross(across), n]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::manifold::is_closed_manifold;

    #[test]
    fn a_ball_is_closed_and_wound_outwards() {
        let ball = ball("ball", DVec3::X, frame(DVec3::new(1.0, 2.0, 0.5)), [0.1, 0.2, 0.1], 7);
        assert!(is_closed_manifold(ball.points.len(), &ball.triangles));
        let outwards = ball.triangles.iter().all(|t| {
            let [p, q, r] = t.map(|v| ball.points[v as usize]);
            (q - p).cross(r - p).dot((p + q + r) / 3.0 - DVec3::X) > 0.0
        });
        assert!(outwards);
    }
}
