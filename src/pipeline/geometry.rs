//! What a shape is matched by before a network looks at it: operator, basis, descriptors, and the surface around a sampling.

use ndarray::{Array2, Axis};

use super::Error;
use crate::descriptors::{SampledSurface, wave_kernel_signature};
use crate::operators::{EdgeFilter, Laplacian, LaplacianBuilder, LaplacianKind, Neighbourhood};
use crate::progress::{Progress, Stage};
use crate::shape::{Shape, Support};
use crate::spectrum::{SpectralBasis, SpectrumReport, spectrum};

/// The points that carry the basis of a shape: what operators are built on.
pub(crate) struct Carriers {
    /// These points, with faces where it is a mesh.
    pub shape: Shape,
    /// What is around each, found once for all operators.
    pub neighbourhood: Neighbourhood,
}

impl Carriers {
    pub(crate) fn new(shape: Shape) -> Self {
        let neighbourhood = Neighbourhood::of(shape.points());
        Self { shape, neighbourhood }
    }
}

/// Operator and basis of a shape, one row per carrier, descriptors and surface at the points used.
pub(crate) struct Geometry {
    pub laplacian: Laplacian,
    pub basis: SpectralBasis,
    pub report: SpectrumReport,
    pub features: Array2<f32>,
    pub surface: SampledSurface,
}

impl Geometry {
    /// `coarse` are rows of points used. `filter` weakens edges of a cloud.
    pub(crate) fn of(
        Carriers { shape, neighbourhood }: &Carriers,
        kind: LaplacianKind,
        filter: Option<EdgeFilter>,
        (support, coarse): (&Support, &[u32]),
        eigenpairs: usize,
        progress: &mut Progress,
    ) -> Result<Self, Error> {
        let builder = LaplacianBuilder::new(kind).edge_filter(filter);
        let laplacian = match kind {
            LaplacianKind::Cotangent => builder.build(shape, progress)?,
            _ => builder.build_around(neighbourhood, progress)?,
        };
        let (basis, report) = spectrum(&laplacian.matrix, &laplacian.mass, eigenpairs, progress)?;
        progress.at(Stage::Features, 0.0)?;
        let features = wave_kernel_signature(&basis).values;
        let surface = |samples: &[u32]| SampledSurface::around(shape, neighbourhood, filter, samples, &basis);
        let (features, surface) = match &support.used {
            None => (features, surface(coarse)),
            Some(used) => {
                let carriers: Vec<u32> = coarse.iter().map(|&row| used[row as usize]).collect();
                let rows: Vec<usize> = used.iter().map(|&row| row as usize).collect();
                (features.select(Axis(0), &rows), surface(&carriers).at(used))
            }
        };
        Ok(Self { laplacian, basis, report, features, surface })
    }
}
