//! A match compares every point of one shape with every point of the other, so of large ones an even sampling is matched and the rest is lifted.

use std::borrow::Cow;

use ndarray::Axis;

use super::{PreparedShape, ShapeKind};
use crate::network::PointEmbedding;
use crate::progress::Cancelled;
use crate::shape::{cells, farthest_points};

/// Points of each side that a match compares, at most: what the default number of points comes to.
pub(crate) const MATCHED: usize = 7500;

impl PreparedShape {
    /// The same with at most `most` points used, an even sampling of those there are; basis and network have seen them all.
    pub(crate) fn thinned(
        &self,
        most: usize,
        report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
    ) -> Result<Cow<'_, Self>, Cancelled> {
        let p = self.points_used();
        if p <= most {
            return Ok(Cow::Borrowed(self));
        }
        let places: Vec<[f64; 3]> =
            (0..p).map(|row| self.sampled_shape().points()[self.support.uploaded(row)]).collect();
        let all: Vec<u32> = (0..p as u32).collect();
        // It begins with the sampling that refinement runs on.
        let chosen = farthest_points(&places, &all, most, report)?;
        let mut place = vec![0; p];
        chosen.iter().zip(0..).for_each(|(&row, new)| place[row as usize] = new);
        let coarse: Vec<u32> = self.coarse.iter().map(|&row| place[row as usize]).collect();
        let surface = match self.info.kind {
            ShapeKind::Mesh => self.sampled_shape().welded(),
            ShapeKind::Cloud => self.sampled_shape().clone().without_faces(),
        };
        let uploaded: Vec<u32> = chosen.iter().map(|&row| self.support.uploaded(row as usize) as u32).collect();
        let stands_for = cells(&surface, &uploaded);
        let carrier = |row: u32| self.support.used.as_ref().map_or(row, |used| used[row as usize]);
        let carriers = self.support.carriers.as_ref();
        let place_of_carrier = |c: usize| carriers.map_or(c, |carriers| carriers[c] as usize);
        let mut support = self.support.clone();
        support.used = Some(chosen.iter().map(|&row| carrier(row)).collect());
        support.used_of = Some((0..self.basis.len()).map(|c| stands_for[place_of_carrier(c)]).collect());
        let rows: Vec<usize> = chosen.iter().map(|&row| row as usize).collect();
        let thinned = |embedding: &PointEmbedding| PointEmbedding {
            weights: embedding.weights.clone(),
            category: embedding.category.clone(),
            features: embedding.features.select(Axis(0), &rows),
            parts: embedding.parts.select(Axis(0), &rows),
        };
        Ok(Cow::Owned(Self {
            shape: self.shape.clone(),
            resampled: self.resampled.clone(),
            info: self.info.clone(),
            repairs: self.repairs.clone(),
            basis: self.basis.clone(),
            support,
            coarse,
            surface: self.surface.at(&chosen),
            features: self.features.select(Axis(0), &rows),
            embeddings: self.embeddings.iter().map(thinned).collect(),
        }))
    }
}
