//! A posed body as a scanner might see it: a mesh or a cloud of its own sampling, noise, clothes, missing pieces, mirrored, turned and scaled.

use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::chance::{happens, normal_vector, pick, pick_by, rotation, uniform};
use super::cloud::{Drawn, draw_points};
use super::data::DataError;
use super::parts::mirrored_part;
use super::pieces::{area, piece, pieces};
use super::{BodyModel, Template};
use crate::progress::Cancelled;
use crate::shape::{Shape, Simplified, draw_together, farthest_points};

/// What a scan may have. Shares are probabilities in [0, 1]; 0 switches a thing off.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanOptions {
    /// Points of every scan.
    pub points: usize,
    /// Share of meshes; the others are clouds.
    pub meshes: f64,
    /// Share with noise.
    pub noisy: f64,
    /// Share with clothes.
    pub dressed: f64,
    /// Share with a piece missing.
    pub incomplete: f64,
    /// Share of pieces, some of which lack most of the body.
    pub pieces: f64,
    /// Share of mirrored bodies; left and right labels are exchanged, so that the labels are right for what is there.
    pub mirrored: f64,
    /// Whether each scan is turned any way and scaled by 0.8 … 1.25.
    pub moved: bool,
}

impl Default for ScanOptions {
    fn default() -> Self {
        Self {
            points: 1800,
            meshes: 0.4,
            noisy: 0.33,
            dressed: 0.1,
            incomplete: 0.1,
            pieces: 0.0,
            mirrored: 0.5,
            moved: true,
        }
    }
}

/// What training sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// Points, triangles (none on a cloud) and part labels, indices into [`super::parts::PARTS`].
    pub shape: Shape,
}

/// What is known of a scan beside its labels. Training takes from it how much of the body is there, and a place for each point where a teacher gave one to the surface behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Vertex of the fine skin nearest to each point, as the body stands there: on a mirrored body the vertex of the other side.
    pub skin: Vec<u32>,
    /// The share of the body's area that is there.
    pub share: f64,
}

/// Largest standard deviation of noise, in √area.
const NOISE: f64 = 0.005;
/// Largest share of the area that is missing.
const MISSING: f64 = 0.25;

impl BodyModel {
    /// The scan of a seed. The same seed is always the same scan, byte for byte. Training uses seeds below 800 000; held-out sets use those from there on.
    pub fn scan(&self, template: &Template, seed: u64, options: &ScanOptions) -> Result<(Scan, Truth), DataError> {
        self.scan_of_seed(&self.random_body(template, seed)?.skin, seed, options)
    }

    /// The scan that is drawn from a seed, of a body given by the vertices of its fine skin (metres).
    pub fn scan_of_seed(&self, skin: &[DVec3], seed: u64, options: &ScanOptions) -> Result<(Scan, Truth), DataError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(1);
        self.scan_of(skin, options, &mut rng)
    }

    /// One more scan of a body given by the vertices of its fine skin (metres).
    pub fn scan_of(
        &self,
        skin: &[DVec3],
        options: &ScanOptions,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Scan, Truth), DataError> {
        let side = area(skin, &self.skin.triangles).sqrt();
        let mut skin = skin.to_vec();
        if happens(rng, options.dressed) {
            self.dress(&mut skin, rng);
        }
        let cut = if options.pieces > 0.0 && happens(rng, options.pieces) {
            Some(piece(&skin, &self.skin.triangles, rng).1)
        } else if happens(rng, options.incomplete) {
            without_piece(&skin, &self.skin.triangles, rng)
        } else {
            None
        };
        let triangles = cut.as_ref().unwrap_or(&self.skin.triangles);
        let share = area(&skin, triangles) / area(&skin, &self.skin.triangles);
        // As dense as the whole body would be, or with as many points, or between.
        let points = if options.pieces > 0.0 { uniform(rng, share..1.0) } else { 1.0 } * options.points as f64;
        let (mut points, mut faces, mut vertices) = if happens(rng, options.meshes) {
            mesh(&skin, triangles, points as usize, rng)
        } else {
            cloud(&skin, triangles, points as usize, rng)
        };
        if happens(rng, options.noisy) {
            let sigma = side * uniform(rng, 0.0..NOISE);
            points.iter_mut().for_each(|p| *p += sigma * normal_vector(rng));
        }
        let mut labels: Vec<u32> = vertices.iter().map(|&v| self.labels[v as usize]).collect();
        if happens(rng, options.mirrored) {
            points.iter_mut().for_each(|p| p.x = -p.x);
            faces.iter_mut().for_each(|f| f.swap(1, 2));
            labels.iter_mut().for_each(|l| *l = mirrored_part(*l));
            vertices.iter_mut().for_each(|v| *v = self.mirror[*v as usize]);
        }
        if options.moved {
            let (turn, scale) = (rotation(rng), uniform(rng, 0.8f64.ln()..1.25f64.ln()).exp());
            points.iter_mut().for_each(|p| *p = scale * (turn * *p));
        }
        let shape = Shape::new(points.iter().map(DVec3::to_array).collect(), faces, Some(labels))?;
        Ok((Scan { shape }, Truth { skin: vertices, share }))
    }

    /// A mesh of `points` evenly spread vertices of a body's fine skin (metres) with part labels, and for each vertex of that skin the one that stands for it.
    pub fn clean_scan(&self, skin: &[DVec3], points: usize) -> Result<(Shape, Vec<u32>), DataError> {
        let mesh = even_mesh(skin, &self.skin.triangles, points, &mut ChaCha8Rng::seed_from_u64(0));
        let labels = mesh.vertices.iter().map(|&v| self.labels[v as usize]).collect();
        let points = mesh.vertices.iter().map(|&v| skin[v as usize].to_array()).collect();
        Ok((Shape::new(points, mesh.faces, Some(labels))?, mesh.cell))
    }

    /// Moves the skin outwards where something loose is worn: up to 3 cm, smoothly, in folds a hand wide.
    fn dress(&self, skin: &mut [DVec3], rng: &mut ChaCha8Rng) {
        let worn = pick::<&[u32]>(
            rng,
            &[&[1, 2, 3], &[1, 2, 3, 4, 5], &[8, 9, 10, 11], &[8, 9], &[1, 8, 9], &[1, 2, 3, 4, 5, 8, 9]],
        );
        let mut thickness: Vec<f64> = self.labels.iter().map(|l| f64::from(u8::from(worn.contains(l)))).collect();
        for _ in 0..uniform(rng, 3.0..20.0) as usize {
            smooth(&mut thickness, &self.skin.triangles);
        }
        let most = uniform(rng, 0.004..0.03);
        let waves: Vec<(DVec3, f64)> =
            (0..4).map(|_| (normal_vector(rng) * uniform(rng, 10.0..25.0), uniform(rng, 0.0..6.3))).collect();
        let normals = normals(skin, &self.skin.triangles);
        for ((p, n), t) in skin.iter_mut().zip(normals).zip(thickness) {
            let folds: f64 = waves.iter().map(|(k, phase)| (k.dot(*p) + phase).sin()).sum();
            *p += most * t * (1.0 + 0.15 * folds) * n;
        }
    }
}

/// Points, triangles, and the skin vertex behind each point.
type Sampled = (Vec<DVec3>, Vec<[u32; 3]>, Vec<u32>);

/// A mesh on `count` of the skin's vertices, chosen anew each time; connected as their cells on the skin are.
fn mesh(skin: &[DVec3], triangles: &[[u32; 3]], count: usize, rng: &mut ChaCha8Rng) -> Sampled {
    let mut present = vec![false; skin.len()];
    triangles.iter().flatten().for_each(|&v| present[v as usize] = true);
    let kept = uniform(rng, 0.2..0.9);
    let density = if happens(rng, 0.3) { Density::random(skin, rng) } else { Density::Even };
    let allowed: Vec<u32> = (0..skin.len() as u32)
        .filter(|&v| present[v as usize] && happens(rng, kept * density.at(skin[v as usize]).powi(2)))
        .collect();
    // Distances stretched along some axis make triangles long across it.
    let stretch = if happens(rng, 0.25) { uniform(rng, 0.0..1.2) } else { 0.0 };
    let axis = normal_vector(rng).normalize_or(DVec3::X);
    let seen = |p: &DVec3| (*p + stretch * axis.dot(*p) * axis).to_array();
    let seen: Vec<[f64; 3]> = skin.iter().map(seen).collect();
    let simple = connected(seen, triangles, &allowed, count);
    (simple.vertices.iter().map(|&v| skin[v as usize]).collect(), simple.faces, simple.vertices)
}

/// A mesh on `count` evenly spread vertices of the skin, out of a random half of them, and for each vertex of the skin the one that stands for it.
pub(super) fn even_mesh(skin: &[DVec3], triangles: &[[u32; 3]], count: usize, rng: &mut ChaCha8Rng) -> Simplified {
    let allowed: Vec<u32> = (0..skin.len() as u32).filter(|_| happens(rng, 0.5)).collect();
    connected(skin.iter().map(DVec3::to_array).collect(), triangles, &allowed, count)
}

fn connected(places: Vec<[f64; 3]>, triangles: &[[u32; 3]], allowed: &[u32], count: usize) -> Simplified {
    let shape = Shape::already_valid(places, triangles.to_vec(), None);
    let Ok(simple) = draw_together(&shape, allowed, count, &mut unheard) else { unreachable!("nobody cancels") };
    simple
}

/// A cloud of `count` points of the surface.
fn cloud(skin: &[DVec3], triangles: &[[u32; 3]], count: usize, rng: &mut ChaCha8Rng) -> Sampled {
    let (density, pool) =
        pick_by(rng, &[(0.55, (false, 5.0)), (0.25, (false, 1.0)), (0.12, (true, 1.0)), (0.08, (true, 1.6))]);
    let wanted = (pool * count as f64) as usize;
    let drawn: Vec<Drawn> = if density {
        let density = Density::random(skin, rng);
        // On average a draw is kept with the mean of the density, about a half.
        let mut kept: Vec<Drawn> = Vec::with_capacity(wanted);
        while kept.len() < wanted {
            kept.extend(
                draw_points(skin, triangles, wanted, rng).into_iter().filter(|d| happens(rng, density.at(d.place))),
            );
        }
        kept.truncate(wanted);
        kept
    } else {
        draw_points(skin, triangles, wanted, rng)
    };
    let places: Vec<[f64; 3]> = drawn.iter().map(|d| d.place.to_array()).collect();
    let all: Vec<u32> = (0..places.len() as u32).collect();
    let chosen = if wanted > count { farthest_points(&places, &all, count, &mut unheard).unwrap_or(all) } else { all };
    let point = |&i: &u32| drawn[i as usize].place;
    (chosen.iter().map(point).collect(), Vec::new(), chosen.iter().map(|&i| drawn[i as usize].vertex).collect())
}

fn unheard(_: f64) -> Result<(), Cancelled> {
    Ok(())
}

/// How dense points lie, in (0, 1].
enum Density {
    Even,
    /// Falling off away from a plane, as with the distance from a scanner.
    Sided {
        direction: DVec3,
        low: f64,
        high: f64,
        least: f64,
    },
    /// High near some places.
    Patches {
        places: Vec<(DVec3, f64)>,
        least: f64,
    },
}

impl Density {
    fn random(skin: &[DVec3], rng: &mut ChaCha8Rng) -> Self {
        let least = uniform(rng, 0.15..0.5);
        if happens(rng, 0.5) {
            let direction = normal_vector(rng).normalize_or(DVec3::X);
            let along = |p: &DVec3| p.dot(direction);
            let (low, high) =
                skin.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(along(p)), h.max(along(p))));
            Self::Sided { direction, low, high, least }
        } else {
            Self::Patches { places: (0..4).map(|_| (*pick(rng, skin), uniform(rng, 0.1..0.4))).collect(), least }
        }
    }

    fn at(&self, p: DVec3) -> f64 {
        match self {
            Self::Even => 1.0,
            Self::Sided { direction, low, high, least } => {
                least
                    + (1.0 - least) * ((p.dot(*direction) - low) / (high - low).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
            }
            Self::Patches { places, least } => {
                let near = places.iter().map(|(c, r)| (-p.distance_squared(*c) / (r * r)).exp()).fold(0.0, f64::max);
                least + (1.0 - least) * near
            }
        }
    }
}

/// The largest connected rest of the surface after a ball or a half-space took away up to [`MISSING`] of its area; `None` where what falls off with it would be more.
fn without_piece(skin: &[DVec3], triangles: &[[u32; 3]], rng: &mut ChaCha8Rng) -> Option<Vec<[u32; 3]>> {
    let share = uniform(rng, 0.03..MISSING);
    let centre = |t: &[u32; 3]| t.iter().map(|&v| skin[v as usize]).sum::<DVec3>() / 3.0;
    let order: Vec<f64> = if happens(rng, 0.5) {
        let from = *pick(rng, skin);
        triangles.iter().map(|t| centre(t).distance(from)).collect()
    } else {
        let direction = normal_vector(rng).normalize_or(DVec3::X);
        triangles.iter().map(|t| centre(t).dot(direction)).collect()
    };
    let mut first: Vec<usize> = (0..triangles.len()).collect();
    first.sort_by(|&a, &b| order[a].total_cmp(&order[b]));
    let total = area(skin, triangles);
    let mut gone = 0.0;
    let cut = first.iter().position(|&t| {
        gone += area(skin, &triangles[t..=t]);
        gone > share * total
    })?;
    let mut rest: Vec<usize> = first[cut..].to_vec();
    rest.sort_unstable();
    let rest = largest_piece(skin, rest.into_iter().map(|t| triangles[t]).collect());
    (area(skin, &rest) > (1.0 - MISSING) * total).then_some(rest)
}

/// The triangles of the piece with the largest area.
fn largest_piece(skin: &[DVec3], triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let pieces = pieces(skin.len(), &triangles).into_values();
    pieces.max_by(|a, b| area(skin, a).total_cmp(&area(skin, b))).unwrap_or_default()
}

/// Each value the mean of itself and of those in the triangles around.
fn smooth(values: &mut [f64], triangles: &[[u32; 3]]) {
    let mut sums: Vec<(f64, f64)> = values.iter().map(|&x| (x, 1.0)).collect();
    for t in triangles {
        let sum: f64 = t.iter().map(|&v| values[v as usize]).sum();
        t.iter().for_each(|&v| sums[v as usize] = (sums[v as usize].0 + sum, sums[v as usize].1 + 3.0));
    }
    values.iter_mut().zip(sums).for_each(|(x, (sum, count))| *x = sum / count);
}

/// Outward unit normals, weighted by area.
pub(super) fn normals(skin: &[DVec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; skin.len()];
    for t in triangles {
        let [p, q, r] = t.map(|v| skin[v as usize]);
        let normal = (q - p).cross(r - p);
        t.iter().for_each(|&v| normals[v as usize] += normal);
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::manifold::{is_closed_manifold, tests::torus};

    #[test]
    fn every_mesh_of_one_surface_is_another_one_and_closed() {
        let (skin, triangles) = torus();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut drawn = || mesh(&skin, &triangles, 120, &mut rng);
        let (a, b) = (drawn(), drawn());
        assert_ne!(a.2, b.2);
        for (points, faces, vertices) in [a, b] {
            assert!(points.iter().zip(&vertices).all(|(p, &v)| *p == skin[v as usize]));
            assert!(points.len() == 120 && is_closed_manifold(120, &faces), "{}", faces.len());
        }
    }

    #[test]
    fn clouds_keep_the_vertex_they_lie_next_to() {
        let (skin, triangles) = torus();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..12 {
            let (points, faces, vertices) = cloud(&skin, &triangles, 300, &mut rng);
            assert!(points.len() == 300 && faces.is_empty());
            // The longest edge is half a unit.
            assert!(points.iter().zip(&vertices).all(|(p, &v)| p.distance(skin[v as usize]) < 0.5));
        }
    }

    #[test]
    fn a_missing_piece_leaves_one_piece_of_most_of_the_area() {
        let (skin, triangles) = torus();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let whole = area(&skin, &triangles);
        let rests: Vec<_> = (0..20).filter_map(|_| without_piece(&skin, &triangles, &mut rng)).collect();
        assert!(rests.len() > 10);
        for rest in rests {
            let share = area(&skin, &rest) / whole;
            assert!((0.75..0.98).contains(&share), "{share}");
            assert_eq!(largest_piece(&skin, rest.clone()), rest);
        }
    }

    #[test]
    fn uneven_density_never_reaches_zero() {
        let (skin, _) = torus();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for _ in 0..20 {
            let density = Density::random(&skin, &mut rng);
            assert!(skin.iter().all(|p| (0.1..=1.0).contains(&density.at(*p))));
        }
    }
}
