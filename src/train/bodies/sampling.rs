//! Clouds as scanners and their software sample them: evenly, thinned in places, in two passes, on a grid of voxels, from depth images.

use std::collections::BTreeMap;

use glam::DVec3;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::BodyModel;
use super::camera::Camera;
use super::chance::{happens, uniform};
use super::cloud::{Drawn, draw_points};
use crate::progress::Cancelled;
use crate::shape::farthest_points;

/// Points drawn for each one that an even sample keeps.
const POOL: usize = 4;
/// Distance of depth cameras in metres.
const DISTANCE: std::ops::Range<f64> = 1.6..2.4;

/// `count` points evenly spread.
pub fn even(points: &[DVec3], triangles: &[[u32; 3]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Drawn> {
    let pool = draw_points(points, triangles, POOL * count, rng);
    let places: Vec<[f64; 3]> = pool.iter().map(|d| d.place.to_array()).collect();
    let all: Vec<u32> = (0..places.len() as u32).collect();
    let chosen = farthest_points(&places, &all, count, &mut unheard).unwrap_or(all);
    chosen.into_iter().map(|i| pool[i as usize]).collect()
}

/// An even sample, `spacing` times as wide on the parts with these labels.
pub fn thinned(model: &BodyModel, skin: &[DVec3], thin: &[u32], spacing: f64, rng: &mut ChaCha8Rng) -> Vec<Drawn> {
    let drawn = even(skin, &model.skin.triangles, 6000, rng);
    let keep = |d: &Drawn, rng: &mut ChaCha8Rng| {
        !thin.contains(&model.labels[d.vertex as usize]) || happens(rng, spacing.powi(-2))
    };
    drawn.into_iter().filter(|d| keep(d, rng)).collect()
}

/// Two passes that overlap at the hips: a dense one above, a coarse one below, a little apart from each other.
pub fn two_passes(model: &BodyModel, skin: &[DVec3], rng: &mut ChaCha8Rng) -> Vec<Drawn> {
    let top = skin.iter().map(|p| p.y).fold(0.0, f64::max);
    let (low, high) = (0.4 * top, uniform(rng, 0.55..0.7) * top);
    let shift = DVec3::new(uniform(rng, -0.003..0.003), uniform(rng, -0.003..0.003), uniform(rng, -0.003..0.003));
    let dense = draw_points(skin, &model.skin.triangles, 12_000, rng).into_iter().filter(|d| d.place.y > low);
    let mut all: Vec<Drawn> = dense.collect();
    let coarse = even(skin, &model.skin.triangles, 1500, rng).into_iter().filter(|d| d.place.y < high);
    all.extend(coarse.map(|d| Drawn { place: d.place + shift, ..d }));
    all
}

/// The mean of what lies in each voxel of `side` metres.
pub fn voxels(model: &BodyModel, skin: &[DVec3], side: f64, rng: &mut ChaCha8Rng) -> Vec<Drawn> {
    let mut cells: BTreeMap<[i64; 3], Vec<Drawn>> = BTreeMap::new();
    for d in draw_points(skin, &model.skin.triangles, 60_000, rng) {
        cells.entry((d.place / side).floor().to_array().map(|x| x as i64)).or_default().push(d);
    }
    let mean = |all: &Vec<Drawn>| {
        let place = all.iter().map(|d| d.place).sum::<DVec3>() / all.len() as f64;
        let near =
            all.iter().min_by(|a, b| a.place.distance_squared(place).total_cmp(&b.place.distance_squared(place)));
        Drawn { place, vertex: near.map_or(0, |d| d.vertex) }
    };
    cells.values().map(mean).collect()
}

/// What depth cameras see, put together: points of the body and points of nothing, in the axes of the first camera but upright.
pub struct DepthScan {
    /// Of the body, with noise.
    pub body: Vec<Drawn>,
    /// Curtains, flying points and pixels without a depth, which end at the origin.
    pub strays: Vec<DVec3>,
}

/// About `count` points of the body from `views` cameras around it, and shares of flying points and of points at the origin.
pub fn depth_scan(
    model: &BodyModel,
    skin: &[DVec3],
    views: usize,
    [count, flying, zero]: [f64; 3],
    rng: &mut ChaCha8Rng,
) -> DepthScan {
    let (low, high) = skin.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let first = uniform(rng, -0.5..0.5);
    let cameras: Vec<Camera> = (0..views)
        .map(|view| {
            let azimuth = first + std::f64::consts::TAU * view as f64 / views as f64;
            Camera::around(0.5 * (low + high), azimuth, uniform(rng, DISTANCE))
        })
        .collect();
    let mut pixels: Vec<_> = cameras.iter().flat_map(|c| c.sees(skin, &model.skin.triangles, rng)).collect();
    pixels.shuffle(rng);
    pixels.truncate(count as usize);
    let origin = cameras[0].place;
    let mut scan = DepthScan { body: Vec::new(), strays: Vec::new() };
    for pixel in pixels {
        match pixel.vertex {
            Some(vertex) => scan.body.push(Drawn { place: pixel.place - origin, vertex }),
            None => scan.strays.push(pixel.place - origin),
        }
    }
    let around = DVec3::splat(0.25);
    for _ in 0..(flying * count) as usize {
        let share = DVec3::new(uniform(rng, 0.0..1.0), uniform(rng, 0.0..1.0), uniform(rng, 0.0..1.0));
        scan.strays.push(low - around + share * (high - low + 2.0 * around) - origin);
    }
    scan.strays.extend(std::iter::repeat_n(DVec3::ZERO, (zero * count) as usize));
    scan
}

fn unheard(_: f64) -> Result<(), Cancelled> {
    Ok(())
}
