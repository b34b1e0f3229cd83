//! A surface with points of its own between the uploaded ones, where these are too far apart or too uneven to carry a basis.

use std::collections::BTreeMap;

use super::Shape;
use crate::vector::squared_distance;

/// A surface with more points than were uploaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Resampled {
    /// The uploaded points in their order, then those that were added; labels, too.
    pub shape: Shape,
    /// For each added point the uploaded one that stands for it.
    pub stands_for: Vec<u32>,
}

impl Resampled {
    fn of(shape: &Shape, added: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, stands_for: Vec<u32>) -> Self {
        let all =
            |labels: &[u32]| labels.iter().copied().chain(stands_for.iter().map(|&i| labels[i as usize])).collect();
        let labels = shape.labels().map(all);
        let points = [shape.points(), &added].concat();
        Self {
            shape: Shape::already_valid(points, faces, labels).with_placeless(shape.placeless().to_vec()),
            stands_for,
        }
    }

    /// The same points with other faces.
    pub(crate) fn without_added(shape: &Shape, faces: Vec<[u32; 3]>) -> Self {
        Self::of(shape, Vec::new(), faces, Vec::new())
    }

    /// From tables of a stored one, if they fit together.
    pub(crate) fn from_tables(
        shape: &Shape,
        added: Vec<[f64; 3]>,
        faces: Vec<[u32; 3]>,
        stands_for: Vec<u32>,
    ) -> Option<Self> {
        let n = shape.points().len();
        let below = |indices: &[u32], limit: usize| indices.iter().all(|&i| (i as usize) < limit);
        let fits =
            added.len() == stands_for.len() && below(&stands_for, n) && below(faces.as_flattened(), n + added.len());
        fits.then(|| Self::of(shape, added, faces, stands_for))
    }

    /// The uploaded point that stands for a point.
    pub fn uploaded(&self, point: u32) -> u32 {
        let n = self.shape.points().len() - self.stands_for.len();
        (point as usize).checked_sub(n).map_or(point, |added| self.stands_for[added])
    }
}

/// Pieces that long edges alone may make of a surface, as a multiple of those that its area makes.
const SLIVERS: f64 = 16.0;
/// A sliver has two long edges and is cut into three pieces whenever those are halved: log₂ 3 is the power of their length that it is cut into.
const CUT_IN_THREE: f64 = 1.585;
/// Pieces that every surface may be cut into.
const FEW: f64 = 4000.0;

/// The faces of a welded shape halved until no edge is longer than `longest`, or than what slivers, which have long edges and hardly any area, can be cut to in a
/// number of pieces that goes with the area. Both faces at an edge are cut at one new point, so what hung together still does.
pub fn resampled(shape: &Shape, longest: f64) -> Resampled {
    let n = shape.points().len();
    let longest_side = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|i| shape.points()[i as usize]);
        [(a, b), (b, c), (c, a)].map(|(p, q)| squared_distance(p, q)).into_iter().fold(0.0, f64::max).sqrt()
    };
    let long = shape.faces().iter().map(longest_side).filter(|&side| side > longest);
    let long: f64 = long.map(|side| side.powf(CUT_IN_THREE)).sum();
    let pieces = (shape.surface_area() / (longest * longest)).max(FEW);
    let longest = longest.max((long / (SLIVERS * pieces)).powf(1.0 / CUT_IN_THREE));
    let mut points = shape.points().to_vec();
    let mut stands_for: Vec<u32> = Vec::new();
    let mut faces = shape.faces().to_vec();
    let squared = longest * longest;
    let mut done = Vec::with_capacity(faces.len());
    while !faces.is_empty() {
        // New points are numbered in the order of the faces, so that one shape is always cut alike.
        let mut middles: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut cut = Vec::with_capacity(2 * faces.len());
        for [a, b, c] in faces {
            let mut middle = |i: u32, j: u32| {
                let [p, q] = [i, j].map(|corner| points[corner as usize]);
                let between: [f64; 3] = std::array::from_fn(|x| 0.5 * (p[x] + q[x]));
                // Between neighbouring numbers there is none.
                let cut = squared_distance(p, q) > squared && between != p && between != q;
                cut.then(|| {
                    *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                        points.push(between);
                        let end = i.min(j);
                        stands_for.push((end as usize).checked_sub(n).map_or(end, |added| stands_for[added]));
                        points.len() as u32 - 1
                    })
                })
            };
            match [middle(a, b), middle(b, c), middle(c, a)] {
                [None, None, None] => done.push([a, b, c]),
                [Some(ab), None, None] => cut.extend([[a, ab, c], [ab, b, c]]),
                [None, Some(bc), None] => cut.extend([[b, bc, a], [bc, c, a]]),
                [None, None, Some(ca)] => cut.extend([[c, ca, b], [ca, a, b]]),
                [Some(ab), Some(bc), None] => cut.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]),
                [None, Some(bc), Some(ca)] => cut.extend([[bc, c, ca], [b, bc, ca], [b, ca, a]]),
                [Some(ab), None, Some(ca)] => cut.extend([[ca, a, ab], [c, ca, ab], [c, ab, b]]),
                [Some(ab), Some(bc), Some(ca)] => {
                    cut.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
                }
            }
        }
        faces = cut;
    }
    let added = points.split_off(n);
    Resampled::of(shape, added, done, stands_for)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::{Shape, resampled};

    #[test]
    fn slivers_are_cut_into_no_more_pieces_than_their_area_asks_for() {
        for width in [0.0, 1e-12, 1e-6, 1e-3] {
            let points = (0..60).map(|i| [1e6 * f64::from(i / 2), width * f64::from(i % 2), 0.0]).collect();
            let strip = Shape::already_valid(points, (0..58).map(|i| [i, i + 1, i + 2]).collect(), None);
            let longest = (strip.surface_area() / 4000.0).sqrt();
            assert!(resampled(&strip, longest).shape.points().len() < 200_000, "{width}");
        }
    }

    #[test]
    fn edges_between_neighbouring_numbers_are_not_cut() {
        let points = (0..64).map(|i| [1e16 + f64::from(2 * (i % 8)), 1e16 + f64::from(2 * (i / 8)), 0.0]).collect();
        let faces = (0..55).flat_map(|i| [[i, i + 1, i + 9], [i, i + 9, i + 8]]).collect();
        let sheet = Shape::already_valid(points, faces, None);
        assert!(resampled(&sheet, 0.01).shape.points().len() < 10_000);
    }

    #[test]
    fn a_box_of_twelve_triangles_becomes_a_fine_closed_one_of_the_same_area() {
        let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let coarse = Shape::already_valid((0..8).map(corner).collect(), faces, Some((0..8).collect()));
        let fine = resampled(&coarse, 0.1);
        assert!((fine.shape.surface_area() - 6.0).abs() < 1e-9);
        assert_eq!(fine.shape.points()[..8], coarse.points()[..]);
        assert!(fine.shape.points().len() > 600);
        let mut edges = BTreeMap::new();
        for [a, b, c] in fine.shape.faces() {
            for (i, j) in [(a, b), (b, c), (c, a)] {
                *edges.entry((i.min(j), i.max(j))).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|&faces| faces == 2), "it stays closed");
        let labels = fine.shape.labels().expect("labels");
        for (i, &label) in labels.iter().enumerate() {
            assert_eq!(label, fine.uploaded(i as u32), "a label is that of the point that stands for it");
        }
    }
}
