//! What a shape is matched by before a network looks at it: operator, basis, descriptors, and the surface around a sampling.

use std::borrow::Cow;

use ndarray::{Array2, Axis};

use super::Error;
use crate::descriptors::{SampledSurface, wave_kernel_signature};
use crate::operators::{self, EdgeFilter, Laplacian, LaplacianKind};
use crate::progress::{Progress, Stage};
use crate::shape::{Shape, Support};
use crate::spectrum::{SpectralBasis, SpectrumReport, spectrum};

/// Operator and basis of a shape, one row per carrier, descriptors and surface at the points used.
pub(crate) struct Geometry {
    pub laplacian: Laplacian,
    pub basis: SpectralBasis,
    pub report: SpectrumReport,
    pub features: Array2<f32>,
    pub surface: SampledSurface,
}

impl Geometry {
    /// Of `shape`, whose points are the carriers; `coarse` are rows of points used. `filter` weakens edges of a cloud. The basis has the larger number of
    /// `eigenpairs`; descriptors and surface are made from the first of the two.
    pub(crate) fn of(
        shape: &Shape,
        kind: LaplacianKind,
        filter: Option<EdgeFilter>,
        (support, coarse): (&Support, &[u32]),
        eigenpairs: [usize; 2],
        progress: &mut Progress,
    ) -> Result<Self, Error> {
        let laplacian = operators::laplacian_filtered(shape, kind, filter, progress)?;
        let (basis, report) = spectrum(&laplacian.matrix, &laplacian.mass, eigenpairs[0].max(eigenpairs[1]), progress)?;
        progress.at(Stage::Features, 0.0)?;
        let asked = match basis.k() > eigenpairs[0] {
            true => Cow::Owned(basis.truncated(eigenpairs[0])),
            false => Cow::Borrowed(&basis),
        };
        let features = wave_kernel_signature(&asked).values;
        let (features, surface) = match &support.used {
            None => (features, SampledSurface::around(shape, coarse, &asked, filter)),
            Some(used) => {
                let carriers: Vec<u32> = coarse.iter().map(|&row| used[row as usize]).collect();
                let rows: Vec<usize> = used.iter().map(|&row| row as usize).collect();
                (features.select(Axis(0), &rows), SampledSurface::around(shape, &carriers, &asked, filter).at(used))
            }
        };
        drop(asked);
        Ok(Self { laplacian, basis, report, features, surface })
    }
}
