//! From the points used to every uploaded point.

use std::collections::BTreeMap;

use ndarray::Array2;

use crate::graph::{Neighbours, nearest_neighbours};
use crate::maps::{Correspondence, UNMATCHED};
use crate::registration::{Rotation, best_rotation_and_certainty, turned};
use crate::shape::{Shape, Support};
use crate::vector::{minus, plus, squared_distance};

/// Neighbours whose matches say how the surface turns around a point used.
const AROUND: usize = 8;
/// Cells that are searched for the point nearest to an image.
const CELLS: usize = 4;
/// Of two points used, the one is a neighbour for the map only if their images are at most this many times farther apart than they are: limbs that only
/// touch part here.
const STRETCH: f64 = 3.0;

/// A turn determined less than this is none: where images fall together, rounding would choose it.
const CERTAIN: f64 = 1e-3;

/// A scan, and which of its points took part in a match.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'s> {
    /// All of its points.
    pub shape: &'s Shape,
    /// Which of its points were used.
    pub support: &'s Support,
    /// √area, in the unit of the scan.
    pub scale: f64,
}

/// The match of every uploaded point of `from` to an uploaded point of `to`, from `matched` between the points used.
///
/// Around each point used the map is a rigid motion, fitted to the matches of its neighbours; an uploaded point goes where the motions of the points used
/// near it take it, and then to the nearest uploaded point of those that belong to their images and those next to them. So fingers of a dense
/// scan do not stick to the leg they hang beside. `parts` are part labels of all uploaded points, of `from` and of `to`: a point stays in its part wherever
/// a point of that part is near. Copies of a point go with the first of them, and nothing goes to another than the first.
pub fn lift(matched: &Correspondence, from: Sampled, to: Sampled, parts: Option<(&[u32], &[u32])>) -> Correspondence {
    if *from.support == Support::default() && *to.support == Support::default() {
        return matched.clone();
    }
    let (labels_from, labels_to) = parts.unzip();
    let first = first_alike(from, labels_from);
    let (source, target) = (Cells::new(from, &first), Cells::new(to, &first_alike(to, labels_to)));
    let target_of = |row: usize| matched.target[row] as usize;
    let motions: Vec<Motion> =
        (0..source.points.len()).map(|row| Motion::around(row, &source, &target, &target_of)).collect();

    let n = from.shape.points().len();
    let mut lifted = Correspondence { target: vec![UNMATCHED; n], confidence: vec![0.0; n] };
    // Points that share a point used share the places they may go to, so these are laid side by side once.
    let mut cells: Vec<Cell> = Vec::new();
    let mut places: Vec<([f64; 3], u32)> = Vec::new();
    for (row, motion) in motions.iter().enumerate() {
        let mut images: Vec<usize> =
            std::iter::once(&row).chain(&motion.neighbours).map(|&near| target_of(near)).collect();
        images.extend(target.near(target_of(row)));
        images.sort_unstable();
        images.dedup();
        cells.clear();
        places.clear();
        for image in images {
            let start = places.len();
            places.extend(target.cell(image).iter().map(|&j| (to.shape.points()[j as usize], j)));
            cells.push(Cell { middle: target.points[image], places: start..places.len(), squared: 0.0 });
        }
        let reach = (motion.spacing * motion.spacing).max(f64::MIN_POSITIVE);
        for &i in source.cell(row) {
            let x = from.shape.points()[i as usize];
            let (mut image, mut total) = ([0.0; 3], 0.0);
            for &near in std::iter::once(&row).chain(&motion.neighbours) {
                let weight = (-0.5 * squared_distance(x, source.points[near]) / reach).exp();
                let moved = motions[near].apply(x, source.points[near], target.points[target_of(near)]);
                (0..3).for_each(|c| image[c] += weight * moved[c]);
                total += weight;
            }
            if total >= f64::MIN_POSITIVE {
                image.iter_mut().for_each(|c| *c /= total);
            } else {
                // So far from all of them that no weight is left: the nearest one's motion alone.
                image = motion.apply(x, source.points[row], target.points[target_of(row)]);
            }
            // Cells whose middle is far from the image hold nothing nearer.
            cells.iter_mut().for_each(|cell| cell.squared = squared_distance(cell.middle, image));
            cells.sort_unstable_by(|a, b| a.squared.total_cmp(&b.squared));
            let nearest = |cells: &[Cell], allowed: &dyn Fn(u32) -> bool| {
                let near = cells.iter().flat_map(|cell| &places[cell.places.clone()]);
                let distances =
                    near.filter(|(_, j)| allowed(*j)).map(|&(place, j)| (squared_distance(place, image), j));
                distances.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, j)| j)
            };
            let close = &cells[..CELLS.min(cells.len())];
            let own = match parts {
                Some((of_from, of_to)) => nearest(&cells, &|j| of_from[i as usize] == of_to[j as usize]),
                None => None,
            };
            let found = own.or_else(|| nearest(close, &|_| true));
            lifted.target[i as usize] = found.unwrap_or(to.support.uploaded(target_of(row)) as u32);
            lifted.confidence[i as usize] = matched.confidence[row];
        }
    }
    for (i, first) in first.into_iter().enumerate() {
        lifted.target[i] = lifted.target[first as usize];
        lifted.confidence[i] = lifted.confidence[first as usize];
    }
    lifted
}

/// For each uploaded point the first one at its place, and with its label where labels count.
fn first_alike(shape: Sampled, labels: Option<&[u32]>) -> Vec<u32> {
    let mut first = shape.shape.first_at_place().to_vec();
    if let Some(labels) = labels {
        let mut firsts = BTreeMap::new();
        for (i, (first, &label)) in (0..).zip(first.iter_mut().zip(labels)) {
            *first = *firsts.entry((*first, label)).or_insert(i);
        }
    }
    first
}

/// Uploaded points of the other scan that one of its points used stands for.
struct Cell {
    middle: [f64; 3],
    places: std::ops::Range<usize>,
    /// Of the middle to the image at hand.
    squared: f64,
}

/// Whether each uploaded point can have no match.
fn flags(shape: Sampled) -> Vec<bool> {
    let mut unmatched = vec![false; shape.shape.points().len()];
    shape.support.unmatched.iter().flatten().for_each(|&i| unmatched[i as usize] = true);
    unmatched
}

/// A scan as its points used, each with its neighbours and the uploaded points it stands for, without copies.
struct Cells {
    points: Vec<[f64; 3]>,
    /// √area.
    scale: f64,
    neighbours: Neighbours,
    starts: Vec<usize>,
    members: Vec<u32>,
}

impl Cells {
    /// `first` names for each uploaded point the one it is a copy of, or itself.
    fn new(shape: Sampled, first: &[u32]) -> Self {
        let points: Vec<[f64; 3]> = (0..shape.support.points_used(shape.shape.points().len()))
            .map(|row| shape.shape.points()[shape.support.uploaded(row)])
            .collect();
        let neighbours = nearest_neighbours(&points, AROUND);
        let mut starts = vec![0; points.len() + 1];
        let unmatched = flags(shape);
        let matched = || (0..first.len()).filter(|&i| first[i] as usize == i && !unmatched[i]);
        matched().for_each(|i| starts[shape.support.row_of(i) + 1] += 1);
        (0..points.len()).for_each(|row| starts[row + 1] += starts[row]);
        let mut next = starts.clone();
        let mut members = vec![0; starts[points.len()]];
        for i in matched() {
            let slot = &mut next[shape.support.row_of(i)];
            members[*slot] = i as u32;
            *slot += 1;
        }
        Self { points, scale: shape.scale, neighbours, starts, members }
    }

    /// Uploaded points that a point used stands for, one at each place.
    fn cell(&self, row: usize) -> &[u32] {
        &self.members[self.starts[row]..self.starts[row + 1]]
    }

    /// Points used next to one.
    fn near(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        self.neighbours.of(row).iter().map(|&j| j as usize)
    }
}

/// How the surroundings of a point used are turned on their way to the other scan.
struct Motion {
    rotation: Rotation,
    /// From lengths of the one scan to lengths of the other; 0 where too few neighbours agree to tell how things turn.
    scale: f64,
    /// Neighbours that the map keeps near.
    neighbours: Vec<usize>,
    /// Mean distance to the neighbours.
    spacing: f64,
}

impl Motion {
    fn around(row: usize, source: &Cells, target: &Cells, target_of: &impl Fn(usize) -> usize) -> Self {
        let (x, y) = (source.points[row], target.points[target_of(row)]);
        let scale = target.scale / source.scale;
        let limit = (STRETCH * scale).powi(2);
        let neighbours: Vec<usize> = source
            .near(row)
            .filter(|&near| {
                let after = squared_distance(target.points[target_of(near)], y);
                after <= limit * squared_distance(source.points[near], x)
            })
            .collect();
        let table = |at: &dyn Fn(usize) -> [f64; 3]| {
            Array2::from_shape_fn((neighbours.len(), 3), |(r, c)| at(neighbours[r])[c])
        };
        let (from, to) =
            (table(&|near| minus(source.points[near], x)), table(&|near| minus(target.points[target_of(near)], y)));
        let (rotation, _, certainty) = best_rotation_and_certainty(from.view(), to.view());
        let spacing = source.neighbours.mean_distance_from(row);
        let scale = if neighbours.len() < 3 || certainty < CERTAIN { 0.0 } else { scale };
        Self { rotation, scale, neighbours, spacing }
    }

    fn apply(&self, point: [f64; 3], centre: [f64; 3], image: [f64; 3]) -> [f64; 3] {
        let offset = minus(point, centre).map(|c| c * self.scale);
        plus(image, turned(&self.rotation, offset))
    }
}

#[cfg(test)]
mod tests {
    use super::{Correspondence, Sampled, Shape, Support, lift};

    #[test]
    fn a_point_so_far_that_no_weight_is_left_goes_where_the_nearest_motion_takes_it() {
        // Sixty points used, a thousandth apart, and one thousand spacings away from them that is not.
        let mut points: Vec<[f64; 3]> = (0..60)
            .map(|i| [0.001 * f64::from(i % 10), 0.0013 * f64::from(i / 10), 1e-4 * f64::from(i * i % 7)])
            .collect();
        points.push([1.0, 0.0, 0.0]);
        let shape = Shape::new(points, Vec::new(), None).expect("a cloud");
        let mut carrier_of: Vec<u32> = (0..60).collect();
        carrier_of.push(9);
        let support = Support { carriers: Some((0..60).collect()), carrier_of: Some(carrier_of), ..Support::default() };
        let scan = Sampled { shape: &shape, support: &support, scale: 0.01 };
        let itself = Correspondence { target: (0..60).collect(), confidence: vec![1.0; 60] };
        let lifted = lift(&itself, scan, scan, None);
        assert_eq!(lifted.target, (0..61).collect::<Vec<u32>>());
    }
}
