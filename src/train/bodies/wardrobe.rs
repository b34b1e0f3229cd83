//! Clothes, hair and shoes as heights over the skin: how far along its limb each vertex lies, and which of them a garment covers.

use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use super::chance::{normal_vector, uniform};
use super::data::DataError;
use super::parts::PARTS;
use super::scan::normals;
use super::shape_mixture::Person;
use super::shell::{Cut, Shell};
use super::{BodyModel, METRES};

/// Where each vertex of the skin lies on its limb.
pub struct Measures {
    /// On arms 0 at the shoulder, 1 at the elbow, 2 at the wrist; on legs the same from hip to ankle; on the trunk 0 at the hips and 1 at the base of
    /// the neck; on the head 0 there and 1 at the crown.
    pub along: Vec<f64>,
    /// Places before any pose, in metres, y up, facing +z.
    pub rest: Vec<DVec3>,
}

/// A thing worn: which vertices it covers, and how high above them it lies.
pub struct Garment<'a> {
    /// Its name.
    pub name: &'a str,
    /// Metres above the skin.
    pub height: f64,
    /// Vertices of the shell.
    pub count: usize,
    /// Rounds of smoothing: how little of the body shows through.
    pub ease: usize,
}

impl Measures {
    /// Of a person.
    pub fn of(model: &BodyModel, person: &Person) -> Result<Self, DataError> {
        let rest = model.rest(person)?;
        let places = model.skin.positions(&rest.shape);
        let joint = |name: &str| rest.skeleton.find(name).map_or(DVec3::ZERO, |b| rest.skeleton.bones[b].head);
        let (hips, neck) = (joint("pelvis"), joint("neck_01"));
        let crown = places.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        let between = |p: DVec3, from: DVec3, to: DVec3| {
            ((p - from).dot(to - from) / from.distance_squared(to).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
        };
        let along = places.iter().zip(&model.labels).map(|(&p, &label)| {
            let name = PARTS[label as usize];
            let side = if name.starts_with("right") { "r" } else { "l" };
            let bone = |name: &str| joint(&format!("{name}_{side}"));
            match name.trim_start_matches("left ").trim_start_matches("right ") {
                "head" => (p.y - neck.y) / (crown - neck.y),
                "torso" => (p.y - hips.y) / (neck.y - hips.y),
                "upper arm" => between(p, bone("upperarm"), bone("lowerarm")),
                "forearm" => 1.0 + between(p, bone("lowerarm"), bone("hand")),
                "thigh" => between(p, bone("thigh"), bone("calf")),
                "shank" => 1.0 + between(p, bone("calf"), bone("foot")),
                _ => 2.0,
            }
        });
        let along = along.collect();
        Ok(Self { along, rest: places.iter().map(|&p| METRES * p).collect() })
    }

    /// Which vertices `covered` says yes to, given part name without side, place on the limb, and vertex.
    pub fn choose(&self, labels: &[u32], covered: impl Fn(&str, f64, usize) -> bool) -> Vec<bool> {
        let part = |label: u32| PARTS[label as usize].trim_start_matches("left ").trim_start_matches("right ");
        labels.iter().enumerate().map(|(v, &label)| covered(part(label), self.along[v], v)).collect()
    }

    /// Vertices that hair grows on: the back and top of the head; with `long` hair also the neck and the back below.
    pub fn hair(&self, labels: &[u32], long: f64) -> Vec<bool> {
        let head: Vec<DVec3> =
            (0..labels.len()).filter(|&v| labels[v] == 0 && self.along[v] > 0.35).map(|v| self.rest[v]).collect();
        let (low, high) = head.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        let (centre, size) = (0.5 * (low + high), (high - low).max(DVec3::splat(0.05)));
        self.choose(labels, |part, along, v| {
            let p = (self.rest[v] - centre) / size;
            match part {
                "head" => 0.8 * p.y - 0.9 * p.z > 0.12 && p.y > -0.35 || long > 0.0 && p.y < 0.1 && p.z < -0.08,
                "torso" => along > 1.0 - long && p.z < -0.15 && self.rest[v].x.abs() < 0.1,
                _ => false,
            }
        })
    }
}

impl Garment<'_> {
    /// The garment over the vertices that are `covered` on a posed skin (metres).
    pub fn shell(&self, model: &BodyModel, skin: &[DVec3], covered: &[bool], rng: &mut ChaCha8Rng) -> Shell {
        let cut = Cut::of(&model.skin.triangles, |t| t.iter().all(|&v| covered[v as usize]));
        let (places, outwards) = (cut.pick(skin), cut.pick(&normals(skin, &model.skin.triangles)));
        let waves: Vec<(DVec3, f64)> =
            (0..4).map(|_| (normal_vector(rng) * uniform(rng, 10.0..25.0), uniform(rng, 0.0..6.3))).collect();
        let height = |p: &DVec3| {
            let folds: f64 = waves.iter().map(|(k, phase)| (k.dot(*p) + phase).sin()).sum();
            self.height * (1.0 + 0.12 * folds.clamp(-2.0, 2.0))
        };
        let heights: Vec<f64> = places.iter().map(height).collect();
        let mut cloth: Vec<DVec3> =
            places.iter().zip(&outwards).zip(&heights).map(|((&p, &n), h)| p + *h * n).collect();
        cut.smooth(&mut cloth, self.ease);
        // Smoothing draws a surface together: no place may come nearer to the skin than half of what was wanted.
        for (((cloth, p), n), h) in cloth.iter_mut().zip(&places).zip(&outwards).zip(&heights) {
            let lacks = 0.7 * h - (*cloth - *p).dot(*n);
            *cloth += lacks.max(0.0) * *n;
        }
        cut.shell(self.name, &cloth, &heights, self.count, rng)
    }
}
