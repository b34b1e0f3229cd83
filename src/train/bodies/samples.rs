//! The sample scans that come with the page: two people, five poses.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::json;

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
    for (person, pose, title) in MESHES {
        let body = model.body(&person_named(person), &pose_named(pose))?;
        let points = template.pick(&body);
        let file = format!("{person}-{pose}.ply");
        save(&file, ply(&points, Some(&template)))?;
        entries.push(entry(&file, person, pose, title, "mesh", points.len(), template.triangles.len()));
    }

    let (person, pose, title) = CLOUD;
    let body = model.body(&person_named(person), &pose_named(pose))?;
    let pool = uniform_points(&body, &model.skin.triangles, POOL, &mut ChaCha8Rng::seed_from_u64(SEED));
    let points: Vec<_> = farthest_points(&pool, POINTS).into_iter().map(|i| pool[i]).collect();
    let vertices = template.pick(&body);
    let (file, truth) = (format!("{person}-{pose}-cloud.ply"), format!("{person}-{pose}-cloud.truth.json"));
    save(&file, ply(&points, None))?;
    let nearest = json!({ "cloud": file, "nearestVertex": nearest(&points, &vertices) });
    save(&truth, format!("{nearest}\n").into_bytes())?;
    let mut cloud = entry(&file, person, pose, title, "cloud", points.len(), 0);
    cloud["truth"] = json!(truth);
    entries.push(cloud);

    let manifest = json!({ "license": "CC0-1.0", "credits": CREDITS, "unit": "metre", "up": "y", "parts": PARTS, "samples": entries });
    save("samples.json", format!("{manifest:#}\n").into_bytes())?;
    Ok(files)
}

/// Person, pose and a title for people.
type Sample = (&'static str, &'static str, &'static str);

const MESHES: [Sample; 4] = [
    ("woman", "standing", "Woman, standing"),
    ("woman", "striding", "Woman, striding"),
    ("man", "standing", "Man, standing"),
    ("man", "lunging", "Man, knees bent, arms forward"),
];
const CLOUD: Sample = ("woman", "greeting", "Woman, greeting (points only)");

fn entry(
    file: &str,
    person: &str,
    pose: &str,
    title: &str,
    kind: &str,
    points: usize,
    faces: usize,
) -> serde_json::Value {
    json!({ "file": file, "title": title, "person": person, "pose": pose, "kind": kind, "points": points, "faces": faces,
        "license": "CC0-1.0", "credits": CREDITS })
}

/// A PLY file in memory: a mesh with labels, or bare points.
fn ply(points: &[glam::DVec3], mesh: Option<&Template>) -> Vec<u8> {
    let mut comments = vec![format!("{CREDITS} License: CC0 1.0."), "y up, metres".to_owned()];
    let (triangles, labels) = mesh.map_or((&[][..], None), |t| (&t.triangles[..], Some(&t.labels[..])));
    if mesh.is_some() {
        comments.push(format!("labels: {}", PARTS.join(", ")));
    }
    let mut bytes = Vec::new();
    write_ply(&mut bytes, points, triangles, labels, &comments).expect("writing to memory does not fail");
    bytes
}

/// The two people of the samples: `"woman"`, anything else is the man.
pub fn person_named(name: &str) -> Person {
    match name {
        "woman" => Person {
            sex: 0.0,
            age: 0.47,
            muscle: 0.55,
            weight: 0.42,
            height: 0.55,
            proportions: 0.75,
            cup: 0.45,
            ancestry: [0.4, 0.3, 0.3],
        },
        _ => Person {
            sex: 1.0,
            age: 0.62,
            muscle: 0.6,
            weight: 0.95,
            height: 0.6,
            proportions: 0.55,
            cup: 0.5,
            ancestry: [0.15, 0.25, 0.6],
        },
    }
}

/// The poses of the samples; an unknown name stands straight.
pub fn pose_named(name: &str) -> Pose {
    let arm = Arm { raise: 35.0, forward: 10.0, elbow: 15.0, ..Arm::default() };
    let leg = Leg { out: 7.0, ..Leg::default() };
    let standing = Pose { arms: [arm; 2], legs: [leg; 2], ..Pose::default() };
    match name {
        "striding" => Pose {
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
        },
        "lunging" => Pose {
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
        },
        "greeting" => Pose {
            spine: Bend { left: -8.0, turn: 15.0, ..Bend::default() },
            neck: Bend { left: 6.0, forward: 5.0, ..Bend::default() },
            arms: [
                Arm { raise: 60.0, forward: 60.0, elbow: 60.0, ..Arm::default() },
                Arm { raise: 100.0, forward: 10.0, elbow: 95.0, twist: -70.0, ..Arm::default() },
            ],
            legs: [
                Leg { raise: 8.0, out: 12.0, knee: 22.0, ..Leg::default() },
                Leg { raise: 0.0, out: 8.0, ..Leg::default() },
            ],
            ..Pose::default()
        },
        _ => standing,
    }
}
