//! A body together with what scans have besides it, or sampled as scans are, and the same body without.

use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::chance::{happens, normal_vector, uniform};
use super::cloud::Drawn;
use super::data::DataError;
use super::layout::Labelled;
use super::parts::PARTS;
use super::pose::Pose;
use super::poses::Stance;
use super::sampling::{depth_scan, even, thinned, two_passes, voxels};
use super::scan::normals;
use super::shape_mixture::Person;
use super::simplify::simplify;
use super::things::Thing;
use super::{BodyModel, Template};
use crate::shape::{Shape, cells};

/// The label of points that are not of the body.
pub const THING: u32 = PARTS.len() as u32;
/// Points of a body, mesh or cloud.
pub const POINTS: usize = 5000;
/// A point of a depth scan stands for the skin at most this far around (metres).
const SEEN: f64 = 0.025;
/// Plates grow together with what is this near (metres).
const FUSED: f64 = 0.02;
/// Largest share of a sitting body's spots inside another part.
const THROUGH: f64 = 0.006;

/// Kinds of scenes.
pub const CODES: [&str; 19] = [
    "floor-plate",
    "floor-fused",
    "floor-2m",
    "wall",
    "seat",
    "beside",
    "beside-small",
    "turntable",
    "thin-torso",
    "thin-legs",
    "passes",
    "voxel",
    "adaptive",
    "depth-1",
    "depth-2",
    "depth-4",
    "depth-strays",
    "spikes",
    "nan",
];

/// A scene: what there is of it.
pub struct Scene {
    /// As a mesh.
    pub mesh: Option<Labelled>,
    /// As a cloud.
    pub cloud: Option<Labelled>,
    /// The rows of a file with rows that are no numbers, and where the points of the cloud stand in it.
    pub rows: Option<(Vec<DVec3>, Vec<u32>)>,
    /// The body alone, as an even mesh.
    pub clean: Labelled,
}

impl BodyModel {
    /// The scene of a kind, one of [`CODES`], and a seed.
    pub fn scene(&self, template: &Template, code: &str, seed: u64) -> Result<Scene, DataError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let rng = &mut rng;
        let skin = match code {
            "seat" => self.sitting(template, rng)?,
            "floor-plate" | "floor-fused" | "turntable" => self.gentle_body(template, rng)?.1,
            _ => self.some_body(template, rng)?.1,
        };
        let clean = self.bare(&skin, POINTS, rng);
        let mut scene = Scene { mesh: None, cloud: None, rows: None, clean };
        let spacing = uniform(rng, 0.02..0.04);
        let thing = match code {
            "floor-plate" | "floor-fused" => Some(Thing::plate(feet(self, &skin), 0.7, spacing)),
            "floor-2m" => Some(Thing::plate(feet(self, &skin), 2.0, spacing)),
            "wall" => Some(wall(&skin, 0.05, spacing)),
            "seat" => {
                let size = DVec3::new(uniform(rng, 0.4..0.5), uniform(rng, 0.4..0.5), uniform(rng, 0.4..0.5));
                seat(self, &skin).map(|top| Thing::block(top, DVec3::new(size.x, size.y.min(top.y), size.z), spacing))
            }
            "turntable" => Some(Thing::disc(feet(self, &skin), uniform(rng, 0.4..0.55), 0.04, spacing)),
            "beside" | "beside-small" => {
                let scale = if code == "beside" { 1.0 } else { uniform(rng, 0.45..0.65) };
                Some(self.neighbour(template, &skin, scale, rng)?)
            }
            _ => None,
        };
        match (code, thing) {
            ("floor-fused", Some(thing)) => scene.mesh = Some(fused(&scene.clean, &thing)),
            (_, Some(thing)) => {
                scene.mesh = Some(beside(&scene.clean, &thing));
                let body = even(&skin, &self.skin.triangles, POINTS, rng);
                let count = (POINTS as f64 * thing.area() / area(&skin, &self.skin.triangles)) as usize;
                let strays =
                    even(&thing.points, &thing.triangles, count.max(50), rng).iter().map(|d| d.place).collect();
                scene.cloud = Some(self.cloud(&skin, &body, strays, None));
            }
            ("spikes", _) => scene.mesh = Some(spiked(&scene.clean, rng)),
            ("adaptive", _) => scene.mesh = Some(self.adaptive(&skin, rng)),
            ("depth-1" | "depth-2" | "depth-4" | "depth-strays", _) => {
                let views = match code {
                    "depth-1" => 1,
                    "depth-2" => 2,
                    "depth-4" => 4,
                    _ => 3,
                };
                let shares = if code == "depth-strays" { [0.05, 0.02] } else { [0.0, 0.0] };
                let scan = depth_scan(self, &skin, views, [1.6 * POINTS as f64, shares[0], shares[1]], rng);
                scene.cloud = Some(self.cloud(&skin, &scan.body, scan.strays, Some(SEEN)));
            }
            _ => {
                let body = match code {
                    "thin-torso" => thinned(self, &skin, &[1], uniform(rng, 4.0..10.0), rng),
                    "thin-legs" => thinned(self, &skin, &[8, 9, 10, 11, 12, 13], uniform(rng, 4.0..10.0), rng),
                    "passes" => two_passes(self, &skin, rng),
                    "voxel" => voxels(self, &skin, 0.015, rng),
                    _ => even(&skin, &self.skin.triangles, POINTS, rng),
                };
                scene.cloud = Some(self.cloud(&skin, &body, Vec::new(), None));
            }
        }
        if code == "nan" {
            scene.rows = scene.cloud.as_ref().map(|cloud| with_gaps(&cloud.points, 0.03, rng));
        }
        Ok(scene)
    }

    /// A cloud of points of the body and others; a point stands for the skin around it, up to `reach`.
    fn cloud(&self, skin: &[DVec3], body: &[Drawn], strays: Vec<DVec3>, reach: Option<f64>) -> Labelled {
        let spots: Vec<[f64; 3]> = skin.iter().map(DVec3::to_array).collect();
        let whole = Shape::already_valid(spots, self.skin.triangles.clone(), None);
        let samples: Vec<u32> = body.iter().map(|d| d.vertex).collect();
        let near = |(v, point): (usize, u32)| {
            let apart = skin[v].distance(skin[samples[point as usize] as usize]);
            reach.is_none_or(|reach| apart < reach).then_some(point)
        };
        let labels = samples.iter().map(|&v| self.labels[v as usize]).chain(strays.iter().map(|_| THING));
        Labelled {
            labels: labels.collect(),
            seen: cells(&whole, &samples).into_iter().enumerate().map(near).collect(),
            points: body.iter().map(|d| d.place).chain(strays).collect(),
            triangles: Vec::new(),
        }
    }

    /// A mesh with large triangles where the body is flat and small ones where it is not.
    fn adaptive(&self, skin: &[DVec3], rng: &mut ChaCha8Rng) -> Labelled {
        let outwards = normals(skin, &self.skin.triangles);
        let mut curvature = vec![0.0f64; skin.len()];
        for t in &self.skin.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a as usize, b as usize)) {
                let bend = outwards[a].distance(outwards[b]) / skin[a].distance(skin[b]).max(1e-6);
                curvature[a] = curvature[a].max(bend);
                curvature[b] = curvature[b].max(bend);
            }
        }
        let flat = uniform(rng, 2.5..5.0);
        let size: Vec<f64> = curvature.iter().map(|k| (10.0 / k.max(1e-3)).clamp(0.25, flat)).collect();
        let (vertices, triangles) = simplify(skin, &self.skin.triangles, &size, 3500);
        let spots: Vec<[f64; 3]> = skin.iter().map(DVec3::to_array).collect();
        let whole = Shape::already_valid(spots, self.skin.triangles.clone(), None);
        Labelled {
            points: vertices.iter().map(|&v| skin[v as usize]).collect(),
            labels: vertices.iter().map(|&v| self.labels[v as usize]).collect(),
            triangles,
            seen: cells(&whole, &vertices).into_iter().map(Some).collect(),
        }
    }

    /// Another person, 5 to 40 cm to the left of a body.
    fn neighbour(
        &self,
        template: &Template,
        skin: &[DVec3],
        scale: f64,
        rng: &mut ChaCha8Rng,
    ) -> Result<Thing, DataError> {
        let (_, other) = self.some_body(template, rng)?;
        let other: Vec<DVec3> = other.iter().map(|&p| scale * p).collect();
        let left = skin.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max);
        let right = other.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        let way = DVec3::new(left - right + uniform(rng, 0.05..0.4), 0.0, uniform(rng, -0.2..0.2));
        let moved: Vec<DVec3> = other.iter().map(|&p| p + way).collect();
        let mesh = self.bare(&moved, POINTS, rng);
        Ok(Thing { points: mesh.points, triangles: mesh.triangles })
    }

    /// The skin of a person who sits, high enough for a seat below.
    fn sitting(&self, template: &Template, rng: &mut ChaCha8Rng) -> Result<Vec<DVec3>, DataError> {
        loop {
            let rest = self.rest(&Person::random(rng))?;
            let mut pose = Pose::in_stance(Stance::Sit, rng);
            (pose.pelvis.turn, pose.spine.turn) = (0.2 * pose.pelvis.turn, 0.3 * pose.spine.turn);
            for leg in &mut pose.legs {
                (leg.raise, leg.knee, leg.ankle) = (uniform(rng, 80.0..92.0), uniform(rng, 65.0..100.0), None);
            }
            let skin = self.posed(&rest, &pose.turns(&rest.skeleton)).skin;
            let through = template.reach.contact(&template.pick(&skin), &template.triangles).through;
            if through <= THROUGH && seat(self, &skin).is_some_and(|top| (0.25..0.6).contains(&top.y)) {
                return Ok(skin);
            }
        }
    }
}

/// The middle of the feet, on the floor.
fn feet(model: &BodyModel, skin: &[DVec3]) -> DVec3 {
    let low = skin.iter().zip(&model.labels).filter(|(p, label)| p.y < 0.3 && [12, 13].contains(*label));
    let (sum, count) = low.fold((DVec3::ZERO, 0.0), |(sum, count), (p, _)| (sum + *p, count + 1.0));
    let middle = sum / f64::max(count, 1.0);
    DVec3::new(middle.x, 0.0, middle.z)
}

/// The middle of the top of a seat: as low as the lowest of trunk and thighs near the hips.
fn seat(model: &BodyModel, skin: &[DVec3]) -> Option<DVec3> {
    let near: Vec<DVec3> = (0..skin.len()).filter(|&v| [1, 8, 9].contains(&model.labels[v])).map(|v| skin[v]).collect();
    // The hips are over the origin.
    let below = near.iter().filter(|p| p.x.hypot(p.z) < 0.25);
    let low = below.map(|p| p.y).min_by(f64::total_cmp)?;
    Some(DVec3::new(0.0, low, 0.0))
}

/// Upright behind a body, wider and higher than it.
fn wall(skin: &[DVec3], gap: f64, spacing: f64) -> Thing {
    let (low, high) = skin.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let corner = DVec3::new(low.x - 0.2, 0.0, low.z - gap);
    Thing::rectangle(corner, (high.x - low.x + 0.4) * DVec3::X, (high.y + 0.2) * DVec3::Y, spacing)
}

/// A body and a thing that share nothing.
fn beside(body: &Labelled, thing: &Thing) -> Labelled {
    let mut all = body.clone();
    let first = all.points.len() as u32;
    all.points.extend(&thing.points);
    all.labels.extend(thing.points.iter().map(|_| THING));
    all.triangles.extend(thing.triangles.iter().map(|t| t.map(|v| v + first)));
    all
}

/// A body grown together with a thing where both are near.
fn fused(body: &Labelled, thing: &Thing) -> Labelled {
    let same = thing.fused(&body.points, FUSED);
    let mut all = body.clone();
    let mut at = Vec::with_capacity(thing.points.len());
    for (i, p) in (0..).zip(&thing.points) {
        at.push(same.get(&i).copied().unwrap_or(all.points.len() as u32));
        if !same.contains_key(&i) {
            all.points.push(*p);
            all.labels.push(THING);
        }
    }
    let triangles = thing.triangles.iter().map(|t| t.map(|v| at[v as usize]));
    all.triangles.extend(triangles.filter(|[a, b, c]| a != b && b != c && c != a));
    all
}

/// One in a hundred vertices far out, 2 to 40 cm: they are no points of the body any more.
fn spiked(body: &Labelled, rng: &mut ChaCha8Rng) -> Labelled {
    let mut all = body.clone();
    let outwards = normals(&body.points, &body.triangles);
    for (v, n) in outwards.into_iter().enumerate() {
        if happens(rng, 0.01) {
            all.points[v] += uniform(rng, 0.02..0.4) * (n + 0.2 * normal_vector(rng)).normalize_or(DVec3::X);
            all.labels[v] = THING;
        }
    }
    for seen in &mut all.seen {
        *seen = seen.filter(|&p| all.labels[p as usize] != THING);
    }
    all
}

/// Rows of a file with a share of rows that are no numbers, and the row of each point.
fn with_gaps(points: &[DVec3], share: f64, rng: &mut ChaCha8Rng) -> (Vec<DVec3>, Vec<u32>) {
    let (mut rows, mut row_of) = (Vec::new(), Vec::new());
    for p in points {
        while happens(rng, share) {
            rows.push(DVec3::NAN);
        }
        row_of.push(rows.len() as u32);
        rows.push(*p);
    }
    (rows, row_of)
}

fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    Thing { points: points.to_vec(), triangles: triangles.to_vec() }.area()
}
