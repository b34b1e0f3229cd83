//! How much of a body a scan is: whether it is a piece, and the share of the body's surface that it has.

use ndarray::Axis;

use super::options::LEAST;
use crate::network::PointEmbedding;

/// A shape with this share of a body's surface is taken for a whole one. A network says 0.93 or more of 132 own wholes, as meshes and as clouds, and 0.90 or less of 48 own pieces.
const NEARLY_WHOLE: f64 = 0.92;
/// A network says of a scan, seen as a whole body, what share of one it is. It sees a piece again as this many times that share, and what it is most certain of counts. On 48 held-out pieces of five kinds
/// (cuts, few and many holes, single views, boxes) 73, 89, 71, 67 and 82 % of points had the right of 14 parts when the first share was believed, 72, 86, 81, 83 and 95 % when it was believed only where that
/// made the network more certain, and with these guesses 77, 87, 82, 85 and 96 %.
const GUESSES: [f64; 5] = [1.0, 0.5, 0.7, 1.4, 2.0];
/// Of the certainty that a category asks of a shape, a piece needs this share: it has fewer marks to be known by. On 48 held-out pieces certainty was 0.69 to 0.97, on one of them
/// below 0.75; heaps of eggs that were taken for half a person had 0.73.
const OF_PIECES: f64 = 0.85;
/// A part is there where a shape has more than this share of the part's area on a whole body.
const THERE: f64 = 0.1;
/// The parts that are there must have, on a whole body, at least this share of the area that the piece is said to have.
const EXPLAINED: f64 = 0.5;

/// The share of the surface for an extent, which is √area of a scan over that of the whole body; 1 of what is nearly whole.
pub(super) fn share_of_extent(extent: f32) -> f64 {
    let share = f64::from(extent * extent);
    if share < NEARLY_WHOLE { share.max(LEAST) } else { 1.0 }
}

/// Shares of a body that a piece may be, by the first that a network says.
pub(super) fn guesses(first: f64) -> impl Iterator<Item = f64> {
    GUESSES.into_iter().map(move |factor| factor * first).filter(|&guess| guess < 1.0)
}

/// Whether a shape may be that share of the surface of a body: its parts are certain enough, and those that are there at all make up for it. What is none of the category is no piece of it.
pub(super) fn is_piece(embedding: &PointEmbedding, share: f64) -> bool {
    let category = &embedding.category;
    let parts = embedding.parts.mean_axis(Axis(0)).unwrap_or_default();
    let there = category
        .parts
        .iter()
        .zip(&parts)
        .filter(|(part, of_points)| f64::from(**of_points) * share > THERE * part.area);
    let most: f64 = there.map(|(part, _)| part.area).sum();
    share < 1.0 && certainty(embedding) >= OF_PIECES * category.thresholds.certainty && most >= EXPLAINED * share
}

/// By how much a network is more certain of the parts of a shape than its category asks for.
pub(super) fn margin(embedding: &PointEmbedding) -> f64 {
    certainty(embedding) - embedding.category.thresholds.certainty
}

/// How certain a network is of the parts of a shape, every point counting the same.
pub(super) fn certainty(embedding: &PointEmbedding) -> f64 {
    embedding.certainty(std::iter::repeat(1.0 / embedding.parts.nrows().max(1) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lacks_a_tenth_of_a_body_is_a_piece_and_what_lacks_a_twentieth_is_whole() {
        let share = |of_body: f32| share_of_extent(of_body.sqrt());
        assert!((share(0.9) - 0.9).abs() < 1e-6, "a piece has the share that is said of it");
        assert_eq!((share(0.95), share(1.1)), (1.0, 1.0), "wholes");
        assert_eq!(share(0.0), LEAST, "nothing is no share");
    }
}
