//! One scan as training sees it: what the network is given, part labels, and where a teacher put its points by these. Which body point a point is does
//! not come along.

use std::fs;
use std::io;
use std::path::Path;

use half::f16;
use ndarray::Array2;
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};

use super::sample_config::SampleConfig;
use crate::network::{Category, ShapeInputs};
use crate::operators::{LaplacianKind, gradient_around};
use crate::pipeline::Error;
use crate::pipeline::PrepareOptions;
use crate::pipeline::{network_inputs, prepare_with_carriers};
use crate::progress::Progress;
use crate::shape::{Aside, MIN_POINTS, Shape};

/// Inputs (n points) and labels (n).
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// What the network sees.
    pub inputs: ShapeInputs,
    /// Part of each point, a part of the category.
    pub labels: Vec<u32>,
    /// Where a teacher says that each point lies on the atlas (n, 3), in √area; see [`super::atlas`].
    pub places: Option<Array2<f32>>,
    /// The share of the body's area that is there.
    pub share: f32,
}

impl Sample {
    /// Of a whole body, or of one that is taken for whole. Builds the operators that a scan with given labels would get, on as many points as matching would use where `config.points` were asked for. Points without
    /// surface keep no label, and so are left out. `places` are those of the
    /// scan's points, where there is a teacher.
    pub fn new(
        shape: Shape,
        places: Option<&[[f32; 3]]>,
        kind: Option<LaplacianKind>,
        config: &SampleConfig,
    ) -> Result<Self, Error> {
        Self::of_piece(shape, places, kind, [1.0, 1.0], config)
    }

    /// The same of a piece: the share of the body's area that is there, and √area of the piece over what is taken for that of the body.
    pub fn of_piece(
        shape: Shape,
        places: Option<&[[f32; 3]]>,
        kind: Option<LaplacianKind>,
        [share, extent]: [f64; 2],
        config: &SampleConfig,
    ) -> Result<Self, Error> {
        let options = PrepareOptions {
            laplacian: kind,
            eigenpairs: config.input.eigenpairs,
            points: config.points.max(MIN_POINTS),
            ..PrepareOptions::default()
        };
        let mut progress = Progress::silent();
        let (mut prepared, carriers, _) =
            prepare_with_carriers(shape, None, &options, &Aside::default(), 0, &mut progress)?;
        prepared.take_for_piece(extent * extent);
        let labels = prepared.shape.labels().unwrap_or_default();
        // Points between the uploaded ones have the label and the place of the one that stands for them.
        let uploaded =
            |point: usize| prepared.resampled.as_ref().map_or(point, |new| new.uploaded(point as u32) as usize);
        let used = (0..prepared.points_used()).map(|row| uploaded(prepared.support.uploaded(row)));
        let used: Vec<usize> = used.collect();
        let labels = used.iter().map(|&i| labels[i]).collect();
        let places = places.map(|at| Array2::from_shape_fn((used.len(), 3), |(row, axis)| at[used[row]][axis]));
        let gradient = gradient_around(&carriers.shape, &carriers.neighbourhood, None, &mut progress)
            .map_err(crate::operators::OperatorError::from)?;
        let inputs = network_inputs(&prepared, &gradient, &config.input);
        Ok(Self { inputs, labels, places, share: share as f32 })
    }

    /// Of the mirror image of the body, whose left is right: what a network must make of it that sees no coordinates follows from this sample. `category` says which parts are
    /// mirror images; the atlas is symmetric about x = 0.
    #[must_use]
    pub fn mirrored(mut self, category: &Category) -> Self {
        let inputs = &mut self.inputs;
        // A tangent frame that is mirrored turns the other way round.
        let flipped = [inputs.points.column_mut(0), inputs.moments.column_mut(0)];
        flipped
            .into_iter()
            .chain(self.places.as_mut().map(|places| places.column_mut(0)))
            .for_each(|mut x| x.mapv_inplace(|x| -x));
        inputs.gradients[1].mapv_inplace(|g| -g);
        self.labels.iter_mut().for_each(|label| *label = category.parts[*label as usize].mirror as u32);
        self
    }

    /// Writes it as safetensors with f16 values, so that thousands fit on a disk.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        let inputs = &self.inputs;
        let mut matrices = vec![
            ("channels", &inputs.channels),
            ("points", &inputs.points),
            ("moments", &inputs.moments),
            ("phi", &inputs.phi),
            ("projector", &inputs.projector),
            ("along", &inputs.gradients[0]),
            ("across", &inputs.gradients[1]),
            ("lambda", &inputs.lambda),
        ];
        matrices.extend(self.places.as_ref().map(|places| ("places", places)));
        let [share, extent] = [self.share, self.inputs.extent].map(|value| Array2::from_elem((1, 1), value));
        matrices.extend([("share", &share), ("extent", &extent)]);
        matrices.extend(inputs.encoded.as_ref().map(|encoded| ("encoded", encoded)));
        // f16 has five bits of exponent: masses of single points would be subnormal in it.
        let scale = |name: &str| if matches!(name, "moments" | "projector") { inputs.len() as f32 } else { 1.0 };
        let mut bytes: Vec<(&str, Vec<usize>, Vec<u8>)> = matrices
            .iter()
            .map(|&(name, m)| {
                let halves = m.iter().flat_map(|&v| f16::from_f32(v * scale(name)).to_le_bytes()).collect();
                (name, vec![m.nrows(), m.ncols()], halves)
            })
            .collect();
        bytes.push(("labels", vec![self.labels.len()], self.labels.iter().map(|&l| l as u8).collect()));
        let views = bytes.iter().map(|(name, shape, bytes)| {
            let dtype = if *name == "labels" { Dtype::U8 } else { Dtype::F16 };
            (*name, TensorView::new(dtype, shape.clone(), bytes).expect("as many bytes as the shape says"))
        });
        let bytes = serialize(views, None).map_err(io::Error::other)?;
        // Under another name first, so that a reader never finds half a file.
        let partial = path.with_extension("partial");
        fs::write(&partial, bytes)?;
        fs::rename(partial, path)
    }

    /// Reads it back.
    pub fn load(path: &Path) -> io::Result<Self> {
        let bytes = fs::read(path)?;
        let file = SafeTensors::deserialize(&bytes).map_err(io::Error::other)?;
        let bad = || io::Error::new(io::ErrorKind::InvalidData, format!("{} is not a sample", path.display()));
        let read = |name: &str| -> io::Result<Array2<f32>> {
            let view = file.tensor(name).map_err(io::Error::other)?;
            let &[rows, cols] = view.shape() else { return Err(bad()) };
            let values = view.data().as_chunks().0.iter().map(|&b| f16::from_le_bytes(b).to_f32()).collect();
            Array2::from_shape_vec((rows, cols), values).map_err(|_| bad())
        };
        let labels: Vec<u32> =
            file.tensor("labels").map_err(io::Error::other)?.data().iter().map(|&l| u32::from(l)).collect();
        let per_point = 1.0 / labels.len() as f32;
        let optional = |name: &str| file.names().contains(&name).then(|| read(name)).transpose();
        Ok(Self {
            inputs: ShapeInputs {
                channels: read("channels")?,
                points: read("points")?,
                moments: read("moments")? * per_point,
                phi: read("phi")?,
                projector: read("projector")? * per_point,
                gradients: [read("along")?, read("across")?],
                lambda: read("lambda")?,
                encoded: optional("encoded")?,
                extent: optional("extent")?.map_or(1.0, |extent| extent[(0, 0)]),
            },
            labels,
            places: optional("places")?,
            share: optional("share")?.map_or(1.0, |share| share[(0, 0)]),
        })
    }
}
