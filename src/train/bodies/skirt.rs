//! What hangs around both legs: a tube from the waist down, as wide as what is inside it.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use super::shell::{Cover, Shell};

/// Points around.
const AROUND: usize = 40;
/// Rings from the waist to the hem.
const RINGS: usize = 16;
/// A skirt hides legs whatever else lies on them.
const OUTERMOST: f64 = 1.0;

/// The tube from `top` to `hem` (metres) around those vertices of the skin that are `inside`, `height` above them.
pub fn skirt(
    name: &str,
    skin: &[DVec3],
    normals: &[DVec3],
    inside: &[bool],
    [top, hem]: [DVec3; 2],
    height: f64,
) -> Shell {
    let down = (hem - top).normalize_or(DVec3::NEG_Y);
    let length = top.distance(hem);
    let across = down.cross(DVec3::Z).normalize_or(DVec3::X);
    let front = across.cross(down);
    let flat = |p: DVec3| ((p - top).dot(down) / length, (p - top).dot(across), (p - top).dot(front));
    let within: Vec<(u32, (f64, f64, f64))> =
        (0..skin.len()).filter(|&v| inside[v]).map(|v| (v as u32, flat(skin[v]))).collect();

    let angle = |k: usize| TAU * k as f64 / AROUND as f64;
    let mut radii: Vec<[f64; AROUND]> = Vec::with_capacity(RINGS);
    for ring in 0..RINGS {
        let s = ring as f64 / (RINGS - 1) as f64;
        // How far what is inside reaches in each direction, over a slab of a ring and a half each way.
        let mut reach = [0.03f64; AROUND];
        for (_, (t, x, z)) in within.iter().filter(|(_, (t, ..))| (t - s).abs() < 1.5 / RINGS as f64) {
            for (k, reach) in reach.iter_mut().enumerate() {
                let (sin, cos) = angle(k).sin_cos();
                *reach = reach.max(x * cos + z * sin + height * (1.0 + t.max(0.0)));
            }
        }
        // As wide as the nearest of the lines that bound the ring, and hardly narrower than above.
        let radius = |k: usize| {
            let bounds = (0..AROUND).filter_map(|j| {
                let turn = (angle(k) - angle(j) + 1.5 * TAU) % TAU - 0.5 * TAU;
                (turn.abs() < 0.9 * FRAC_PI_2).then(|| reach[j] / turn.cos())
            });
            let above = radii.last().map_or(0.0, |above: &[f64; AROUND]| above[k]);
            bounds.fold(f64::INFINITY, f64::min).max(0.98 * above)
        };
        let around = std::array::from_fn(radius);
        radii.push(around);
    }
    let at = |ring: usize, k: usize| (ring * AROUND + k % AROUND) as u32;
    let points: Vec<DVec3> = (0..RINGS * AROUND)
        .map(|i| {
            let (ring, k) = (i / AROUND, i % AROUND);
            let (sin, cos) = angle(k).sin_cos();
            top + length * (ring as f64 / (RINGS - 1) as f64) * down + radii[ring][k] * (cos * across + sin * front)
        })
        .collect();
    let quads = (0..RINGS - 1).flat_map(|ring| (0..AROUND).map(move |k| (ring, k)));
    let triangles = quads
        .flat_map(|(r, k)| {
            let [a, b, c, d] = [at(r, k), at(r, k + 1), at(r + 1, k), at(r + 1, k + 1)];
            [[a, b, c], [b, d, c]]
        })
        .collect();
    let covers = within.iter().filter(|(_, (t, ..))| (0.0..=1.0).contains(t)).map(|&(vertex, (t, x, z))| {
        let ring = (t * (RINGS - 1) as f64).round() as usize;
        let k = ((z.atan2(x) / TAU).rem_euclid(1.0) * AROUND as f64).round() as usize;
        let outwards = (x * across + z * front).normalize_or_zero().dot(normals[vertex as usize]);
        Cover { vertex, height: OUTERMOST, point: (outwards > 0.3).then(|| at(ring, k)) }
    });
    let nearest = |p: &DVec3| {
        let apart = |v: u32| skin[v as usize].distance_squared(*p);
        within.iter().map(|w| w.0).min_by(|&a, &b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
    };
    Shell {
        name: name.to_owned(),
        below: points.iter().map(nearest).collect(),
        covers: covers.collect(),
        points,
        triangles,
        open: true,
    }
}
