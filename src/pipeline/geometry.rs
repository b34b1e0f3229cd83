//! What a shape is matched by before a network looks at it: operator, basis, descriptors, and the surface around a sampling.

use std::borrow::Cow;

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
    /// `coarse` are rows of points used. `filter` weakens edges of a cloud. The basis has the larger number of `eigenpairs`; descriptors and surface are made from
    /// the first of the two.
    pub(crate) fn of(
        Carriers { shape, neighbourhood }: &Carriers,
        kind: LaplacianKind,
        filter: Option<EdgeFilter>,
        (support, coarse): (&Support, &[u32]),
        eigenpairs: [usize; 2],
        progress: &mut Progress,
    ) -> Result<Self, Error> {
        let builder = LaplacianBuilder::new(kind).edge_filter(filter);
        let laplacian = match kind {
            LaplacianKind::Cotangent => builder.build(shape, progress)?,
            _ => builder.build_around(neighbourhood, progress)?,
        };
        let (basis, report) = spectrum(&laplacian.matrix, &laplacian.mass, eigenpairs[0].max(eigenpairs[1]), progress)?;
        progress.at(Stage::Features, 0.0)?;
        let asked = match basis.k() > eigenpairs[0] {
            true => Cow::Owned(basis.truncated(eigenpairs[0])),
            false => Cow::Borrowed(&basis),
        };
        let features = wave_kernel_signature(&asked).values;
        let surface = |samples: &[u32]| SampledSurface::around(shape, neighbourhood, filter, samples, &asked);
        let (features, surface) = match &support.used {
            None => (features, surface(coarse)),
            Some(used) => {
                let carriers: Vec<u32> = coarse.iter().map(|&row| used[row as usize]).collect();
                let rows: Vec<usize> = used.iter().map(|&row| row as usize).collect();
                (features.select(Axis(0), &rows), surface(&carriers).at(used))
            }
        };
        drop(asked);
        Ok(Self { laplacian, basis, report, features, surface })
    }
}

#[cfg(test)]
mod tests {
    use super::{Carriers, Geometry, LaplacianKind, Progress, Shape, Support};

    #[test]
    fn a_second_pass_with_a_filter_is_the_same_on_a_neighbourhood_that_is_there() {
        let points = (0..400).map(|i| {
            let (z, turn) = (1.0 - f64::from(2 * i + 1) / 400.0, f64::from(i) * 2.399963);
            let r = (1.0 - z * z).sqrt() * (1.0 + 0.2 * z + 0.15 * turn.sin());
            [r * turn.cos(), 0.8 * r * turn.sin(), 1.6 * z]
        });
        let egg = Shape::new(points.collect(), Vec::new(), None).expect("a cloud");
        let halves = |i: u32, j: u32| if (i < 200) == (j < 200) { 1.0 } else { 0.1 };
        let coarse: Vec<u32> = (0..400).step_by(4).collect();
        let of = |carriers: &Carriers, filtered: bool| {
            let filter = filtered.then_some(&halves as crate::operators::EdgeFilter);
            let support = (&Support::default(), &coarse[..]);
            Geometry::of(carriers, LaplacianKind::Geodesic, filter, support, [20, 0], &mut Progress::silent())
                .expect("geometry")
        };
        let shared = Carriers::new(egg.clone());
        let first = of(&shared, false);
        let (second, alone) = (of(&shared, true), of(&Carriers::new(egg), true));
        assert_eq!(second.laplacian.matrix, alone.laplacian.matrix);
        assert_eq!(second.basis.eigenvectors, alone.basis.eigenvectors);
        assert_eq!((&second.features, &second.surface), (&alone.features, &alone.surface));
        assert_ne!(second.laplacian.matrix, first.laplacian.matrix);
    }
}
