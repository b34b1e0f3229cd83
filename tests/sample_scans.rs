//! The committed sample scans are what their README says. They are read here without the library's own readers, which are
//! tested elsewhere.
#![cfg(feature = "train")]

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use geose_fmap::train::bodies::manifold::is_closed_manifold;
use geose_fmap::train::bodies::parts::PARTS;
use serde_json::Value;

struct Scan {
    points: Vec<[f32; 3]>,
    labels: Vec<u8>,
    faces: Vec<[u32; 3]>,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("www/public/samples")
}

fn manifest() -> Value {
    serde_json::from_slice(&fs::read(folder().join("samples.json")).expect("committed")).expect("JSON")
}

fn samples(kind: &str) -> Vec<(String, Scan)> {
    let manifest = manifest();
    let entries = manifest["samples"].as_array().expect("a list").iter().filter(|e| e["kind"] == kind);
    entries
        .map(|e| {
            let file = e["file"].as_str().expect("a name");
            let scan = read(file);
            assert_eq!(e["points"], scan.points.len());
            assert_eq!(e["faces"], scan.faces.len());
            (file.to_owned(), scan)
        })
        .collect()
}

/// Reads the one layout the generator writes: three floats, perhaps a label byte, perhaps triangles.
fn read(file: &str) -> Scan {
    let bytes = fs::read(folder().join(file)).expect("committed");
    let end = b"end_header\n";
    let start = bytes.windows(end.len()).position(|w| w == end).expect("a header") + end.len();
    let header = std::str::from_utf8(&bytes[..start]).expect("text");
    let count = |element: &str| {
        let line = header.lines().find_map(|l| l.strip_prefix("element ")?.strip_prefix(element));
        line.map_or(0, |n| n.trim().parse::<usize>().expect("a number"))
    };
    let labelled = header.contains("property uchar label");
    let stride = if labelled { 13 } else { 12 };
    let (vertices, triangles) = bytes[start..].split_at(stride * count("vertex"));
    let word = |b: &[u8], i: usize| [b[4 * i], b[4 * i + 1], b[4 * i + 2], b[4 * i + 3]];
    assert_eq!(triangles.len(), 13 * count("face"), "{file} ends where it should");
    Scan {
        points: vertices.chunks(stride).map(|v| [0, 1, 2].map(|i| f32::from_le_bytes(word(v, i)))).collect(),
        labels: if labelled { vertices.chunks(stride).map(|v| v[12]).collect() } else { Vec::new() },
        faces: triangles.chunks(13).map(|t| [0, 1, 2].map(|i| u32::from_le_bytes(word(&t[1..], i)))).collect(),
    }
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| f64::from(a[i]) - f64::from(b[i]))
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[test]
fn there_are_four_meshes_of_two_people_and_a_cloud() {
    let manifest = manifest();
    let people: BTreeSet<_> =
        manifest["samples"].as_array().expect("a list").iter().map(|e| e["person"].as_str()).collect();
    assert_eq!(people.len(), 2);
    assert_eq!((samples("mesh").len(), samples("cloud").len()), (4, 1));
    assert_eq!(manifest["parts"], serde_json::json!(PARTS));
    assert_eq!(manifest["license"], "CC0-1.0");
}

#[test]
fn pieces_are_what_their_truth_says_of_a_mesh() {
    let meshes = samples("mesh");
    let pieces = samples("piece");
    assert_eq!(pieces.len(), 3);
    for (file, piece) in pieces {
        let path = folder().join(file.replace(".ply", ".truth.json"));
        let truth: Value = serde_json::from_slice(&fs::read(path).expect("committed")).expect("JSON");
        assert_eq!(truth["piece"], file);
        let (_, whole) = meshes.iter().find(|(name, _)| truth["of"] == *name).expect("a mesh");
        let vertices: Vec<usize> = truth["vertices"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|v| v.as_u64().expect("an index") as usize)
            .collect();
        assert_eq!(vertices.len(), piece.points.len(), "{file}");
        // Vertices of the mesh, or what a depth camera sees beside them.
        let most = if piece.faces.is_empty() { 0.06 } else { 1e-6 };
        let apart = vertices.iter().zip(&piece.points).map(|(&v, &p)| length(sub(whole.points[v], p)));
        assert!(apart.fold(0.0, f64::max) <= most, "{file}");
        let used: BTreeSet<usize> = vertices.into_iter().collect();
        assert!((0.15..0.65).contains(&(used.len() as f64 / whole.points.len() as f64)), "{file}: {}", used.len());
        let inside = piece.faces.iter().all(|face| {
            let of: BTreeSet<u32> = face.iter().copied().collect();
            of.len() == 3 && of.into_iter().all(|v| (v as usize) < piece.points.len())
        });
        assert!(inside, "{file}");
    }
}

#[test]
fn meshes_share_faces_and_labels() {
    let meshes = samples("mesh");
    for (file, mesh) in &meshes {
        assert!(mesh.faces == meshes[0].1.faces && mesh.labels == meshes[0].1.labels, "{file}");
        let used: BTreeSet<u8> = mesh.labels.iter().copied().collect();
        assert_eq!(used, (0..PARTS.len() as u8).collect(), "{file} has every part and no other");
    }
}

#[test]
fn meshes_are_closed_with_outward_winding_and_no_empty_face() {
    for (file, mesh) in samples("mesh") {
        assert!(is_closed_manifold(mesh.points.len(), &mesh.faces), "{file}");
        assert_eq!(mesh.faces.len(), 2 * mesh.points.len() - 4, "{file}: one piece without handles");
        let mut volume = 0.0;
        for face in &mesh.faces {
            let [a, b, c] = face.map(|v| mesh.points[v as usize]);
            let normal = cross(sub(b, a), sub(c, a));
            assert!(length(normal) > 1e-8, "{file}: {face:?}");
            volume += (0..3).map(|i| normal[i] * f64::from(a[i])).sum::<f64>() / 6.0;
        }
        // People have about a litre for each kilogram.
        assert!((0.04..0.12).contains(&volume), "{file}: {volume} m³");
    }
}

#[test]
fn meshes_are_even_enough() {
    for (file, mesh) in samples("mesh") {
        let edges: Vec<f64> = mesh
            .faces
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .map(|(a, b)| length(sub(mesh.points[a as usize], mesh.points[b as usize])))
            .collect();
        let mean = edges.iter().sum::<f64>() / edges.len() as f64;
        let longest = edges.iter().copied().fold(0.0, f64::max);
        // Skin stretches in the armpit of a raised arm; at rest the longest edge is 3 times the mean.
        assert!(longest < 5.0 * mean, "{file}: mean {mean}, longest {longest}");
        let of = |part: &str| mesh.labels.iter().filter(|&&l| PARTS[l as usize].contains(part)).count();
        assert!(of("head") < mesh.points.len() / 6 && of("hand") < mesh.points.len() / 5, "{file}");
    }
}

#[test]
fn people_stand_on_the_floor_with_their_left_on_plus_x() {
    for (file, mesh) in samples("mesh") {
        let floor = mesh.points.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min);
        assert!(floor.abs() < 0.01, "{file}: {floor}");
        let mean = |part: &str, axis: usize| {
            let of: Vec<f32> = (0..mesh.points.len())
                .filter(|&i| PARTS[mesh.labels[i] as usize] == part)
                .map(|i| mesh.points[i][axis])
                .collect();
            of.iter().sum::<f32>() / of.len() as f32
        };
        for part in ["upper arm", "thigh", "foot"] {
            assert!(mean(&format!("left {part}"), 0) > mean(&format!("right {part}"), 0), "{file}: {part}");
        }
        assert!(mean("head", 1) > mean("torso", 1), "{file} is upright");
        assert!(mean("left foot", 2) > mean("left shank", 2) || file.contains("striding"), "{file} faces +z");
    }
}

#[test]
fn the_cloud_is_bare_and_its_truth_names_mesh_vertices() {
    let meshes = samples("mesh");
    for (file, cloud) in samples("cloud") {
        assert!(cloud.faces.is_empty() && cloud.labels.is_empty(), "{file}");
        let path = folder().join(file.replace(".ply", ".truth.json"));
        let truth: Value = serde_json::from_slice(&fs::read(path).expect("committed")).expect("JSON");
        assert_eq!(truth["cloud"], file);
        let nearest = truth["nearestVertex"].as_array().expect("a list");
        assert_eq!(nearest.len(), cloud.points.len());
        let named: BTreeSet<u64> = nearest.iter().map(|v| v.as_u64().expect("an index")).collect();
        assert!(named.last().is_some_and(|&v| v < meshes[0].1.points.len() as u64));
        assert!(named.len() > meshes[0].1.points.len() / 2, "{} vertices have a point", named.len());
        // On the same part of any body the truth is geometrically plausible: heads are above feet.
        let height = |part: &str| {
            let labels = &meshes[0].1.labels;
            let of: Vec<f32> = (0..nearest.len())
                .filter(|&i| PARTS[labels[nearest[i].as_u64().expect("an index") as usize] as usize] == part)
                .map(|i| cloud.points[i][1])
                .collect();
            of.iter().sum::<f32>() / of.len() as f32
        };
        assert!(height("head") > height("torso") && height("torso") > height("left thigh"));
        assert!(height("right foot") < 0.15);
    }
}
