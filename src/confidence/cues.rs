//! What a match shows of its own faults, point by point.
//!
//! Wrong places come by regions (a hand shifted along its arm, an arm twisted about its axis), and a single point shows little of it: on held-out bodies the
//! way there and back alone tells right from wrong hardly better than chance. So each sign is averaged over a neighbourhood and over a region.
//! Where on the body a point lies says more (matches slide on a back, and not on a face), and that is what a network's features know: without it the area under curve
//! on held-out meshes was 0.836, with it 0.858 (version 2 of the weights). How far a match lies from where features alone would put the point, and how sure they are, was tried as two signs more: 0.004 on
//! meshes and 0.008 on clouds, not worth an attention pass.

use std::sync::Arc;

use ndarray::{Array2, ArrayView2, s};

use crate::maps::{LearnedCues, Matchable};
use crate::network::Category;
use crate::vector::{Vector, minus, norm};

/// Steps from sample to neighbouring samples that an average reaches out: a sample is about 0.02 √area wide, and averages of averages spread like heat, so that these
/// are about as wide as a hand and as a thigh.
pub(super) const STEPS: [usize; 2] = [4, 24];
/// Lengths, in √area, above which a sign is no worse.
const LONGEST: f64 = 1.0;
/// Signs that are averaged: cycle, strain, residual; their roots are what counts.
pub(super) const SIGNS: usize = 3;
/// Cues that need no network: each sign near and wide.
pub(crate) const GENERAL: usize = STEPS.len() * SIGNS;

/// Cues of one direction of a match; those that do not exist are 0.
#[derive(Clone, Debug)]
pub(crate) struct Cues {
    /// Rows (p): [`GENERAL`] cues; with a network also the probability of each group of parts that is a cue of its category, and its prior.
    pub(crate) table: Array2<f64>,
    /// Whether the body was registered onto the other, so that there are residuals.
    pub(crate) registered: bool,
    /// Whether both bodies are meshes.
    pub(crate) meshes: bool,
    /// Whether one of them is a piece.
    pub(crate) pieces: bool,
    /// What the network that took part knows.
    pub(crate) category: Option<Arc<Category>>,
}

impl Cues {
    /// Of the match `there` (p) from `own` to `other`; `back` is the match the other way, `registered` (p, 3) are positions of `own` deformed onto `other`.
    pub(crate) fn of(
        [own, other]: [&Matchable; 2],
        [there, back]: [&[u32]; 2],
        registered: Option<ArrayView2<f32>>,
    ) -> Self {
        let (region, p) = (Region::of(own), own.len());
        let image = |i: usize| place(other, there[i] as usize);
        let cycle = |i: usize| norm(minus(place(own, back[there[i] as usize] as usize), place(own, i)));
        let mut signs = vec![region.means((0..p).map(cycle)), region.strain(own, &image)];
        if let Some(registered) = &registered {
            let residual = |i: usize| norm(std::array::from_fn(|c| f64::from(registered[(i, c)]) - image(i)[c]));
            signs.push(region.means((0..p).map(residual)));
        }
        let width = GENERAL + own.learned.as_ref().map_or(0, |learned| learned.limbs.ncols() + 1);
        let mut table = Array2::zeros((p, width));
        for (sign, mut at_samples) in signs.into_iter().enumerate() {
            for (wide, steps) in STEPS.iter().enumerate() {
                let before = if wide == 0 { 0 } else { STEPS[wide - 1] };
                (before..*steps).for_each(|_| at_samples = region.averaged(&at_samples));
                for (i, &cell) in own.surface.cell.iter().enumerate() {
                    table[(i, STEPS.len() * sign + wide)] = at_samples[cell as usize].min(LONGEST).sqrt();
                }
            }
        }
        let meshes = own.surface.oriented && other.surface.oriented;
        if let Some(LearnedCues { limbs, prior, .. }) = &own.learned {
            table.slice_mut(s![.., GENERAL..width - 1]).assign(limbs);
            if let Some(prior) = prior {
                let kind = prior.column(usize::from(!meshes));
                table.column_mut(width - 1).zip_mut_with(&kind, |cue, &prior| *cue = f64::from(prior));
            }
        }
        let category = own.learned.as_ref().map(|learned| learned.category.clone());
        let pieces = own.share.min(other.share) < 1.0;
        Self { table, registered: registered.is_some(), meshes, pieces, category }
    }
}

fn place(shape: &Matchable, row: usize) -> Vector {
    std::array::from_fn(|c| shape.points[(row, c)])
}

/// The even sampling of a body as a graph.
struct Region<'m> {
    cell: &'m [u32],
    adjacent: &'m [[u32; 2]],
    /// Points per cell.
    points: Vec<f64>,
    /// Neighbours per sample.
    degree: Vec<f64>,
}

impl<'m> Region<'m> {
    fn of(shape: &'m Matchable) -> Self {
        let (cell, adjacent) = (&shape.surface.cell[..], &shape.surface.adjacent[..]);
        let (mut points, mut degree) = (vec![0.0; shape.coarse.len()], vec![0.0; shape.coarse.len()]);
        cell.iter().for_each(|&sample| points[sample as usize] += 1.0);
        adjacent.as_flattened().iter().for_each(|&sample| degree[sample as usize] += 1.0);
        Self { cell, adjacent, points, degree }
    }

    /// Means over the cells of samples of what is known at points.
    fn means(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sums = vec![0.0; self.points.len()];
        self.cell.iter().zip(values).for_each(|(&sample, value)| sums[sample as usize] += value);
        sums.iter().zip(&self.points).map(|(sum, count)| sum / count.max(1.0)).collect()
    }

    /// How much the distances to neighbouring samples change, mean over these.
    fn strain(&self, own: &Matchable, image: &impl Fn(usize) -> Vector) -> Vec<f64> {
        let mut sums = vec![0.0; self.degree.len()];
        for &[s, t] in self.adjacent {
            let [i, j] = [s, t].map(|sample| own.coarse[sample as usize] as usize);
            let change = norm(minus(image(i), image(j))) - norm(minus(place(own, i), place(own, j)));
            [s, t].iter().for_each(|&sample| sums[sample as usize] += change.abs());
        }
        sums.iter().zip(&self.degree).map(|(sum, count)| sum / count.max(1.0)).collect()
    }

    /// Each sample's mean with its neighbours.
    fn averaged(&self, at_samples: &[f64]) -> Vec<f64> {
        let mut sums = at_samples.to_vec();
        for &[s, t] in self.adjacent {
            let (s, t) = (s as usize, t as usize);
            sums[s] += at_samples[t];
            sums[t] += at_samples[s];
        }
        sums.iter().zip(&self.degree).map(|(sum, count)| sum / (1.0 + count)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::descriptors::SampledSurface;
    use crate::network::Model;
    use crate::spectrum::SpectralBasis;

    /// Four points of a mesh in a row, all of them samples, with this prior each.
    fn row(prior: [f32; 4]) -> Matchable {
        let basis = SpectralBasis {
            eigenvalues: vec![0.0].into(),
            eigenvectors: Array2::ones((4, 1)),
            mass: vec![0.25; 4].into(),
        };
        let surface = SampledSurface {
            normals: vec![[0.0, 0.0, 1.0]; 4],
            oriented: true,
            cell: vec![0, 1, 2, 3],
            adjacent: vec![[0, 1], [1, 2], [2, 3]],
        };
        let learned = LearnedCues {
            limbs: Array2::from_shape_fn((4, 7), |(i, limb)| (10 * i + limb) as f64),
            prior: Some(Array2::from_shape_fn((4, 2), |(i, _)| prior[i])),
            category: Model::embedded().networks()[0].category().clone(),
        };
        Matchable {
            basis,
            points: Array2::from_shape_fn((4, 3), |(i, c)| if c == 0 { i as f64 } else { 0.0 }),
            features: Array2::zeros((4, 1)),
            learned: Some(learned),
            coarse: vec![0, 1, 2, 3],
            surface,
            share: 1.0,
        }
    }

    #[test]
    fn what_the_network_knows_of_the_point_itself_follows_the_general_cues() {
        let (own, other) = (row([-1.5, 0.25, 0.0, 2.0]), row([9.0; 4]));
        let across = [3, 2, 1, 0];
        let cues = Cues::of([&own, &other], [&across, &across], None);
        assert!(cues.meshes && cues.category.is_some());
        assert_eq!(cues.table.ncols(), GENERAL + 7 + 1);
        assert_eq!(cues.table.column(GENERAL + 2).to_vec(), [2.0, 12.0, 22.0, 32.0]);
        assert_eq!(cues.table.column(GENERAL + 7).to_vec(), [-1.5, 0.25, 0.0, 2.0]);
        let unknown = Cues::of([&Matchable { learned: None, ..own }, &other], [&across, &across], None);
        assert_eq!(unknown.table.ncols(), GENERAL);
        assert!(unknown.category.is_none());
    }
}
