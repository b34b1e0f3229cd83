//! Pieces of a body: what is left behind a plane, between holes, in front of a camera or inside a box that it leaves.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use rand_chacha::ChaCha8Rng;

use super::camera::Camera;
use super::chance::{normal_vector, pick, pick_by, rotation, uniform};

/// Share of the area that a plane takes away.
const BEHIND_A_PLANE: std::ops::Range<f64> = 0.12..0.75;
/// Discs that are cut out, and their radius in √area: the recipes M and H of PFAUST (Bracha et al. 2024).
const FEW: (usize, f64) = (4, 0.16);
const MANY: (usize, f64) = (13, 0.10);
/// Planes of a box, and what each takes away.
const WALLS: std::ops::Range<f64> = 2.0..5.0;
const BEHIND_A_WALL: std::ops::Range<f64> = 0.04..0.3;
/// How far a camera stands off, in metres.
const OFF: std::ops::Range<f64> = 1.6..3.5;
/// A camera stands no farther above or below than this, in radians.
const TILT: f64 = 0.6;
/// Fragments with less of what is left than this are lost.
const FRAGMENT: f64 = 0.05;
/// A piece with less of the body than this is nobody's.
const LEAST: f64 = 0.2;

#[derive(Clone, Copy)]
enum Kind {
    Plane,
    Holes((usize, f64)),
    View,
    Box,
}

/// What a random piece of a body (metres) is called, and its triangles; all of them where so little was left that it is no piece.
pub(super) fn piece(skin: &[DVec3], triangles: &[[u32; 3]], rng: &mut ChaCha8Rng) -> (&'static str, Vec<[u32; 3]>) {
    let kinds = [
        (0.3, ("cut", Kind::Plane)),
        (0.15, ("holesM", Kind::Holes(FEW))),
        (0.15, ("holesH", Kind::Holes(MANY))),
        (0.25, ("view", Kind::View)),
        (0.15, ("box", Kind::Box)),
    ];
    let (name, kind) = pick_by(rng, &kinds);
    let left = match kind {
        Kind::Plane => in_front(skin, triangles.to_vec(), normal_vector(rng), uniform(rng, BEHIND_A_PLANE)),
        Kind::Holes((count, radius)) => with_holes(skin, triangles, count, radius, rng),
        Kind::View => seen(skin, triangles, rng),
        Kind::Box => {
            let turn = rotation(rng);
            let mut left = triangles.to_vec();
            for wall in 0..uniform(rng, WALLS) as usize {
                let axis = [DVec3::X, DVec3::Y, DVec3::Z][wall % 3];
                let out = if wall < 3 { axis } else { -axis };
                left = in_front(skin, left, turn * out, uniform(rng, BEHIND_A_WALL));
            }
            left
        }
    };
    let left = fragments(skin, left);
    (name, if area(skin, &left) < LEAST * area(skin, triangles) { triangles.to_vec() } else { left })
}

/// What a plane leaves that takes a share of the area away.
fn in_front(skin: &[DVec3], mut triangles: Vec<[u32; 3]>, direction: DVec3, share: f64) -> Vec<[u32; 3]> {
    let along = |t: &[u32; 3]| centre(skin, t).dot(direction);
    triangles.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let mut gone = share * area(skin, &triangles);
    let first = triangles.iter().position(|t| {
        gone -= area(skin, std::slice::from_ref(t));
        gone < 0.0
    });
    triangles.split_off(first.unwrap_or(0))
}

/// What discs leave that are cut out around random places, each of what hangs together with its middle.
fn with_holes(
    skin: &[DVec3],
    triangles: &[[u32; 3]],
    count: usize,
    radius: f64,
    rng: &mut ChaCha8Rng,
) -> Vec<[u32; 3]> {
    let radius = radius * area(skin, triangles).sqrt();
    let mut left = triangles.to_vec();
    for _ in 0..count {
        let middle = pick(rng, triangles)[0];
        let (disc, rest): (Vec<_>, Vec<_>) =
            left.into_iter().partition(|t| centre(skin, t).distance(skin[middle as usize]) < radius);
        left = rest;
        // What is only near in space, as the other leg is, stays.
        let around = |t: &[u32; 3]| t.contains(&middle);
        left.extend(pieces(skin.len(), &disc).into_values().filter(|piece| !piece.iter().any(around)).flatten());
    }
    left
}

/// What a camera sees from somewhere around.
fn seen(skin: &[DVec3], triangles: &[[u32; 3]], rng: &mut ChaCha8Rng) -> Vec<[u32; 3]> {
    let middle = skin.iter().sum::<DVec3>() / skin.len() as f64;
    let tilt = DQuat::from_rotation_x(uniform(rng, -TILT..TILT))
        * DQuat::from_rotation_y(uniform(rng, 0.0..std::f64::consts::TAU));
    let stands: Vec<DVec3> = skin.iter().map(|p| tilt * (*p - middle)).collect();
    let image = Camera::around(DVec3::ZERO, 0.0, uniform(rng, OFF)).vertices(&stands, triangles);
    let mut is_seen = vec![false; skin.len()];
    image.into_iter().for_each(|v| is_seen[v as usize] = true);
    let corners = |t: &&[u32; 3]| t.iter().filter(|&&v| is_seen[v as usize]).count() >= 2;
    triangles.iter().filter(corners).copied().collect()
}

/// The triangles without those of small fragments.
fn fragments(skin: &[DVec3], triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let least = FRAGMENT * area(skin, &triangles);
    pieces(skin.len(), &triangles).into_values().filter(|piece| area(skin, piece) >= least).flatten().collect()
}

/// The triangles of every connected piece of a surface on `count` vertices.
pub(super) fn pieces(count: usize, triangles: &[[u32; 3]]) -> BTreeMap<u32, Vec<[u32; 3]>> {
    let (piece, _) = crate::graph::components(count, triangles.iter().flat_map(|&[a, b, c]| [(a, b), (a, c)]));
    let mut of: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    triangles.iter().for_each(|t| of.entry(piece[t[0] as usize]).or_default().push(*t));
    of
}

fn centre(skin: &[DVec3], t: &[u32; 3]) -> DVec3 {
    t.iter().map(|&v| skin[v as usize]).sum::<DVec3>() / 3.0
}

pub(super) fn area(skin: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let doubled = triangles.iter().map(|t| {
        let [p, q, r] = t.map(|v| skin[v as usize]);
        (q - p).cross(r - p).length()
    });
    0.5 * doubled.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::train::bodies::manifold::tests::torus;

    /// 1.8 m across.
    fn ring() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (skin, triangles) = torus();
        (skin.into_iter().map(|p| 0.3 * p).collect(), triangles)
    }

    #[test]
    fn pieces_are_some_of_the_surface_and_of_every_size() {
        let (skin, triangles) = ring();
        let whole = area(&skin, &triangles);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let shares: Vec<f64> = (0..60).map(|_| area(&skin, &piece(&skin, &triangles, &mut rng).1) / whole).collect();
        assert!(shares.iter().all(|share| (LEAST..=1.0).contains(share)), "{shares:?}");
        assert!(shares.iter().filter(|&&share| share < 0.5).count() >= 10);
        assert!(shares.iter().filter(|&&share| share > 0.99).count() <= 12, "{shares:?}");
    }

    #[test]
    fn a_camera_sees_the_side_that_it_stands_on() {
        let (skin, triangles) = ring();
        let share = area(&skin, &seen(&skin, &triangles, &mut ChaCha8Rng::seed_from_u64(2))) / area(&skin, &triangles);
        assert!((0.2..0.65).contains(&share), "{share}");
    }

    #[test]
    fn a_hole_is_of_what_hangs_together() {
        // Two sheets, one close above the other.
        let sheet = |z: f64| (0..100).map(move |i| DVec3::new(f64::from(i % 10), f64::from(i / 10), z));
        let skin: Vec<DVec3> = sheet(0.0).chain(sheet(0.1)).collect();
        let squares = (0..200_u32).filter(|i| i % 10 < 9 && i % 100 < 90);
        let triangles: Vec<[u32; 3]> = squares.flat_map(|i| [[i, i + 1, i + 10], [i + 1, i + 11, i + 10]]).collect();
        let left = with_holes(&skin, &triangles, 1, 0.2, &mut ChaCha8Rng::seed_from_u64(3));
        let of = |upper: bool| left.iter().filter(|t| (t[0] >= 100) == upper).count();
        assert!(left.len() < triangles.len());
        assert!(of(false) == triangles.len() / 2 || of(true) == triangles.len() / 2, "{} {}", of(false), of(true));
    }
}
