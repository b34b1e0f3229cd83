//! A mesh with fewer vertices, all of them vertices of the one given, and the way back.

use std::collections::BTreeSet;

use super::Shape;
use super::sample::farthest_points;
use crate::graph::{EdgeGraph, nearest_sources};
use crate::progress::Cancelled;

/// A mesh on some of the vertices of another.
pub struct Simplified {
    /// Vertex of the original behind each vertex here.
    pub vertices: Vec<u32>,
    /// Triangles over the vertices here.
    pub faces: Vec<[u32; 3]>,
    /// For every vertex of the original the vertex here that stands for it.
    pub cell: Vec<u32>,
}

/// Most vertices that thin parts keep.
pub const THIN_LIMIT: usize = 15_000;

/// The mesh of [`draw_together`] with its thin parts, and how many of the vertices `allowed` are in parts that were lost all the same: the nearest vertex
/// that the mesh has stands for them.
///
/// Of a part less than two cells around (a whisker, a cord, a temple of glasses) drawing together leaves a string of cells without a triangle. There every
/// vertex stays, up to [`THIN_LIMIT`] of them, evenly spread.
pub fn simplify(
    shape: &Shape,
    allowed: &[u32],
    count: usize,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<(Simplified, usize), Cancelled> {
    let Simplified { mut vertices, mut faces, mut cell } = draw_together(shape, allowed, count, report)?;
    let thin = thin_cells(shape, &cell, &faces, vertices.len());
    if thin.contains(&true) {
        let within: Vec<u32> = allowed.iter().copied().filter(|&v| thin[cell[v as usize] as usize]).collect();
        // Cells around stay as they are, so with all of `within` whatever hung together by an edge hangs together by a triangle.
        let own = farthest_points(shape.points(), &within, THIN_LIMIT, report)?;
        replace(shape, &mut vertices, &mut cell, &thin, own);
        faces = drawn(shape, &cell);
    }
    let bare = without_face(&faces, vertices.len());
    let lost = allowed.iter().filter(|&&v| bare[cell[v as usize] as usize]).count();
    if lost > 0 {
        let row = replace(shape, &mut vertices, &mut cell, &bare, Vec::new());
        faces.iter_mut().flatten().for_each(|corner| *corner = row[*corner as usize]);
    }
    Ok((Simplified { vertices, faces, cell }, lost))
}

/// `count` of the vertices `allowed`, evenly spread, each drawing together the vertices nearest to it along the edges; what is left of
/// the triangles is the mesh.
///
/// This is a simplicial map: a closed surface stays closed and touching limbs stay apart, though a part two cells around folds flat, which the
/// Laplacian's tufted cover (Sharp & Crane 2020) can take. There are pure-Rust decimators, but they ask for manifold input or move vertices, and here every
/// vertex must remain one of the scan.
pub fn draw_together(
    shape: &Shape,
    allowed: &[u32],
    count: usize,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Simplified, Cancelled> {
    let vertices = farthest_points(shape.points(), allowed, count, report)?;
    let cell = cells(shape, &vertices);
    Ok(Simplified { faces: drawn(shape, &cell), vertices, cell })
}

/// The triangles of `shape` between three cells, each once.
fn drawn(shape: &Shape, cell: &[u32]) -> Vec<[u32; 3]> {
    let mut seen = BTreeSet::new();
    let mut faces = Vec::new();
    for face in shape.faces() {
        let [a, b, c] = face.map(|v| cell[v as usize]);
        let least = a.min(b).min(c);
        // From its lowest corner on, so that the two sides of a fold differ and repetitions do not.
        let drawn = if a == least {
            [a, b, c]
        } else if b == least {
            [b, c, a]
        } else {
            [c, a, b]
        };
        if a != b && b != c && c != a && seen.insert(drawn) {
            faces.push(drawn);
        }
    }
    faces
}

fn without_face(faces: &[[u32; 3]], count: usize) -> Vec<bool> {
    let mut without = vec![true; count];
    faces.iter().flatten().for_each(|&row| without[row as usize] = false);
    without
}

/// Which of `count` cells have no triangle, or an edge to another without a triangle at it: parts less than two cells around.
fn thin_cells(shape: &Shape, cell: &[u32], faces: &[[u32; 3]], count: usize) -> Vec<bool> {
    let sides = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)].map(|(i, j)| (i.min(j), i.max(j)));
    let mut thin = without_face(faces, count);
    let hinges: BTreeSet<(u32, u32)> = faces.iter().copied().flat_map(sides).collect();
    for (i, j) in shape.faces().iter().flat_map(|face| sides(face.map(|v| cell[v as usize]))) {
        if i != j && !hinges.contains(&(i, j)) {
            thin[i as usize] = true;
            thin[j as usize] = true;
        }
    }
    thin
}

/// Takes the samples that are `gone` out of `samples` and puts `new` ones at the end; points whose sample is gone go with the nearest that is there now.
/// The new row of each old sample that stays.
fn replace(shape: &Shape, samples: &mut Vec<u32>, cell: &mut [u32], gone: &[bool], new: Vec<u32>) -> Vec<u32> {
    let mut next = 0..;
    let row: Vec<u32> =
        gone.iter().map(|&gone| if gone { u32::MAX } else { next.next().unwrap_or(u32::MAX) }).collect();
    let mut stays = gone.iter().map(|&gone| !gone);
    samples.retain(|_| stays.next().unwrap_or(true));
    samples.extend(new);
    let nearest = cells(shape, samples);
    cell.iter_mut().zip(nearest).for_each(|(c, near)| *c = if gone[*c as usize] { near } else { row[*c as usize] });
    row
}

/// For every point the row of the sample nearest along the surface; in space where no edge leads to one, as on a cloud. On a welded mesh a copy of a corner goes
/// with the one that has the faces.
pub fn cells(shape: &Shape, samples: &[u32]) -> Vec<u32> {
    if shape.faces().is_empty() {
        return super::nearest_samples(shape.points(), samples);
    }
    let mut cell = nearest_sources(&EdgeGraph::of_faces(shape.points(), shape.faces()), samples);
    let lost: Vec<usize> = (0..cell.len()).filter(|&i| cell[i] == u32::MAX).collect();
    if !lost.is_empty() {
        let (first, in_space) = (shape.first_at_place(), super::nearest_samples(shape.points(), samples));
        for i in lost {
            let joined = cell[first[i] as usize];
            cell[i] = if joined == u32::MAX { in_space[i] } else { joined };
        }
    }
    cell
}
