//! Errors of a match on a mesh: how far from the truth, and how far from its mirror image.

use super::interval::mean;
use super::truth::Truth;
use crate::graph::{BoundedDijkstra, components};
use crate::maps::UNMATCHED;
use crate::shape::Shape;
use crate::uses::{EdgeDistances, point_errors};
use crate::vector::{Vector, squared_distance};

/// A mesh on which errors are measured.
pub(super) struct Ruler {
    distances: EdgeDistances,
    points: Vec<Vector>,
    /// What a point that has no distance counts as, in √area.
    worst: f64,
}

/// Errors of a match, one per line of the ground truth.
pub(super) struct Errors {
    /// Vertices where the match ends; [`UNMATCHED`] where it does not.
    predicted: Vec<u32>,
    /// In √area.
    each: Vec<f64>,
}

impl Ruler {
    /// For a mesh with faces.
    pub(super) fn new(mesh: &Shape) -> Self {
        let distances = EdgeDistances::new(mesh);
        let worst = longest_way(&distances) / distances.root_area();
        Self { distances, points: mesh.points().to_vec(), worst }
    }

    /// How far each prediction of `found` (a point of B, or [`UNMATCHED`], per point of A) of each line is from the truth.
    /// An unmatched point, or one on a piece that no path joins to the truth, has no distance; leaving it out would
    /// reward silence, so it counts as the longest way there is on the mesh. One search from a true point serves all of `found`.
    pub(super) fn errors<const M: usize>(&self, truth: &Truth, found: [&[u32]; M]) -> [Errors; M] {
        let vertex = |target: u32| match &truth.vertex_of {
            Some(vertex_of) if target != UNMATCHED => vertex_of[target as usize],
            _ => target,
        };
        let predicted = found.map(|found| truth.lines.iter().map(|&(i, _)| vertex(found[i as usize])).collect());
        let pairs: Vec<(u32, u32)> = predicted
            .iter()
            .flat_map(|predicted: &Vec<u32>| predicted.iter().zip(&truth.lines).map(|(&p, &(_, t))| (p, t)))
            .collect();
        let mut each = point_errors(&self.distances, &pairs);
        each.iter_mut().filter(|e| e.is_infinite()).for_each(|e| *e = self.worst);
        let mut each = each.into_iter();
        predicted.map(|predicted| Errors { each: each.by_ref().take(predicted.len()).collect(), predicted })
    }

    /// The share of lines whose prediction is farther than `length` (unit of the mesh) from the truth, or missing. Where no path joins the two, as between
    /// clothes and the skin below, the straight line counts.
    pub(super) fn farther_than(&self, errors: &Errors, truth: &Truth, length: f64) -> f64 {
        let far = |((&p, &(_, t)), &e): ((&u32, &(u32, u32)), &f64)| {
            p == UNMATCHED
                || squared_distance(self.points[p as usize], self.points[t as usize]).sqrt() > length
                || e < self.worst && e * self.distances.root_area() > length
        };
        let lines = errors.predicted.iter().zip(&truth.lines).zip(&errors.each);
        lines.filter(|&line| far(line)).count() as f64 / errors.each.len().max(1) as f64
    }

    /// Whether the match as a whole is nearer to the mirrored truth, over the lines that have one: `mirrored` is (line, vertex).
    pub(super) fn is_flipped(&self, errors: &Errors, mirrored: &[(usize, u32)]) -> bool {
        let total: f64 = mirrored.iter().map(|&(line, _)| errors.each[line]).sum();
        // No path is shorter than the straight line: for a match the right way round that settles it without a single
        // search.
        let straight = |&(line, m): &(usize, u32)| match errors.predicted[line] {
            UNMATCHED => self.worst,
            p => squared_distance(self.points[p as usize], self.points[m as usize]).sqrt() / self.distances.root_area(),
        };
        if mirrored.iter().map(straight).sum::<f64>() >= total {
            return false;
        }
        let pairs: Vec<(u32, u32)> = mirrored.iter().map(|&(line, m)| (errors.predicted[line], m)).collect();
        let from_mirrored = point_errors(&self.distances, &pairs);
        from_mirrored.into_iter().map(|e| if e.is_infinite() { self.worst } else { e }).sum::<f64>() < total
    }

    /// The share of `mirrored` lines whose prediction is nearer to the mirrored truth than to the truth.
    pub(super) fn flipped_points(&self, errors: &Errors, mirrored: &[(usize, u32)]) -> f64 {
        let mut by_mirrored = mirrored.to_vec();
        by_mirrored.sort_unstable_by_key(|&(_, m)| m);
        let mut search = BoundedDijkstra::new(self.distances.graph());
        let mut nearer = 0;
        for row in by_mirrored.chunk_by(|x, y| x.1 == y.1) {
            // Only what is nearer than the truth matters: look no farther.
            let farthest = row.iter().map(|&(line, _)| errors.each[line]).fold(0.0, f64::max);
            let reached = search.search(row[0].1, farthest * self.distances.root_area());
            nearer += row
                .iter()
                .filter(|&&(line, _)| {
                    let predicted = errors.predicted[line];
                    predicted != UNMATCHED && reached.to(predicted) / self.distances.root_area() < errors.each[line]
                })
                .count();
        }
        nearer as f64 / mirrored.len().max(1) as f64
    }
}

impl Errors {
    /// AGE: mean error × 100.
    pub(super) fn age(&self) -> f64 {
        100.0 * self.each.iter().sum::<f64>() / self.each.len().max(1) as f64
    }

    /// The same over lines whose point got a partner; nothing where none did.
    pub(super) fn age_of_matched(&self) -> Option<f64> {
        let matched = self.predicted.iter().zip(&self.each).filter(|(p, _)| **p != UNMATCHED);
        Some(100.0 * mean(matched.map(|(_, &e)| e))?)
    }

    /// Whether the error of each line is at most `threshold` (in √area).
    pub(super) fn within(&self, threshold: f64) -> impl Iterator<Item = bool> + '_ {
        self.each.iter().map(move |&e| e <= threshold)
    }

    /// The share of lines with an error of at most `threshold` (in √area).
    pub(super) fn accuracy(&self, threshold: f64) -> f64 {
        self.within(threshold).filter(|&within| within).count() as f64 / self.each.len().max(1) as f64
    }
}

/// The longest shortest path that two sweeps find in any piece, in the unit of the mesh: from the lowest vertex to the
/// farthest one, and from there to the farthest one. On a body that is head to foot or hand to foot.
fn longest_way(distances: &EdgeDistances) -> f64 {
    let graph = distances.graph();
    let (piece, pieces) = components(graph.len(), graph.edges().map(|(i, j, _)| (i, j)));
    let mut search = BoundedDijkstra::new(graph);
    let mut farthest = |from: u32| {
        let reached = search.search(from, f64::INFINITY);
        let ways = (0..graph.len() as u32).map(|j| (reached.to(j), j)).filter(|(way, _)| way.is_finite());
        ways.fold((0.0, from), |best, way| if way.0 > best.0 { way } else { best })
    };
    let mut seen = vec![false; pieces];
    let mut longest = 0.0_f64;
    for (i, &piece) in piece.iter().enumerate() {
        if !std::mem::replace(&mut seen[piece as usize], true) {
            let (_, end) = farthest(i as u32);
            longest = longest.max(farthest(end).0);
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::{Ruler, Truth, UNMATCHED};
    use crate::shape::Shape;

    /// A ladder of two rows of 30 points, one unit apart, and beside it one of 10: areas 29 and 9, longest ways 28 + √2
    /// and 8 + √2.
    fn ladders() -> Shape {
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for (count, aside) in [(30, 0.0), (10, 5.0)] {
            for i in 0..count {
                let first = points.len() as u32;
                points.extend([[f64::from(i), aside, 0.0], [f64::from(i), aside + 1.0, 0.0]]);
                if i + 1 < count {
                    faces.extend([[first, first + 2, first + 3], [first, first + 3, first + 1]]);
                }
            }
        }
        Shape::new(points, faces, None).expect("a mesh")
    }

    fn truth(lines: &[(u32, u32)]) -> Truth {
        Truth { lines: lines.to_vec(), mirrored: None, vertex_of: None, scale: None, paired: None }
    }

    /// A mirrored truth of every line.
    fn mirrored(vertices: &[u32]) -> Vec<(usize, u32)> {
        vertices.iter().copied().enumerate().collect()
    }

    #[test]
    fn what_has_no_distance_counts_as_the_longest_way() {
        let ruler = Ruler::new(&ladders());
        let root_area = 38.0_f64.sqrt();
        // Right; two steps off; unmatched; on the other piece.
        let [errors] = ruler.errors(&truth(&[(0, 0), (1, 4), (2, 4), (3, 4)]), [&[0, 8, UNMATCHED, 70]]);
        let longest = 28.0 + 2.0_f64.sqrt();
        let wanted = [0.0, 2.0, longest, longest].map(|way| way / root_area);
        assert!(errors.each.iter().zip(wanted).all(|(e, w)| (e - w).abs() < 1e-12), "{:?} {wanted:?}", errors.each);
        assert_eq!(errors.accuracy(0.5), 0.5);
        let of_matched = 100.0 * (2.0 + longest) / 3.0 / root_area;
        assert!((errors.age_of_matched().unwrap() - of_matched).abs() < 1e-9, "{:?}", errors.age_of_matched());
        // Unmatched, and across a gap of five units, where the straight line counts.
        let lines = truth(&[(0, 0), (1, 4), (2, 4), (3, 4)]);
        let [of_lines] = ruler.errors(&lines, [&[0, 8, UNMATCHED, 64]]);
        assert_eq!([1.0, 5.5].map(|length| ruler.farther_than(&of_lines, &lines, length)), [0.75, 0.25]);
        // Neither of the last two is any nearer to its mirror image, whatever that is.
        assert_eq!(ruler.flipped_points(&errors, &mirrored(&[0, 4, 4, 4])), 0.0);
        assert!(!ruler.is_flipped(&errors, &mirrored(&[0, 4, 4, 4])));
        // Of the others, one on the very spot, and one on the piece where the prediction is.
        assert_eq!(ruler.flipped_points(&errors, &mirrored(&[0, 8, 4, 72])), 0.5);
        assert!(ruler.is_flipped(&errors, &mirrored(&[0, 8, 4, 72])));
        // Lines without a mirrored truth have no say: the second and third are right or no nearer, the fourth is on the spot.
        assert_eq!(ruler.flipped_points(&errors, &[(1, 8), (2, 4), (3, 70)]), 2.0 / 3.0);
        assert!(ruler.is_flipped(&errors, &[(3, 70)]) && !ruler.is_flipped(&errors, &[(0, 6), (2, 4)]));
    }

    #[test]
    fn a_pair_is_flipped_when_paths_and_not_straight_lines_say_so() {
        // Two prongs joined at one end: the tips are two units apart in space and 58 along the mesh.
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for i in 0..60u32 {
            let (x, y) = if i < 30 { (f64::from(i), 0.0) } else { (f64::from(59 - i), 2.0) };
            points.extend([[x, y, 0.0], [x, y, 1.0]]);
            if i < 59 {
                faces.extend([[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]);
            }
        }
        let ruler = Ruler::new(&Shape::new(points, faces, None).expect("a mesh"));
        // The prediction is the first tip, the truth ten steps up its prong, the mirrored truth the tip of the other
        // prong.
        let [errors] = ruler.errors(&truth(&[(0, 20)]), [&[0]]);
        assert!(!ruler.is_flipped(&errors, &mirrored(&[118])));
        assert_eq!(ruler.flipped_points(&errors, &mirrored(&[118])), 0.0);
        // Nine steps up the same prong is nearer than ten.
        assert!(ruler.is_flipped(&errors, &mirrored(&[18])));
        assert_eq!(ruler.flipped_points(&errors, &mirrored(&[18])), 1.0);
    }
}
