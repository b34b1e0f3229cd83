//! What a match shows of its own faults, point by point.
//!
//! Wrong places come by regions (a hand shifted along its arm, an arm twisted about its axis), and a single point shows little of it: on held-out bodies the
//! way there and back alone tells right from wrong hardly better than chance. So each sign is averaged over a neighbourhood and over a region.
//! Where on the body a point lies says more (matches slide on a back, and not on a face), and that is what a network's features know: without it the area under curve
//! on held-out meshes was 0.836, with it 0.858 (version 2 of the weights). And a network gives two signs of its own: how unsure it is of a point's part, and how differently it speaks
//! of a point and of its match. Of 40 pairs each (version 6, coefficients fitted to other bodies of the generator) the area under curve without them, and with: held-out meshes 0.864, 0.879;
//! clouds 0.845, 0.867; meshes of another source 0.824, 0.850; clouds 0.845, 0.878. Of pieces, where the place on the body only says where they were cut and is left
//! out: 0.79 on meshes and 0.82 on clouds with it, 0.852 and 0.866 with these signs in its place (right is what ends near in a straight line; by geodesic distance, and
//! times overlap, 0.834 and 0.837).

use std::sync::Arc;

use ndarray::{Array2, ArrayView1, ArrayView2, ArrayViewMut2, s};

use crate::maps::Matchable;
use crate::network::{CUES, Category};
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
/// Signs that a network gives: unsure of the part, different features.
const LEARNED: usize = 2;
const _: () = assert!(GENERAL + LEARNED * (1 + STEPS.len()) == CUES);

/// Cues of one direction of a match; those that do not exist are 0.
#[derive(Clone, Debug)]
pub(crate) struct Cues {
    /// Rows (p): [`GENERAL`] cues; with a network also its two signs, each at the point, near and wide, the probability of each group of parts that is a cue of its category, and its
    /// prior.
    pub(crate) table: Array2<f64>,
    /// Whether the body was registered onto the other, so that there are residuals.
    pub(crate) registered: bool,
    /// Whether both are meshes whose faces agree on an outside.
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
        let learned = own.learned.as_ref().zip(other.learned.as_ref());
        let width = learned.map_or(GENERAL, |(learned, _)| CUES + learned.limbs.ncols() + 1);
        let mut table = Array2::zeros((p, width));
        for (sign, at_samples) in signs.into_iter().enumerate() {
            region.near_and_wide(at_samples, table.slice_mut(s![.., STEPS.len() * sign..]), |v| v.min(LONGEST).sqrt());
        }
        let meshes = own.surface.oriented && other.surface.oriented;
        if let Some((learned, of_other)) = learned {
            let unsure: Vec<f64> = learned.unsure.iter().map(|&unsure| f64::from(unsure)).collect();
            let different = (0..p).map(|i| learned.difference(i, of_other, there[i] as usize)).collect();
            for (sign, at_points) in [unsure, different].into_iter().enumerate() {
                let mut columns = table.slice_mut(s![.., GENERAL + (1 + STEPS.len()) * sign..]);
                columns.column_mut(0).assign(&ArrayView1::from(&at_points));
                region.near_and_wide(region.means(at_points.into_iter()), columns.slice_mut(s![.., 1..]), |v| v);
            }
            table.slice_mut(s![.., CUES..width - 1]).assign(&learned.limbs);
            if let Some(prior) = &learned.prior {
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

    /// Writes the averages of what is known at samples into the first columns, one for each of [`STEPS`], as `scale` has them.
    fn near_and_wide(&self, mut at_samples: Vec<f64>, mut columns: ArrayViewMut2<f64>, scale: impl Fn(f64) -> f64) {
        let mut done = 0;
        for (mut column, &steps) in columns.columns_mut().into_iter().zip(&STEPS) {
            (done..steps).for_each(|_| at_samples = self.averaged(&at_samples));
            done = steps;
            column.iter_mut().zip(self.cell).for_each(|(cue, &cell)| *cue = scale(at_samples[cell as usize]));
        }
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
    use crate::maps::LearnedCues;
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
            unsure: vec![0.0, 0.0, 0.0, 0.4],
            features: Arc::new(Array2::from_shape_fn((4, 4), |(i, c)| if i == c { 1.0 } else { 0.0 })),
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
        assert_eq!(cues.table.ncols(), CUES + 7 + 1);
        assert_eq!(cues.table.column(CUES + 2).to_vec(), [2.0, 12.0, 22.0, 32.0]);
        assert_eq!(cues.table.column(CUES + 7).to_vec(), [-1.5, 0.25, 0.0, 2.0]);
        // At the point, then less in ever more places.
        let unsure = [0, 1, 2].map(|wide| cues.table.column(GENERAL + wide).to_vec());
        assert_eq!(unsure[0], [0.0, 0.0, 0.0, f64::from(0.4_f32)]);
        assert!(unsure[1][3] > unsure[1][0] && unsure[1][0] > 0.0 && unsure[2][3] < unsure[1][3], "{unsure:?}");
        // Every point is matched to another, of which the network says something else; to itself it says the same.
        assert!(cues.table.column(GENERAL + 3).iter().all(|&unlike| (unlike - 2.0_f64.sqrt()).abs() < 1e-6));
        let same = [0, 1, 2, 3];
        assert!(Cues::of([&own, &other], [&same, &same], None).table.column(GENERAL + 3).iter().all(|&c| c == 0.0));
        let unknown = Cues::of([&Matchable { learned: None, ..own }, &other], [&across, &across], None);
        assert_eq!(unknown.table.ncols(), GENERAL);
        assert!(unknown.category.is_none());
    }
}
