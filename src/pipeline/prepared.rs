//! A shape ready to be matched.

use std::collections::BTreeMap;

use ndarray::{Array1, Array2, ArrayView1, Axis};
use serde::{Deserialize, Serialize};

use crate::descriptors::SampledSurface;
use crate::device::Fallback;
use crate::lifting::Sampled;
use crate::maps::Correspondence;
use crate::maps::{Matchable, UNMATCHED};
use crate::network::{Category, PointEmbedding, TrainedNetwork, WeightsId};
use crate::operators::LaplacianKind;
use crate::shape::{self, Repair, Resampled, Shape, Support};
use crate::spectrum::SpectralBasis;
use crate::vector::{cross, dot, minus};

/// What was found about a scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Info {
    /// `"mesh"` or `"cloud"`, as it was used.
    pub kind: ShapeKind,
    /// File name, if one was given.
    pub name: Option<String>,
    /// Uploaded points.
    pub points: usize,
    /// Faces as read.
    pub faces: usize,
    /// Connected pieces of the surface or neighbourhood graph.
    pub pieces: usize,
    /// Points that take part in the matching: more than `points` where some were put between the uploaded ones, as in a body put together from shells.
    pub points_used: usize,
    /// `"m"`, `"cm"` or `"mm"` where the size fits a body, else nothing.
    pub unit: Option<String>,
    /// The coordinate axis a standing body would have upright: given, or clearly the longest.
    pub up_axis: Option<shape::Axis>,
    /// Root of the surface area (a cloud's is estimated) of the whole body in the unit of the upload: lengths are divided by it.
    pub scale: f64,
    /// The share of the body's surface that the scan has: 1 unless a network took it for a piece.
    #[serde(default = "whole")]
    pub share: f64,
    /// Whether the mesh ends somewhere, as where something was cut off or is hidden. A cloud does not say.
    #[serde(default)]
    pub borders: bool,
    /// How far the scan can be relied on: confidence is multiplied by it. 1 unless coordinates are too coarse or part of the surface has hardly a point.
    pub reliability: f64,
    /// The Laplacian in use.
    pub laplacian: LaplacianKind,
    /// Eigenpairs in the basis.
    pub eigenpairs: usize,
    /// Largest residual of the eigenpairs, relative to the largest eigenvalue.
    pub residual: f64,
    /// Seconds per stage.
    pub seconds: BTreeMap<String, f64>,
    /// Where and why the CPU took over from the device; nothing when it did not.
    pub fallback: Option<Fallback>,
}

fn whole() -> f64 {
    1.0
}

/// Mesh or cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShapeKind {
    /// With faces in use.
    Mesh,
    /// Points only.
    Cloud,
}

/// Everything [`Matcher::match_shapes`](crate::Matcher::match_shapes) needs to know about one scan.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedShape {
    /// The scan as read.
    pub shape: Shape,
    /// Its surface with points between the uploaded ones, where these could not carry a basis; `support` is then about the points of that.
    pub resampled: Option<Resampled>,
    /// What was found about it.
    pub info: Info,
    /// Repairs of reading and of preparing.
    pub repairs: Vec<Repair>,
    /// Basis in the unit of the upload, one row per carrier.
    pub basis: SpectralBasis,
    /// Which points carry the basis, and which are used.
    pub support: Support,
    /// Rows of an even sampling of the points used, coarsest first.
    pub coarse: Vec<u32>,
    /// The surface around that sampling, at the points used.
    pub surface: SampledSurface,
    /// Descriptors (p, c) that need no network.
    pub features: Array2<f32>,
    /// What networks say of the points used, first that of the category which the shape is most at home with; nothing before they were asked.
    pub embeddings: Vec<PointEmbedding>,
}

impl PreparedShape {
    /// Takes it for so much of the surface of a body.
    pub(crate) fn take_for_piece(&mut self, share: f64) {
        self.info.scale *= (self.info.share / share).sqrt();
        self.info.share = share;
    }

    /// Points used, p.
    pub fn points_used(&self) -> usize {
        self.support.points_used(self.sampled_shape().points().len())
    }

    /// The shape that `support` is about.
    pub(crate) fn sampled_shape(&self) -> &Shape {
        self.resampled.as_ref().map_or(&self.shape, |resampled| &resampled.shape)
    }

    /// What was found between the points of this shape and another one as `resampled`, between the uploaded points.
    pub(crate) fn between_uploaded(&self, mut found: Correspondence, to: &Self) -> Correspondence {
        let n = self.shape.points().len();
        found.target.truncate(n);
        found.confidence.truncate(n);
        if let Some(resampled) = &to.resampled {
            let uploaded = |target: &mut u32| *target = resampled.uploaded(*target);
            found.target.iter_mut().filter(|target| **target != UNMATCHED).for_each(uploaded);
        }
        found
    }

    /// The scan and which of its points were used.
    pub(crate) fn sampled(&self) -> Sampled<'_> {
        Sampled { shape: self.sampled_shape(), support: &self.support, scale: self.info.scale }
    }

    /// The shape at unit area, at the points used. What depends on weights (`prior`) is left out.
    pub fn matchable(&self) -> Matchable {
        let p = self.points_used();
        let eigenvectors = match &self.support.used {
            None => self.basis.eigenvectors.clone(),
            Some(used) => {
                let rows: Vec<usize> = used.iter().map(|&carrier| carrier as usize).collect();
                self.basis.eigenvectors.select(Axis(0), &rows)
            }
        };
        // Points used stand for the mass around them.
        let mut mass = Array1::zeros(p);
        for (carrier, m) in self.basis.mass.iter().enumerate() {
            mass[self.support.row_of_carrier(carrier)] += m;
        }
        // Equal to the area for every Laplacian but the literal one, whose masses are counts.
        let total: f64 = mass.sum();
        mass /= total;
        let places = self.sampled_shape().points();
        let mut points = Array2::from_shape_fn((p, 3), |(row, c)| places[self.support.uploaded(row)][c]);
        let centroid = mass.dot(&points);
        points -= &centroid;
        points /= self.info.scale;
        let basis = SpectralBasis {
            eigenvalues: &self.basis.eigenvalues * total,
            eigenvectors: eigenvectors * total.sqrt(),
            mass,
        };
        let (features, coarse, surface) = (self.features.clone(), self.coarse.clone(), self.surface.clone());
        Matchable { basis, points, features, learned: None, coarse, surface, share: self.info.share }
    }

    /// What these weights said of it, if they were asked.
    pub fn embedding(&self, weights: &WeightsId) -> Option<&PointEmbedding> {
        self.embeddings.iter().find(|embedding| embedding.weights == *weights)
    }

    /// What this network said of it, if it was asked.
    pub(crate) fn embedding_of<T>(&self, network: &TrainedNetwork<T>) -> Option<&PointEmbedding> {
        self.embedding(network.id()).filter(|embedding| network.made(embedding))
    }

    /// The category that the shape is most at home with.
    pub fn category(&self) -> Option<&Category> {
        Some(&*self.embeddings.first()?.category)
    }

    /// Positions (p, 3) of the points used, in the unit of the upload.
    pub(crate) fn points_of_rows(&self) -> Vec<[f64; 3]> {
        (0..self.points_used()).map(|row| self.sampled_shape().points()[self.support.uploaded(row)]).collect()
    }

    /// The predicted part of each uploaded point, a part of [`category`](Self::category); nothing when no network was asked.
    pub fn predicted_parts(&self) -> Option<Vec<u32>> {
        let likeliest = likeliest_parts(&self.embeddings.first()?.parts);
        Some((0..self.shape.points().len()).map(|i| u32::from(likeliest[self.support.row_of(i)])).collect())
    }

    /// The area that each uploaded point stands for: a third of the faces around it, or of a cloud an equal share of its point used's.
    pub fn point_areas(&self) -> Vec<f64> {
        let n = self.shape.points().len();
        let mut areas = vec![0.0; n];
        if self.info.kind == ShapeKind::Mesh || self.resampled.is_some() {
            for face in self.shape.faces() {
                let [a, b, c] = face.map(|i| self.shape.points()[i as usize]);
                let normal = cross(minus(b, a), minus(c, a));
                face.iter().for_each(|&i| areas[i as usize] += dot(normal, normal).sqrt() / 6.0);
            }
            return areas;
        }
        let rows: Vec<usize> = (0..n).map(|i| self.support.row_of(i)).collect();
        let mut shares = vec![0.0; self.points_used()];
        rows.iter().for_each(|&row| shares[row] += 1.0);
        let mass = self.matchable().basis.mass;
        rows.iter().zip(&mut areas).for_each(|(&row, area)| *area = mass[row] / shares[row]);
        areas
    }
}

/// The most probable part (p) of each row of probabilities (p, c); the first of equals.
pub(super) fn likeliest_parts(probabilities: &Array2<f32>) -> Vec<u8> {
    let likeliest = |row: ArrayView1<f32>| {
        let first = (0, f32::NEG_INFINITY);
        row.iter().zip(0..).fold(first, |(part, most), (&p, i)| if p > most { (i, p) } else { (part, most) }).0
    };
    probabilities.rows().into_iter().map(likeliest).collect()
}
