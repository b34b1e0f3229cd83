//! Bodies that training never sees, in the layout `evaluate` reads.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::parts::PARTS;
use super::random::PoseSource;
use super::samples::SampleError;
use super::scan::even_mesh;
use super::write::write_off;
use super::{BodyModel, Template};

/// Training draws bodies of seeds below this one; whatever is measured on, from here on.
pub const HELD_OUT_SEEDS: u64 = 800_000;
/// Every third body touches itself on purpose: where errors live.
const IN_CONTACT: usize = 3;

/// Which bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOut {
    /// How many.
    pub count: usize,
    /// Seed of the first; the next ones follow.
    pub seed: u64,
    /// Vertices of each mesh, and points of the template that the truth is given at.
    pub points: usize,
}

/// Writes shapes, truth with its mirror image, labels and some two pairs a body into `out`; returns the names of the shapes. Every body is another person and
/// has a mesh of its own, in metres and upright.
pub fn write_set(model: &BodyModel, out: &Path, set: &HeldOut) -> Result<Vec<String>, SampleError> {
    for folder in ["shapes", "corres", "labels"] {
        let path = out.join(folder);
        fs::create_dir_all(&path).map_err(|source| SampleError::Write { path, source })?;
    }
    let save = |name: String, bytes: Vec<u8>| {
        let path = out.join(name);
        fs::write(&path, bytes).map_err(|source| SampleError::Write { path, source })
    };
    let template = model.template(set.points)?;
    let names: Vec<String> = (0..set.count).map(|i| format!("body_{:06}", set.seed + i as u64)).collect();
    for (i, name) in names.iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(set.seed + i as u64);
        let source = if i % IN_CONTACT == 0 { PoseSource::Gesture } else { PoseSource::Free };
        let body = model.draw_body(&template, source, &mut rng)?;
        let mesh = even_mesh(&body.skin, &model.skin.triangles, set.points, &mut rng);
        let places: Vec<DVec3> = mesh.vertices.iter().map(|&v| body.skin[v as usize]).collect();
        let mut off = Vec::new();
        write_off(&mut off, &places, &mesh.faces).expect("writing to memory does not fail");
        save(format!("shapes/{name}.off"), off)?;
        let labels: Vec<u32> = mesh.vertices.iter().map(|&v| model.labels[v as usize]).collect();
        save(format!("labels/{name}.txt"), lines(&labels))?;
        let [truth, mirrored] = truth(model, &template, &mesh.cell);
        save(format!("corres/{name}.vts"), lines(&truth))?;
        save(format!("corres/{name}.sym.vts"), lines(&mirrored))?;
    }
    save("pairs.txt".to_owned(), lines(&pairs(&names, set.seed)))?;
    let parts = PARTS.map(|part| part.replace(' ', "_"));
    save("labels.json".to_owned(), format!("{}\n", serde_json::json!(parts)).into_bytes())?;
    save("NOTE.txt".to_owned(), format!("{}\n", note(set)).into_bytes())?;
    Ok(names)
}

/// For each point of the template the vertex of the mesh that stands for it, and the one that stands for its mirror image; both 1-based.
fn truth(model: &BodyModel, template: &Template, cell: &[u32]) -> [Vec<u32>; 2] {
    let at = |v: u32| cell[v as usize] + 1;
    let direct = template.vertices.iter().map(|&v| at(v)).collect();
    [direct, template.vertices.iter().map(|&v| at(model.mirror[v as usize])).collect()]
}

/// Each body to two others.
fn pairs(names: &[String], seed: u64) -> Vec<String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let n = names.len();
    let mut pairs = Vec::new();
    for (i, name) in names.iter().enumerate().filter(|_| n > 1) {
        let steps = [0; 2].map(|_| rng.random_range(1..n));
        for step in if steps[0] == steps[1] { &steps[..1] } else { &steps[..] } {
            pairs.push(format!("{name} {}", names[(i + step) % n]));
        }
    }
    pairs
}

fn note(set: &HeldOut) -> String {
    format!(
        "{} bodies of this project's generator, seeds from {}, each another person with a mesh of its own of {} vertices; every third touches itself \
         on purpose. Training uses seeds below {HELD_OUT_SEEDS}. CC0.",
        set.count, set.seed, set.points
    )
}

fn lines(rows: &[impl std::fmt::Display]) -> Vec<u8> {
    let mut text = String::new();
    rows.iter().for_each(|row| writeln!(text, "{row}").expect("writing to memory does not fail"));
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_join_different_bodies_and_none_comes_twice() {
        let names: Vec<String> = (0..24).map(|i| format!("b{i}")).collect();
        let pairs = pairs(&names, 7);
        assert!((24..=48).contains(&pairs.len()));
        assert!(pairs.iter().all(|p| p.split_once(' ').is_some_and(|(a, b)| a != b)));
        let distinct: std::collections::BTreeSet<_> = pairs.iter().collect();
        assert_eq!(distinct.len(), pairs.len());
    }
}
