//! Faces that lead off the surface: spikes to points that a camera measured wrongly, and curtains from what is in front to what is behind.

use super::Shape;
use crate::graph::EdgeGraph;
use crate::vector::{cross, middle_side, minus, norm, plus};

/// An edge is long where it has this many times the length that is usual around it.
const LONG: f64 = 8.0;
/// Faces around a vertex lie in one plane where their vector areas add up to this part of their areas: a hole is often closed by such a fan.
const FLAT: f64 = 0.9;
/// And this part of the longest side of the box around the middle 98 % of the points.
const AT_LEAST: f64 = 0.03;

/// The faces of a welded mesh that are part of its surface, if not all are.
///
/// A spike is a vertex of which all edges are long for those it is joined to. A curtain is an edge that is long for both of its ends: half of the edges of each
/// are shorter by far, so that long thin triangles along a limb are none.
pub fn without_spikes(shape: &Shape) -> Option<Vec<[u32; 3]>> {
    let graph = EdgeGraph::of_faces(shape.points(), shape.faces());
    let usual: Vec<f64> = (0..graph.len()).map(|i| median(graph.lengths(i).to_vec())).collect();
    let in_faces = shape.points().iter().zip(&usual).filter(|(_, usual)| **usual > 0.0).map(|(p, _)| *p);
    let at_least = AT_LEAST * middle_side(in_faces);
    let flat = flat_fans(shape);
    let spike: Vec<bool> = (0..graph.len())
        .map(|i| {
            let shortest = graph.lengths(i).iter().copied().fold(f64::INFINITY, f64::min);
            let around = || median(graph.neighbours(i).iter().map(|&j| usual[j as usize]).collect());
            shortest.is_finite() && shortest > at_least && !flat[i] && shortest > LONG * around()
        })
        .collect();
    let long = |i: u32, j: u32| {
        let at = graph.neighbours(i as usize).binary_search(&j);
        let length = at.map_or(0.0, |at| graph.lengths(i as usize)[at]);
        length > at_least && length > LONG * usual[i as usize].max(usual[j as usize])
    };
    let on_surface = |&[a, b, c]: &[u32; 3]| {
        ![a, b, c].iter().any(|&i| spike[i as usize]) && !long(a, b) && !long(b, c) && !long(c, a)
    };
    let kept: Vec<[u32; 3]> = shape.faces().iter().copied().filter(on_surface).collect();
    (kept.len() < shape.faces().len()).then_some(kept)
}

/// Whether the faces around each vertex lie in one plane.
fn flat_fans(shape: &Shape) -> Vec<bool> {
    let mut areas = vec![([0.0; 3], 0.0); shape.points().len()];
    for &face in shape.faces() {
        let [a, b, c] = face.map(|i| shape.points()[i as usize]);
        let vector = cross(minus(b, a), minus(c, a));
        for i in face {
            let (sum, all) = &mut areas[i as usize];
            (*sum, *all) = (plus(*sum, vector), *all + norm(vector));
        }
    }
    areas.into_iter().map(|(sum, all)| norm(sum) >= FLAT * all).collect()
}

/// The lower one of two in the middle: at the corner of a sheet a curtain has as many edges as the sheet.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len().saturating_sub(1) / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::{Shape, without_spikes};

    /// A sheet of 30 × 30 points one apart, bent.
    fn sheet() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let at = |x: u32, y: u32| 30 * y + x;
        let points =
            (0..900).map(|i| [f64::from(i % 30), f64::from(i / 30), 0.02 * f64::from(i % 30).powi(2)]).collect();
        let squares = (0..29).flat_map(|y| (0..29).map(move |x| (x, y)));
        let faces = squares.flat_map(|(x, y)| {
            [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]]
        });
        (points, faces.collect())
    }

    #[test]
    fn a_spike_is_cut_and_a_sheet_is_whole() {
        let (mut points, faces) = sheet();
        assert_eq!(without_spikes(&Shape::already_valid(points.clone(), faces.clone(), None)), None);
        points[400] = [15.0, 13.0, 300.0];
        let kept = without_spikes(&Shape::already_valid(points, faces.clone(), None)).expect("a spike");
        assert_eq!(kept.len(), faces.len() - 6);
        assert!(!kept.iter().flatten().any(|&i| i == 400));
    }

    #[test]
    fn a_fan_that_closes_a_hole_is_no_spike() {
        // A bowl of fine rings, closed by one point in the middle of its rim.
        let ring = |r: u32| {
            let (wide, deep) = (f64::from(r) * std::f64::consts::PI / 80.0).sin_cos();
            (0..200).map(move |i| {
                let turn = f64::from(i) * std::f64::consts::TAU / 200.0;
                [wide * turn.cos(), wide * turn.sin(), -deep]
            })
        };
        let mut points: Vec<[f64; 3]> = (2..=40).flat_map(ring).collect();
        let middle = points.len() as u32;
        points.push([0.0, 0.0, 0.0]);
        let next = |i: u32| if i % 200 == 199 { i - 199 } else { i + 1 };
        let mut faces: Vec<[u32; 3]> =
            (0..38 * 200).flat_map(|i| [[i, next(i), i + 200], [next(i), next(i) + 200, i + 200]]).collect();
        faces.extend((38 * 200..39 * 200).map(|i| [i, next(i), middle]));
        assert_eq!(without_spikes(&Shape::already_valid(points, faces, None)), None);
    }

    #[test]
    fn a_curtain_between_two_sheets_is_cut() {
        let (mut points, mut faces) = sheet();
        let (behind, n) = (points.iter().map(|p| [p[0] + 29.0, p[1], p[2] + 40.0]).collect::<Vec<_>>(), 900);
        points.extend(behind);
        faces.extend(faces.clone().iter().map(|face| face.map(|i| i + n)));
        let whole = faces.clone();
        // From the right border of the one to the left border of the other.
        faces.extend((0..29).map(|y| [30 * y + 29, n + 30 * y, 30 * (y + 1) + 29]));
        let kept = without_spikes(&Shape::already_valid(points, faces, None)).expect("a curtain");
        assert!(kept == whole, "{} faces of {}", kept.len(), whole.len());
    }

    #[test]
    fn long_thin_triangles_along_a_limb_are_no_curtain() {
        // A cylinder of twenty rings of 24 points; rings are ten times farther apart than their points.
        let points = (0..480)
            .map(|i| {
                let turn = f64::from(i % 24) * std::f64::consts::TAU / 24.0;
                [turn.cos(), turn.sin(), 2.6 * f64::from(i / 24)]
            })
            .collect();
        let faces = (0..19 * 24).flat_map(|i| {
            let next = if i % 24 == 23 { i - 23 } else { i + 1 };
            [[i, next, i + 24], [next, next + 24, i + 24]]
        });
        assert_eq!(without_spikes(&Shape::already_valid(points, faces.collect(), None)), None);
    }
}
