//! A depth camera: what it sees of a surface, with the noise, the curtains at depth edges and the stray points that such cameras have.

use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use super::chance::{happens, normal, uniform};

/// Pixels of the image, across and down; focal length in pixels. Those of a common time-of-flight camera.
const SIZE: [usize; 2] = [512, 512];
const FOCAL: f64 = 365.0;
/// Standard deviation of depth at [`NOISE_AT`] metres; it grows with the square of the depth.
const NOISE: f64 = 0.002;
const NOISE_AT: f64 = 1.5;
/// A jump between two pixels from which on there are curtains, and what a silhouette has behind it: metres.
const JUMP: f64 = 0.03;
const BEHIND: f64 = 0.2;
/// Share of the pixels at an edge that are between the two depths.
const CURTAIN: f64 = 0.4;

/// Where the camera stands; it looks level, along `forward`.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Metres.
    pub place: DVec3,
    /// A unit vector without a vertical part.
    pub forward: DVec3,
}

/// A point of a depth image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Metres, in the axes of the scene.
    pub place: DVec3,
    /// The vertex seen there; `None` in a curtain.
    pub vertex: Option<u32>,
}

impl Camera {
    /// At `distance` metres from `target`, seen from there at `azimuth` radians from +z towards +x.
    pub fn around(target: DVec3, azimuth: f64, distance: f64) -> Self {
        let out = DVec3::new(azimuth.sin(), 0.0, azimuth.cos());
        Self { place: target + distance * out, forward: -out }
    }

    fn right(&self) -> DVec3 {
        self.forward.cross(DVec3::Y)
    }

    /// What it sees of a surface.
    pub fn sees(&self, points: &[DVec3], triangles: &[[u32; 3]], rng: &mut ChaCha8Rng) -> Vec<Pixel> {
        let [width, height] = SIZE;
        let image = self.image(points, triangles);
        let ray = |x: usize, y: usize, depth: f64| {
            let (across, up) =
                ((x as f64 + 0.5 - 0.5 * width as f64) / FOCAL, (0.5 * height as f64 - y as f64 - 0.5) / FOCAL);
            self.place + depth * (self.forward + across * self.right() + up * DVec3::Y)
        };
        let mut seen = Vec::new();
        for y in 1..height - 1 {
            for x in 1..width - 1 {
                let Some((depth, vertex)) = image[y * width + x] else { continue };
                let noise = NOISE * (depth / NOISE_AT).powi(2) * normal(rng);
                seen.push(Pixel { place: ray(x, y, depth + noise), vertex: Some(vertex) });
                for next in [y * width + x - 1, y * width + x + 1, (y - 1) * width + x, (y + 1) * width + x] {
                    let other = image[next].map_or(depth + BEHIND, |(other, _)| other);
                    if other > depth + JUMP && happens(rng, 0.25 * CURTAIN) {
                        let between = depth + uniform(rng, 0.1..1.0) * (other - depth).min(BEHIND);
                        seen.push(Pixel { place: ray(x, y, between), vertex: None });
                    }
                }
            }
        }
        seen
    }

    /// The vertices that are seen, one for each pixel.
    pub fn vertices(&self, points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<u32> {
        self.image(points, triangles).into_iter().flatten().map(|(_, vertex)| vertex).collect()
    }

    /// The nearest depth at each pixel, and the vertex there.
    fn image(&self, points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Option<(f64, u32)>> {
        let [width, height] = SIZE;
        let right = self.right();
        let project = |p: &DVec3| {
            let (way, depth) = (*p - self.place, (*p - self.place).dot(self.forward));
            let x = 0.5 * width as f64 + FOCAL * way.dot(right) / depth - 0.5;
            (x, 0.5 * height as f64 - FOCAL * way.y / depth - 0.5, depth)
        };
        let flat: Vec<(f64, f64, f64)> = points.iter().map(project).collect();
        let mut image: Vec<Option<(f64, u32)>> = vec![None; width * height];
        for t in triangles {
            let [a, b, c] = t.map(|v| flat[v as usize]);
            if [a, b, c].iter().any(|p| p.2 < 0.1) {
                continue;
            }
            let area = (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
            if area.abs() < 1e-9 {
                continue;
            }
            let range = |p: f64, q: f64, r: f64, most: usize| {
                let (low, high) = (p.min(q).min(r).ceil().max(0.0), p.max(q).max(r).floor().min(most as f64 - 1.0));
                low as usize..(high + 1.0).max(0.0) as usize
            };
            for y in range(a.1, b.1, c.1, height) {
                for x in range(a.0, b.0, c.0, width) {
                    let (px, py) = (x as f64, y as f64);
                    let part = |p: (f64, f64, f64), q: (f64, f64, f64)| {
                        ((p.0 - px) * (q.1 - py) - (p.1 - py) * (q.0 - px)) / area
                    };
                    let weights = [part(b, c), part(c, a), part(a, b)];
                    if weights.iter().any(|&w| w < 0.0) {
                        continue;
                    }
                    let depth = 1.0 / (weights[0] / a.2 + weights[1] / b.2 + weights[2] / c.2);
                    let pixel = &mut image[y * width + x];
                    if pixel.is_none_or(|(nearest, _)| depth < nearest) {
                        let most = (0..3).fold(0, |m, i| if weights[i] > weights[m] { i } else { m });
                        *pixel = Some((depth, t[most]));
                    }
                }
            }
        }
        image
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::things::Thing;
    use rand::SeedableRng;

    #[test]
    fn what_is_behind_is_not_seen_and_noise_is_millimetres() {
        let wall = |z: f64| Thing::rectangle(DVec3::new(-0.5, -0.5, z), DVec3::X, DVec3::Y, 0.1);
        let both = wall(0.0).with(&wall(-0.5));
        let camera = Camera::around(DVec3::ZERO, 0.0, 2.0);
        let seen = camera.sees(&both.points, &both.triangles, &mut ChaCha8Rng::seed_from_u64(1));
        let (front, rest): (Vec<Pixel>, Vec<Pixel>) = seen.into_iter().partition(|p| p.vertex.is_some());
        // 365/2 pixels a metre.
        assert!((31_000..35_000).contains(&front.len()), "{}", front.len());
        let near = front.iter().filter(|p| p.place.z.abs() < 0.02).count();
        assert!(near as f64 > 0.99 * front.len() as f64);
        let spread = front.iter().map(|p| p.place.z.powi(2)).sum::<f64>() / front.len() as f64;
        assert!((0.0030..0.0041).contains(&spread.sqrt()), "{}", spread.sqrt());
        assert!((50..600).contains(&rest.len()), "{} in curtains", rest.len());
    }
}
