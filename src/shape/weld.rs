//! Points that are one point of the surface although a scan holds them several times: copies at exactly one place, as the corners of triangle soup and the
//! split vertices at texture seams are, and the two sides of a seam whose coordinates were rounded apart.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::graph::Forest;
use crate::vector::squared_distance;

/// Corners at open borders that are nearer to each other than this part of the shortest edge at either of them are one corner.
const SEAM: f64 = 0.1;
/// Nor are corners told apart that lie within this many steps of single precision, as long as that is well below the edges.
const STEPS: f64 = 4.0;
/// That is, below this part of the shortest edge.
const BELOW_EDGES: f64 = 0.4;
/// Corners at a border that are looked at from each: triangle soup has six at a place.
const AT_A_PLACE: NonZero<usize> = NonZero::new(16).unwrap();

/// For each point (n) the first one that is the same point of the surface, and how many points are so without lying at exactly one place. `first` are the first
/// points at exactly their places.
pub(super) fn joined(points: &[[f64; 3]], faces: &[[u32; 3]], first: Vec<u32>) -> (Vec<u32>, usize) {
    if faces.is_empty() {
        return (first, 0);
    }
    let (border, mut tolerance) = border(points, faces, &first);
    let reach = points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    for edge in &mut tolerance {
        *edge = (SEAM * *edge).max(STEPS * f64::from(f32::EPSILON) * reach).min(BELOW_EDGES * *edge);
    }
    let places: Vec<[f64; 3]> = border.iter().map(|&i| points[i as usize]).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return (first, 0) };
    let mut forest = Forest::new(points.len());
    for (at, place) in places.iter().enumerate() {
        for near in tree.query(place).nearest_n::<SquaredEuclidean<f64>>(AT_A_PLACE).execute() {
            let other = near.item as usize;
            if other != at && near.distance <= tolerance[at].min(tolerance[other]).powi(2) {
                forest.join(border[at], border[other]);
            }
        }
    }
    let mut seams = 0;
    let joined = first
        .iter()
        .map(|&place| {
            let root = forest.root(place);
            seams += usize::from(root != place);
            root
        })
        .collect();
    (joined, seams)
}

/// Corners at edges of a single face, ascending, and the shortest edge at each. Faces meet at the `first` points of their corners.
fn border(points: &[[f64; 3]], faces: &[[u32; 3]], first: &[u32]) -> (Vec<u32>, Vec<f64>) {
    let mut sides: Vec<(u32, u32)> = Vec::with_capacity(3 * faces.len());
    for [a, b, c] in welded(faces, first) {
        sides.extend([(a, b), (b, c), (c, a)].map(|(i, j)| (i.min(j), i.max(j))));
    }
    sides.sort_unstable();
    let mut at_border = vec![false; points.len()];
    for edge in sides.chunk_by(|x, y| x == y).filter(|edge| edge.len() == 1) {
        (at_border[edge[0].0 as usize], at_border[edge[0].1 as usize]) = (true, true);
    }
    let mut border = Vec::with_capacity(at_border.iter().filter(|at_border| **at_border).count());
    border.extend((0..points.len() as u32).filter(|&i| at_border[i as usize]));
    let mut shortest = vec![f64::INFINITY; border.len()];
    if !border.is_empty() {
        for (i, j) in sides {
            let length = squared_distance(points[i as usize], points[j as usize]).sqrt();
            for at in [i, j].into_iter().filter_map(|end| border.binary_search(&end).ok()) {
                shortest[at] = shortest[at].min(length);
            }
        }
    }
    (border, shortest)
}

/// For each point (n) the first one at exactly its place; −0 equals 0. A place that is no number is that of its point alone.
pub(super) fn first_at_place(points: &[[f64; 3]]) -> Vec<u32> {
    let key = |i: u32| points[i as usize].map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut first = vec![0; points.len()];
    for place in order.chunk_by(|&i, &j| key(i) == key(j)) {
        place.iter().for_each(|&i| first[i as usize] = place[0]);
    }
    first
}

/// The faces with every corner moved to the `first` point at its place, without those of which two corners meet there.
pub(super) fn weld(faces: &[[u32; 3]], first: &[u32]) -> Vec<[u32; 3]> {
    welded(faces, first).collect()
}

/// The same, one after the other.
pub(super) fn welded(faces: &[[u32; 3]], first: &[u32]) -> impl Iterator<Item = [u32; 3]> + Clone {
    let moved = faces.iter().map(|face| face.map(|i| first[i as usize]));
    moved.filter(|[a, b, c]| a != b && b != c && c != a)
}
