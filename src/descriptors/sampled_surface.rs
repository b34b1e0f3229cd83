//! What is known of a surface between the points of a sampling: which of them touch, and which way it faces.

use ndarray::s;

use super::outward_normals::outward_normals;
use crate::graph::{EdgeGraph, nearest_sources};
use crate::operators::{EdgeFilter, Neighbourhood};
use crate::shape::{Shape, nearest_samples};
use crate::spectrum::SpectralBasis;
use crate::vector::squared_distance;

/// Edges of a cloud on which two quadrics of surface agree less than this lead from one to the other. Between the edges within a sheet and those that cross
/// a contact there is hardly anything in between.
const SAME_SHEET: f64 = 0.5;

/// Neighbours of a point of a cloud that may touch it: about as many as a vertex of a mesh has. More would hold on to each other over longer distances.
const NEAR: usize = 8;

/// Eigenfunctions that are asked whether a pair of samples lies on one sheet.
const JUDGES: usize = 40;
/// They jump where their squared slope is this many times the usual one; on sample bodies that of 99 % of the pairs on one sheet is below 4 times.
const JUMP: f64 = 5.0;

/// A surface around s samples among n points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampledSurface {
    /// Unit normals (n, 3).
    pub normals: Vec<[f64; 3]>,
    /// Whether all normals point out, as those of a mesh do whose faces agree; on a cloud the sign means nothing.
    pub oriented: bool,
    /// The sample nearest to each point along the surface (n), as its row in the sampling.
    pub cell: Vec<u32>,
    /// Rows of samples whose cells touch, each pair once, the lower row first.
    pub adjacent: Vec<[u32; 2]>,
}

impl SampledSurface {
    /// Of a mesh along its edges; of a cloud along edges between neighbours that lie on one sheet, so that limbs in contact do not touch. `samples` are indices
    /// of points, `basis` is that of the shape; on a cloud its `neighbourhood` counts, and `filter` weakens edges that are known to join two parts of the body.
    pub fn around(
        shape: &Shape,
        neighbourhood: &Neighbourhood,
        filter: Option<EdgeFilter>,
        samples: &[u32],
        basis: &SpectralBasis,
    ) -> Self {
        let (graph, normals, oriented) = if shape.faces().is_empty() {
            let (neighbours, quadrics) = (neighbourhood.neighbours(), neighbourhood.quadrics());
            let sheets = quadrics.with_filter(filter);
            let near = |i: usize| neighbours.of(i).iter().zip(neighbours.distances(i)).take(NEAR);
            let edges = (0..neighbours.len()).flat_map(|i| near(i).map(move |(&j, &d)| (i as u32, j, d)));
            let kept = edges.filter(|&(i, j, _)| sheets.agreement(i, j) > SAME_SHEET);
            (EdgeGraph::from_edges(neighbours.len(), kept), quadrics.normals(), false)
        } else {
            let welded = shape.welded();
            let normals = outward_normals(&welded);
            (EdgeGraph::of_faces(welded.points(), welded.faces()), normals, welded.faces_agree())
        };
        let mut cell = nearest_sources(&graph, samples);
        let mut adjacent: Vec<[u32; 2]> = graph
            .edges()
            .map(|(i, j, _)| [cell[i as usize], cell[j as usize]])
            .filter(|&[i, j]| i != j && i != u32::MAX && j != u32::MAX)
            .map(|[i, j]| [i.min(j), i.max(j)])
            .collect();
        adjacent.sort_unstable();
        adjacent.dedup();
        if shape.faces().is_empty() {
            cut_at_jumps(&mut adjacent, shape.points(), samples, basis);
        }
        // No path leads to a sample from a copy of a point or a stray piece.
        if cell.contains(&u32::MAX) {
            let in_space = nearest_samples(shape.points(), samples);
            cell.iter_mut().zip(in_space).filter(|(c, _)| **c == u32::MAX).for_each(|(c, near)| *c = near);
        }
        Self { normals, oriented, cell, adjacent }
    }

    /// The same seen from some of its points only; all samples must be among them, and keep their rows.
    pub fn at(&self, points: &[u32]) -> Self {
        Self {
            normals: points.iter().map(|&i| self.normals[i as usize]).collect(),
            oriented: self.oriented,
            cell: points.iter().map(|&i| self.cell[i as usize]).collect(),
            adjacent: self.adjacent.clone(),
        }
    }
}

/// Leaves out pairs between which the eigenfunctions jump. A few edges across a contact pass every test of where points lie, and would tie a hand to the hip it
/// rests on; the operator, in which they are few among many, still tells the two apart.
fn cut_at_jumps(adjacent: &mut Vec<[u32; 2]>, points: &[[f64; 3]], samples: &[u32], basis: &SpectralBasis) {
    let functions = JUDGES.min(basis.k());
    let slope = |&[i, j]: &[u32; 2]| {
        let [i, j] = [i, j].map(|row| samples[row as usize] as usize);
        let phi = |i: usize| basis.eigenvectors.slice(s![i, ..functions]);
        let jump: f64 = phi(i).iter().zip(phi(j)).map(|(x, y)| (x - y).powi(2)).sum();
        jump / squared_distance(points[i], points[j]).max(f64::MIN_POSITIVE)
    };
    let slopes: Vec<f64> = adjacent.iter().map(slope).collect();
    let mut sorted = slopes.clone();
    let middle = sorted.len() / 2;
    if middle == 0 {
        return;
    }
    let (_, &mut usual, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    let mut kept = slopes.iter().map(|&slope| slope <= JUMP * usual);
    adjacent.retain(|_| kept.next().unwrap_or(true));
}
