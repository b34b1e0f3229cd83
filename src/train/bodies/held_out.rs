//! Bodies that training never sees, in the layout `evaluate` reads.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::chance::uniform;
use super::parts::PARTS;
use super::pieces::piece;
use super::random::PoseSource;
use super::samples::SampleError;
use super::scan::even_mesh;
use super::style::Style;
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
    /// Whether there is a piece of each body too, every second one in another unit, and pairs are of pieces with wholes, every fourth of a whole with a piece and every fourth of two pieces.
    pub pieces: bool,
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
    let mut pieces = Vec::new();
    let names: Vec<String> = (0..set.count).map(|i| format!("body_{:06}", set.seed + i as u64)).collect();
    for (i, name) in names.iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(set.seed + i as u64);
        let source = if i % IN_CONTACT == 0 { PoseSource::Gesture } else { PoseSource::Free };
        let body = model.draw_body(&template, source, Style::default(), &mut rng)?;
        let mesh = even_mesh(&body.skin, &model.skin.triangles, set.points, &mut rng);
        let places: Vec<DVec3> = mesh.vertices.iter().map(|&v| body.skin[v as usize]).collect();
        let mut off = Vec::new();
        write_off(&mut off, &places, &mesh.faces).expect("writing to memory does not fail");
        save(format!("shapes/{name}.off"), off)?;
        let labels: Vec<u32> = mesh.vertices.iter().map(|&v| model.labels[v as usize]).collect();
        save(format!("labels/{name}.txt"), lines(&labels))?;
        let [truth, mirrored] = truth(model, &template, &mesh.cell);
        if set.pieces {
            let (kind, faces) = piece(&places, &mesh.faces, &mut rng);
            let unit = if i % 2 == 0 { 1.0 } else { uniform(&mut rng, -1.0..1.0).exp2() };
            let kept: BTreeSet<u32> = faces.iter().flatten().copied().collect();
            let kept: Vec<u32> = kept.into_iter().collect();
            let row = |v: u32| kept.binary_search(&v).map_or(0, |row| row as u32 + 1);
            let name = format!("{name}_{kind}");
            pieces.push(name.clone());
            let places: Vec<DVec3> = kept.iter().map(|&v| unit * places[v as usize]).collect();
            let faces: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| row(v) - 1)).collect();
            let mut off = Vec::new();
            write_off(&mut off, &places, &faces).expect("writing to memory does not fail");
            save(format!("shapes/{name}.off"), off)?;
            save(format!("labels/{name}.txt"), lines(&kept.iter().map(|&v| labels[v as usize]).collect::<Vec<_>>()))?;
            let of_piece = |rows: &[u32]| lines(&rows.iter().map(|&v| row(v - 1)).collect::<Vec<_>>());
            save(format!("corres/{name}.vts"), of_piece(&truth))?;
            save(format!("corres/{name}.sym.vts"), of_piece(&mirrored))?;
        }
        save(format!("corres/{name}.vts"), lines(&truth))?;
        save(format!("corres/{name}.sym.vts"), lines(&mirrored))?;
    }
    let pairs = if set.pieces { pairs_of_pieces(&names, &pieces) } else { pairs(&names, set.seed) };
    save("pairs.txt".to_owned(), lines(&pairs))?;
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

/// Each piece and the whole of the next body, every fourth the other way round and every fourth with its piece.
fn pairs_of_pieces(names: &[String], pieces: &[String]) -> Vec<String> {
    let next = |i: usize| (i + 1) % names.len();
    let pair = |(i, piece): (usize, &String)| match i % 4 {
        1 => format!("{} {piece}", names[next(i)]),
        3 => format!("{piece} {}", pieces[next(i)]),
        _ => format!("{piece} {}", names[next(i)]),
    };
    pieces.iter().enumerate().map(pair).collect()
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
