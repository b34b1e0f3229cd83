//! Pairs of points that are known to correspond, through all rounds of a refinement.

use std::collections::BTreeSet;

use ndarray::{Array2, s};

use crate::maps::{Correspondence, Matchable};
use crate::vector::squared_distance;

/// Diffusion time, at unit area, of the neighbourhood that a landmark takes along: about a hand's width on a person.
const TIME: f64 = 0.003;
/// Landmarks whose neighbourhoods count. Where there are more, they lie so close that each being held is enough.
const MOST: usize = 64;
/// A landmark that the map takes farther than this from its partner, in √area, is not followed by what lies around it.
pub(crate) const AWAY: f64 = 0.1;

/// What a user knows of a pair, at the points used.
#[derive(Clone, Copy, Debug, Default)]
pub struct Constraints<'a> {
    /// Part labels (n) of A and of B: no point is matched to another part, unless the other shape has none of its own.
    pub parts: Option<(&'a [u32], &'a [u32])>,
    /// Rows of A and of B that correspond; no row twice.
    pub landmarks: &'a [[u32; 2]],
}

impl<'a> Constraints<'a> {
    /// The landmarks whose neighbourhoods count.
    pub(super) fn nearby(&self) -> &'a [[u32; 2]] {
        &self.landmarks[..MOST.min(self.landmarks.len())]
    }
}

/// Landmarks of which no row comes twice: of several that end on one point used the first counts.
pub(crate) fn distinct(pairs: impl IntoIterator<Item = [u32; 2]>) -> Vec<[u32; 2]> {
    let mut taken = [BTreeSet::new(), BTreeSet::new()];
    pairs
        .into_iter()
        .filter(|&[i, j]| {
            let free = !taken[0].contains(&i) && !taken[1].contains(&j);
            if free {
                taken[0].insert(i);
                taken[1].insert(j);
            }
            free
        })
        .collect()
}

/// The shape with these rows among the samples of its even sampling, each holding on to the sample whose cell it lay in and to that one's neighbours.
pub(crate) fn sampled_at(mut shape: Matchable, rows: impl Iterator<Item = u32>) -> Matchable {
    for row in rows {
        let near = shape.surface.cell[row as usize];
        if shape.coarse[near as usize] == row {
            continue;
        }
        let own = shape.coarse.len() as u32;
        let around: BTreeSet<u32> = shape
            .surface
            .adjacent
            .iter()
            .filter(|pair| pair.contains(&near))
            .flatten()
            .copied()
            .chain([near])
            .collect();
        shape.coarse.push(row);
        shape.surface.cell[row as usize] = own;
        shape.surface.adjacent.extend(around.into_iter().map(|other| [other, own]));
    }
    shape
}

/// For each landmark the samples of the two shapes that are its points; both come from [`sampled_at`].
pub(super) fn samples([a, b]: [&Matchable; 2], landmarks: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let pairs = landmarks.iter().map(|&[i, j]| [a.surface.cell[i as usize], b.surface.cell[j as usize]]);
    distinct(pairs)
}

/// How near each point is to each of the rows, along the surface: heat that has spread from there, 1 in the row itself. Shape (p, rows).
pub(super) fn nearness(shape: &Matchable, rows: impl Iterator<Item = u32>) -> Array2<f32> {
    let (basis, weyl) = (&shape.basis, shape.basis.weyl_factor());
    let decay = basis.eigenvalues.mapv(|lambda| (-TIME * lambda / weyl).exp());
    let rows: Vec<usize> = rows.map(|row| row as usize).collect();
    let mut heat = Array2::zeros((shape.len(), rows.len()));
    for (mut column, row) in heat.columns_mut().into_iter().zip(rows) {
        let source = &basis.eigenvectors.slice(s![row, ..]) * &decay;
        let spread = basis.eigenvectors.dot(&source);
        let peak = spread[row].max(f64::MIN_POSITIVE);
        column.zip_mut_with(&spread, |heat, &spread| *heat = (spread / peak).clamp(0.0, 1.0) as f32);
    }
    heat
}

/// How far the maps take each landmark from its partner, in √area: mean of the way there and the way back.
pub(super) fn residuals([a, b]: [&Matchable; 2], landmarks: &[[u32; 2]], [to_b, to_a]: [&[u32]; 2]) -> Vec<f64> {
    let apart = |shape: &Matchable, found: u32, wanted: u32| {
        let place = |row: u32| std::array::from_fn(|c| shape.points[(row as usize, c)]);
        squared_distance(place(found), place(wanted)).sqrt()
    };
    let residual = |&[i, j]: &[u32; 2]| 0.5 * (apart(b, to_b[i as usize], j) + apart(a, to_a[j as usize], i));
    landmarks.iter().map(residual).collect()
}

/// Takes confidence from what lies around the landmarks that the map does not follow: either they are wrong, or the map is there.
pub(super) fn doubt(map: &mut Correspondence, nearness: &Array2<f32>, residuals: &[f64]) {
    for (column, _) in nearness.columns().into_iter().zip(residuals).filter(|(_, residual)| **residual > AWAY) {
        map.confidence.iter_mut().zip(column).for_each(|(confidence, near)| *confidence *= 1.0 - near);
    }
}
