//! The sample scans that come with the page: two people, five poses, and three pieces.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::json;

use super::camera::Camera;
use super::cloud::{farthest_points, nearest, uniform_points};
use super::data::DataError;
use super::parts::PARTS;
use super::pose::{Arm, Bend, Leg, Pose};
use super::shape_mixture::Person;
use super::write::write_ply;
use super::{BodyModel, Template};

/// Points of every sample, mesh or cloud.
pub const POINTS: usize = 5000;
/// Pool the cloud's points are chosen from: random by area, then thinned to [`POINTS`].
const POOL: usize = 2 * POINTS;
const SEED: u64 = 20;
const CREDITS: &str = "Made with this project's body generator from the MakeHuman base mesh, targets and rig (CC0).";

/// Why the samples could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    /// The data folder is not usable.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A file cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Writes the scans, the cloud's ground truth and `samples.json` into `out`; returns the names of the files.
pub fn write_samples(model: &BodyModel, out: &Path) -> Result<Vec<String>, SampleError> {
    let template = model.template(POINTS)?;
    let mut files = Vec::new();
    let mut save = |name: &str, bytes: Vec<u8>| {
        let path = out.join(name);
        fs::write(&path, bytes).map_err(|source| SampleError::Write { path, source })?;
        files.push(name.to_owned());
        Ok::<_, SampleError>(())
    };
    let mut entries = Vec::new();
    for sample in &MESHES {
        let points = template.pick(&sample.body(model)?);
        let file = format!("{}.ply", sample.stem());
        save(&file, ply(&points, Some((&template.triangles, &template.labels))))?;
        entries.push(sample.entry(&file, "mesh", points.len(), template.triangles.len()));
    }

    let body = CLOUD.body(model)?;
    let pool = uniform_points(&body, &model.skin.triangles, POOL, &mut ChaCha8Rng::seed_from_u64(SEED));
    let points: Vec<_> = farthest_points(&pool, POINTS).into_iter().map(|i| pool[i]).collect();
    let (file, truth) = (format!("{}-cloud.ply", CLOUD.stem()), format!("{}-cloud.truth.json", CLOUD.stem()));
    save(&file, ply(&points, None))?;
    let nearest = json!({ "cloud": file, "nearestVertex": nearest(&points, &template.pick(&body)) });
    save(&truth, format!("{nearest}\n").into_bytes())?;
    let mut entry = CLOUD.entry(&file, "cloud", points.len(), 0);
    entry["truth"] = json!(truth);
    entries.push(entry);

    for piece in &PIECES {
        let Cut { points, triangles, vertices } = piece.cut(&template.pick(&piece.of.body(model)?), &template);
        let labels: Vec<u32> = vertices.iter().map(|&v| template.labels[v as usize]).collect();
        let (file, truth) = (format!("{}.ply", piece.name), format!("{}.truth.json", piece.name));
        let whole = format!("{}.ply", piece.of.stem());
        save(&file, ply(&points, (!triangles.is_empty()).then_some((&triangles, &labels))))?;
        save(&truth, format!("{}\n", json!({ "piece": file, "of": whole, "vertices": vertices })).into_bytes())?;
        let mut entry = piece.of.entry(&file, "piece", points.len(), triangles.len());
        (entry["title"], entry["of"], entry["truth"]) = (json!(piece.title), json!(whole), json!(truth));
        entries.push(entry);
    }

    let manifest = json!({ "license": "CC0-1.0", "credits": CREDITS, "unit": "metre", "up": "y", "parts": PARTS, "samples": entries });
    save("samples.json", format!("{manifest:#}\n").into_bytes())?;
    Ok(files)
}

/// Who does what: names as in the manifest, and how to make them.
struct Sample {
    person: (&'static str, fn() -> Person),
    pose: (&'static str, fn() -> Pose),
    title: &'static str,
}

static MESHES: [Sample; 4] = [
    Sample { person: ("woman", woman), pose: ("standing", standing), title: "Woman, standing" },
    Sample { person: ("woman", woman), pose: ("striding", striding), title: "Woman, striding" },
    Sample { person: ("man", man), pose: ("standing", standing), title: "Man, standing" },
    Sample { person: ("man", man), pose: ("lunging", lunging), title: "Man, knees bent, arms forward" },
];
const CLOUD: Sample =
    Sample { person: ("woman", woman), pose: ("greeting", greeting), title: "Woman, greeting (points only)" };

/// What is left of a sample, or seen of it.
struct Piece {
    of: &'static Sample,
    name: &'static str,
    title: &'static str,
    kind: PieceKind,
}

#[derive(Clone, Copy)]
enum PieceKind {
    /// What is above this share of the height.
    Above(f64),
    /// The parts before this one.
    Before(u32),
    /// Points that a depth camera sees that stands so many radians from the front.
    SeenFrom(f64),
}

static PIECES: [Piece; 3] = [
    Piece { of: &MESHES[1], name: "woman-bust", title: "Woman, bust", kind: PieceKind::Above(0.7) },
    Piece { of: &MESHES[2], name: "man-without-legs", title: "Man, without legs", kind: PieceKind::Before(8) },
    Piece {
        of: &MESHES[3],
        name: "man-one-view-cloud",
        title: "Man, one view of a depth camera",
        kind: PieceKind::SeenFrom(0.3),
    },
];
/// Metres to the depth camera.
const OFF: f64 = 2.5;

/// A piece, and which vertices of the whole its points are or lie next to.
struct Cut {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    vertices: Vec<u32>,
}

impl Piece {
    fn cut(&self, whole: &[DVec3], template: &Template) -> Cut {
        let height = whole.iter().map(|p| p.y).fold(0.0, f64::max);
        let kept = |v: u32| match self.kind {
            PieceKind::Above(share) => whole[v as usize].y > share * height,
            PieceKind::Before(part) => template.labels[v as usize] < part,
            PieceKind::SeenFrom(_) => true,
        };
        if let PieceKind::SeenFrom(azimuth) = self.kind {
            let camera = Camera::around(DVec3::Y * 0.5 * height, azimuth, OFF);
            let seen = camera.sees(whole, &template.triangles, &mut ChaCha8Rng::seed_from_u64(SEED));
            let (points, vertices): (Vec<_>, Vec<_>) =
                seen.iter().filter_map(|pixel| pixel.vertex.map(|v| (pixel.place, v))).unzip();
            let thinned = farthest_points(&points, POINTS).into_iter();
            let (points, vertices) = thinned.map(|i| (points[i], vertices[i])).unzip();
            return Cut { points, triangles: Vec::new(), vertices };
        }
        let mut triangles: Vec<[u32; 3]> =
            template.triangles.iter().filter(|t| t.iter().all(|&v| kept(v))).copied().collect();
        let vertices: BTreeSet<u32> = triangles.as_flattened().iter().copied().collect();
        let vertices: Vec<u32> = vertices.into_iter().collect();
        let row = |v: u32| vertices.binary_search(&v).expect("a vertex of the piece") as u32;
        triangles.as_flattened_mut().iter_mut().for_each(|v| *v = row(*v));
        Cut { points: vertices.iter().map(|&v| whole[v as usize]).collect(), triangles, vertices }
    }
}

impl Sample {
    fn stem(&self) -> String {
        format!("{}-{}", self.person.0, self.pose.0)
    }

    /// Vertices of the fine skin in metres.
    fn body(&self, model: &BodyModel) -> Result<Vec<DVec3>, DataError> {
        model.body(&self.person.1(), &self.pose.1())
    }

    /// The manifest's entry.
    fn entry(&self, file: &str, kind: &str, points: usize, faces: usize) -> serde_json::Value {
        json!({ "file": file, "title": self.title, "person": self.person.0, "pose": self.pose.0, "kind": kind,
            "points": points, "faces": faces, "license": "CC0-1.0", "credits": CREDITS })
    }
}

/// A PLY file in memory: a mesh with labels, or bare points.
fn ply(points: &[DVec3], mesh: Option<(&[[u32; 3]], &[u32])>) -> Vec<u8> {
    let mut comments = vec![format!("{CREDITS} License: CC0 1.0."), "y up, metres".to_owned()];
    let (triangles, labels) = mesh.map_or((&[][..], None), |(triangles, labels)| (triangles, Some(labels)));
    if mesh.is_some() {
        comments.push(format!("labels: {}", PARTS.join(", ")));
    }
    let mut bytes = Vec::new();
    write_ply(&mut bytes, points, triangles, labels, &comments).expect("writing to memory does not fail");
    bytes
}

fn woman() -> Person {
    Person {
        sex: 0.0,
        age: 0.47,
        muscle: 0.55,
        weight: 0.42,
        height: 0.55,
        proportions: 0.75,
        cup: 0.45,
        ancestry: [0.4, 0.3, 0.3],
        ..Person::default()
    }
}

fn man() -> Person {
    Person {
        sex: 1.0,
        age: 0.62,
        muscle: 0.6,
        weight: 0.95,
        height: 0.6,
        proportions: 0.55,
        cup: 0.5,
        ancestry: [0.15, 0.25, 0.6],
        ..Person::default()
    }
}

/// The A-pose of body scans.
fn standing() -> Pose {
    let arm = Arm { raise: 35.0, forward: 10.0, elbow: 15.0, ..Arm::default() };
    let leg = Leg { out: 7.0, ..Leg::default() };
    Pose { arms: [arm; 2], legs: [leg; 2], ..Pose::default() }
}

fn striding() -> Pose {
    Pose {
        spine: Bend { forward: 6.0, turn: -12.0, ..Bend::default() },
        neck: Bend { turn: 10.0, ..Bend::default() },
        arms: [
            Arm { raise: 125.0, forward: 25.0, elbow: 30.0, ..Arm::default() },
            Arm { raise: 35.0, forward: -50.0, elbow: 35.0, ..Arm::default() },
        ],
        legs: [
            Leg { raise: -20.0, out: 3.0, knee: 26.0, ankle: Some(4.0), ..Leg::default() },
            Leg { raise: 27.0, out: 3.0, knee: 7.0, ..Leg::default() },
        ],
        ..Pose::default()
    }
}

fn lunging() -> Pose {
    Pose {
        pelvis: Bend { forward: 8.0, ..Bend::default() },
        spine: Bend { forward: 14.0, left: 5.0, turn: 10.0 },
        neck: Bend { forward: -18.0, ..Bend::default() },
        arms: [
            Arm { raise: 82.0, forward: 75.0, elbow: 40.0, ..Arm::default() },
            Arm { raise: 75.0, forward: 55.0, elbow: 75.0, ..Arm::default() },
        ],
        legs: [
            Leg { raise: 55.0, out: 16.0, twist: 12.0, knee: 64.0, ankle: None },
            Leg { raise: 42.0, out: 22.0, twist: 15.0, knee: 66.0, ankle: None },
        ],
    }
}

fn greeting() -> Pose {
    Pose {
        spine: Bend { left: -8.0, turn: 15.0, ..Bend::default() },
        neck: Bend { left: 6.0, forward: 5.0, ..Bend::default() },
        arms: [
            Arm { raise: 60.0, forward: 60.0, elbow: 60.0, ..Arm::default() },
            Arm { raise: 100.0, forward: 10.0, elbow: 95.0, twist: -70.0, ..Arm::default() },
        ],
        legs: [
            Leg { raise: 14.0, out: 8.0, knee: 12.0, ..Leg::default() },
            Leg { out: 8.0, knee: 4.0, ..Leg::default() },
        ],
        ..Pose::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_poses_are_within_the_limits_of_the_joints() {
        for sample in MESHES.iter().chain([&CLOUD]) {
            assert!(sample.pose.1().is_within_limits(), "{}", sample.pose.0);
        }
    }
}
