//! Named tensors with checked shapes, in the safetensors format; f16 or f32 in the file, f32 in use.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use half::f16;
use ndarray::{Array2, ArrayView2};
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use serde::{Deserialize, Serialize};

use super::{Category, ModelConfig, WeightsError};
use crate::device::Device;

/// Which weights: a prepared shape remembers those that looked at it.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct WeightsId {
    /// Their name.
    pub name: String,
    /// Their version.
    pub version: String,
    /// What tells weights of one name and version apart.
    pub fingerprint: String,
}

impl fmt::Display for WeightsId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\" {}", self.name, self.version)
    }
}

/// How a new parameter starts, when there are no weights yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// Every value this.
    Constant(f32),
    /// Normally distributed about 0 with this standard deviation.
    Normal(f32),
    /// Logarithms of values spaced logarithmically between these.
    Logarithms(f32, f32),
}

/// Where a network's parameters come from, as tensors of a device.
pub trait Source<T> {
    /// The parameter of this name, which must have this shape (rows, columns).
    fn tensor(&mut self, name: &str, shape: [usize; 2], start: Start) -> Result<T, WeightsError>;
}

/// The weights of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    /// The network they are of.
    pub config: ModelConfig,
    /// The kind of body that the network knows.
    pub category: Category,
    /// What else the file says about itself: name, version, and the like.
    pub about: BTreeMap<String, String>,
    tensors: BTreeMap<String, Array2<f32>>,
}

impl Weights {
    /// Tensors by name.
    pub fn new(
        config: ModelConfig,
        category: Category,
        about: BTreeMap<String, String>,
        tensors: BTreeMap<String, Array2<f32>>,
    ) -> Self {
        Self { config, category, about, tensors }
    }

    /// Reads a safetensors file whose header holds the configuration as JSON under `config`, and the category under `category`.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, WeightsError> {
        let bad = |reason: &dyn std::fmt::Display| WeightsError(reason.to_string());
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(|error| bad(&error))?;
        let mut about: BTreeMap<String, String> = header.metadata().clone().into_iter().flatten().collect();
        let config = about.remove("config").ok_or_else(|| bad(&"the header names no configuration"))?;
        let config = serde_json::from_str(&config).map_err(|error| bad(&error))?;
        let category = about.remove("category").ok_or_else(|| bad(&"the header names no category"))?;
        let category = Category::from_json(&category)?;
        let file = SafeTensors::deserialize(bytes).map_err(|error| bad(&error))?;
        let mut tensors = BTreeMap::new();
        for (name, view) in file.tensors() {
            let &[rows, cols] = view.shape() else {
                return Err(WeightsError(format!("{name} is not a matrix")));
            };
            let values: Vec<f32> = match view.dtype() {
                Dtype::F16 => view.data().as_chunks().0.iter().map(|&b| f16::from_le_bytes(b).to_f32()).collect(),
                Dtype::F32 => view.data().as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect(),
                other => return Err(WeightsError(format!("{name} is {other:?}, neither f16 nor f32"))),
            };
            if values.iter().any(|v| !v.is_finite()) {
                return Err(WeightsError(format!("{name} holds values that are not finite")));
            }
            let matrix = Array2::from_shape_vec((rows, cols), values).map_err(|error| bad(&error))?;
            tensors.insert(name, matrix);
        }
        Ok(Self { config, category, about, tensors })
    }

    /// What they are called, and what tells them from all others.
    pub fn id(&self) -> WeightsId {
        let about = |key: &str| self.about.get(key).map_or("unnamed", String::as_str).to_owned();
        WeightsId { name: about("name"), version: about("version"), fingerprint: self.fingerprint() }
    }

    /// FNV-1a, 64 bits, of configuration, category, and the names and values of all tensors as f16, so that a file has that of the weights it was written from.
    fn fingerprint(&self) -> String {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut enter = |bytes: &[u8]| {
            bytes.iter().for_each(|&byte| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        };
        // Neither can fail: numbers and strings.
        enter(serde_json::to_string(&self.config).unwrap_or_default().as_bytes());
        enter(serde_json::to_string(&self.category).unwrap_or_default().as_bytes());
        for (name, tensor) in &self.tensors {
            enter(name.as_bytes());
            tensor.iter().for_each(|&value| enter(&f16::from_f32(value).to_le_bytes()));
        }
        format!("{hash:016x}")
    }

    /// As a safetensors file, in f16 or in f32.
    pub fn to_bytes(&self, halves: bool) -> Result<Vec<u8>, WeightsError> {
        let bytes: Vec<(&String, [usize; 2], Vec<u8>)> = self
            .tensors
            .iter()
            .map(|(name, matrix)| {
                let values = matrix.iter();
                let bytes = match halves {
                    true => values.flat_map(|&v| f16::from_f32(v).to_le_bytes()).collect(),
                    false => values.flat_map(|&v| v.to_le_bytes()).collect(),
                };
                (name, [matrix.nrows(), matrix.ncols()], bytes)
            })
            .collect();
        let dtype = if halves { Dtype::F16 } else { Dtype::F32 };
        let views = bytes
            .iter()
            .map(|(name, shape, bytes)| Ok((name.as_str(), TensorView::new(dtype, shape.to_vec(), bytes)?)))
            .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()
            .map_err(|error| WeightsError(error.to_string()))?;
        let config = serde_json::to_string(&self.config).map_err(|error| WeightsError(error.to_string()))?;
        let mut header: HashMap<String, String> = self.about.clone().into_iter().collect();
        header.insert("config".to_owned(), config);
        header.insert("category".to_owned(), self.category.to_json()?);
        serialize(views, Some(header)).map_err(|error| WeightsError(error.to_string()))
    }

    /// The tensor of this name, if there is one.
    pub(crate) fn tensor(&self, name: &str) -> Option<ArrayView2<'_, f32>> {
        self.tensors.get(name).map(|tensor| tensor.view())
    }

    /// With one tensor more, or another one of its name.
    #[cfg(feature = "train")]
    pub(crate) fn with(mut self, name: &str, tensor: Array2<f32>) -> Self {
        self.tensors.insert(name.to_owned(), tensor);
        self
    }

    /// Tensors by name.
    pub fn tensors(&self) -> impl Iterator<Item = (&str, ArrayView2<'_, f32>)> {
        self.tensors.iter().map(|(name, matrix)| (name.as_str(), matrix.view()))
    }

    /// As a source for a network on `device`.
    pub fn on<'a, D: Device>(&'a self, device: &'a D) -> WeightsOn<'a, D> {
        WeightsOn { weights: self, device }
    }
}

/// [`Weights`] that a network on a device is built from.
pub struct WeightsOn<'a, D> {
    weights: &'a Weights,
    device: &'a D,
}

impl<D: Device> Source<D::Tensor> for WeightsOn<'_, D> {
    fn tensor(&mut self, name: &str, [rows, cols]: [usize; 2], _: Start) -> Result<D::Tensor, WeightsError> {
        let matrix =
            self.weights.tensors.get(name).ok_or_else(|| WeightsError(format!("{name} is missing from the file")))?;
        if matrix.dim() != (rows, cols) {
            let (r, c) = matrix.dim();
            return Err(WeightsError(format!("{name} is {r} by {c} and should be {rows} by {cols}")));
        }
        Ok(self.device.upload(matrix.view()))
    }
}
