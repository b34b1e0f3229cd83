//! Points whose coordinates are no numbers, as in the empty rows of the organised clouds of depth cameras.

use super::error::ShapeError;
use super::repair::{Repair, counted};

/// Finds the points with a coordinate that is not finite, ascending, and gives them the place of the first other one, so that nobody computes with theirs. Refused
/// where a face hangs on such a point, or none is left.
pub(super) fn give_places(
    points: &mut [[f64; 3]],
    faces: &[[u32; 3]],
    repairs: &mut Vec<Repair>,
) -> Result<Vec<u32>, ShapeError> {
    let finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
    let placeless: Vec<u32> = (0..points.len() as u32).filter(|&i| !finite(&points[i as usize])).collect();
    let Some(&first) = placeless.first() else { return Ok(placeless) };
    let refused = ShapeError::NotFinite { index: first as usize, count: placeless.len() };
    let in_face = faces.iter().flatten().any(|corner| placeless.binary_search(corner).is_ok());
    let place = points.iter().copied().find(finite).filter(|_| !in_face).ok_or(refused)?;
    placeless.iter().for_each(|&i| points[i as usize] = place);
    let lie = counted(placeless.len(), "point has a coordinate", "points have a coordinate");
    let message = format!("{lie} that is no number; set aside, and matched with nothing");
    repairs.push(Repair::noted("points-without-place", placeless.len(), message));
    Ok(placeless)
}
