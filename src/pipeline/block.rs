//! The flat block of bytes that a prepared shape travels in: safetensors, named tensors behind a JSON header. Whoever holds the bytes owns the shape; a worker that
//! dies takes nothing with it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use ndarray::{Array1, Array2};
use safetensors::tensor::{Dtype, SafeTensors, View, serialize};

use super::prepared::likeliest_parts;
use super::{Info, PreparedShape};
use crate::descriptors::{ENERGIES, SampledSurface};
use crate::network::{Category, PointEmbedding, WeightsId};
use crate::read::shortened;
use crate::shape::{Repair, Resampled, Shape, Support};
use crate::spectrum::SpectralBasis;

/// Version of the block's layout.
const FORMAT: &str = "geose-prepared 8";

/// Bytes that are not a prepared shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("these bytes are not a prepared shape: {}", shortened(.0))]
pub struct BlockError(String);

impl BlockError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        "invalid-block"
    }
}

impl PreparedShape {
    /// Names of the parts and where they are from: given labels, while they are few enough to be parts, or else the network.
    fn parts(&self) -> Option<serde_json::Value> {
        let labels = self.shape.labels().unwrap_or_default();
        if let Some(highest) = labels.iter().copied().max().filter(|&highest| highest < 256) {
            let names: Vec<String> = (0..=highest).map(|part| format!("part {part}")).collect();
            return Some(serde_json::json!({ "names": names, "source": "given" }));
        }
        let category = self.category()?;
        let mut parts = serde_json::json!({ "names": category.part_names(), "source": "predicted" });
        if !category.groups.is_empty() {
            let of: Vec<usize> = category.parts.iter().map(|part| part.group).collect();
            parts["groups"] = serde_json::json!({ "names": category.groups, "of": of });
        }
        Some(parts)
    }

    /// The flat block: safetensors, little-endian.
    pub fn to_bytes(&self) -> Result<Vec<u8>, BlockError> {
        let (n, k) = (self.shape.points().len(), self.basis.k());
        let eigenvectors = self.basis.eigenvectors.as_standard_layout();
        let features = self.features.as_standard_layout();
        let tables = [
            ("positions", Tensor::of(Dtype::F64, self.shape.points().as_flattened(), &[n, 3])),
            ("faces", Tensor::of(Dtype::U32, self.shape.faces().as_flattened(), &[self.shape.faces().len(), 3])),
            ("eigenvalues", Tensor::of(Dtype::F64, contiguous(self.basis.eigenvalues.as_slice())?, &[k])),
            ("eigenvectors", Tensor::of(Dtype::F64, contiguous(eigenvectors.as_slice())?, &[self.basis.len(), k])),
            ("mass", Tensor::of(Dtype::F64, contiguous(self.basis.mass.as_slice())?, &[self.basis.len()])),
            ("coarse", Tensor::of(Dtype::U32, &self.coarse, &[self.coarse.len()])),
            ("cell", Tensor::of(Dtype::U32, &self.surface.cell, &[self.surface.cell.len()])),
            (
                "adjacent",
                Tensor::of(Dtype::U32, self.surface.adjacent.as_flattened(), &[self.surface.adjacent.len(), 2]),
            ),
            ("normals", Tensor::of(Dtype::F64, self.surface.normals.as_flattened(), &[self.surface.normals.len(), 3])),
            ("features", Tensor::of(Dtype::F32, contiguous(features.as_slice())?, features.shape())),
        ];
        let mut tensors: Vec<(String, Tensor)> =
            tables.into_iter().map(|(name, tensor)| (name.to_owned(), tensor)).collect();
        if let Some(Resampled { shape, .. }) = &self.resampled {
            let (added, faces) = (&shape.points()[n..], shape.faces());
            let tables = [
                ("added", Tensor::of(Dtype::F64, added.as_flattened(), &[added.len(), 3])),
                ("resampledFaces", Tensor::of(Dtype::U32, faces.as_flattened(), &[faces.len(), 3])),
            ];
            tensors.extend(tables.map(|(name, tensor)| (name.to_owned(), tensor)));
        }
        for (index, embedding) in self.embeddings.iter().enumerate() {
            for (name, matrix) in learned_names(index).into_iter().zip([&embedding.features, &embedding.parts]) {
                tensors.push((name, Tensor::of(Dtype::F32, contiguous(matrix.as_slice())?, matrix.shape())));
            }
        }
        // Only for the owner of the bytes, who is to look them up and not to compute.
        let likeliest = self.embeddings.first().map(|e| likeliest_parts(&e.parts));
        tensors.extend(
            likeliest.iter().map(|parts| ("partLabels".to_owned(), Tensor::of(Dtype::U8, parts, &[parts.len()]))),
        );
        let optional = [
            ("labels", self.shape.labels()),
            ("carriers", self.support.carriers.as_deref()),
            ("carrierOf", self.support.carrier_of.as_deref()),
            ("used", self.support.used.as_deref()),
            ("usedOf", self.support.used_of.as_deref()),
            ("unmatched", self.support.unmatched.as_deref()),
            ("standsFor", self.resampled.as_ref().map(|resampled| &resampled.stands_for[..])),
            ("placeless", Some(self.shape.placeless()).filter(|points| !points.is_empty())),
        ];
        tensors.extend(
            optional.into_iter().filter_map(|(name, values)| {
                Some((name.to_owned(), Tensor::of(Dtype::U32, values?, &[values?.len()])))
            }),
        );
        let said: Vec<(&WeightsId, &Category)> = self.embeddings.iter().map(|e| (&e.weights, &*e.category)).collect();
        let json = |value: Result<String, serde_json::Error>| value.map_err(|e| BlockError(e.to_string()));
        let metadata = HashMap::from([
            ("format".to_owned(), FORMAT.to_owned()),
            ("info".to_owned(), json(serde_json::to_string(&self.info))?),
            ("repairs".to_owned(), json(serde_json::to_string(&self.repairs))?),
            ("oriented".to_owned(), self.surface.oriented.to_string()),
            ("parts".to_owned(), json(serde_json::to_string(&self.parts()))?),
            ("extent".to_owned(), json(serde_json::to_string(&self.extent()))?),
            ("embeddings".to_owned(), json(serde_json::to_string(&said))?),
        ]);
        serialize(tensors, Some(metadata)).map_err(|e| BlockError(e.to_string()))
    }

    /// Back from [`to_bytes`](Self::to_bytes).
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BlockError> {
        let fail = |reason: &str| BlockError(reason.to_owned());
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(|e| BlockError(e.to_string()))?;
        let metadata = header.metadata().clone().unwrap_or_default();
        if metadata.get("format").map(String::as_str) != Some(FORMAT) {
            return Err(fail("another format or version"));
        }
        let text = |key: &str| metadata.get(key).ok_or_else(|| BlockError(format!("no {key}")));
        let info: Info = serde_json::from_str(text("info")?).map_err(|e| BlockError(e.to_string()))?;
        if !((0.0..=1.0).contains(&info.reliability) && info.share > 0.0 && info.share <= 1.0) {
            return Err(fail("its reliability, or how much of a body it is, is no share"));
        }
        let repairs: Vec<Repair> = serde_json::from_str(text("repairs")?).map_err(|e| BlockError(e.to_string()))?;
        let block = SafeTensors::deserialize(bytes).map_err(|e| BlockError(e.to_string()))?;
        let u32s = |name: &str| values::<u32>(&block, name, Dtype::U32);
        let f64s = |name: &str| values::<f64>(&block, name, Dtype::F64);
        let optional = |name: &str| block.names().contains(&name).then(|| u32s(name)).transpose();

        let points: Vec<[f64; 3]> = rows("positions", f64s("positions")?)?;
        let faces: Vec<[u32; 3]> = rows("faces", u32s("faces")?)?;
        let placeless = optional("placeless")?.unwrap_or_default();
        let shape = Shape::already_valid(points, faces, optional("labels")?);
        let (eigenvalues, mass) = (Array1::from(f64s("eigenvalues")?), Array1::from(f64s("mass")?));
        let matrix = |e: ndarray::ShapeError| BlockError(e.to_string());
        let eigenvectors =
            Array2::from_shape_vec((mass.len(), eigenvalues.len()), f64s("eigenvectors")?).map_err(matrix)?;
        let basis = SpectralBasis { eigenvalues, eigenvectors, mass };
        let features = values::<f32>(&block, "features", Dtype::F32)?;
        let coarse = u32s("coarse")?;
        let surface = SampledSurface {
            normals: rows("normals", f64s("normals")?)?,
            oriented: text("oriented")? == "true",
            cell: u32s("cell")?,
            adjacent: rows("adjacent", u32s("adjacent")?)?,
        };
        let support = Support {
            carriers: optional("carriers")?,
            carrier_of: optional("carrierOf")?,
            used: optional("used")?,
            used_of: optional("usedOf")?,
            unmatched: optional("unmatched")?,
        };
        let below = |indices: &[u32], limit: usize| indices.iter().all(|&i| (i as usize) < limit);
        let uploaded = shape.points().len();
        let sound = shape.points().as_flattened().iter().all(|c| c.is_finite())
            && below(shape.faces().as_flattened(), uploaded)
            && shape.labels().is_none_or(|labels| labels.len() == uploaded)
            && below(&placeless, uploaded)
            && placeless.is_sorted();
        if !sound {
            return Err(fail("its points, faces and labels do not fit together"));
        }
        let shape = shape.with_placeless(placeless);
        let resampled = match optional("standsFor")? {
            None => None,
            Some(stands_for) => {
                let added = rows("added", f64s("added")?)?;
                let faces = rows("resampledFaces", u32s("resampledFaces")?)?;
                Some(
                    Resampled::from_tables(&shape, added, faces, stands_for)
                        .ok_or_else(|| fail("its surface is another"))?,
                )
            }
        };
        let (n, carriers) = (uploaded + resampled.as_ref().map_or(0, |found| found.stands_for.len()), basis.len());
        let p = support.points_used(n);
        let fits = |table: &Option<Vec<u32>>, length: usize, limit: usize| {
            table.as_ref().is_none_or(|table| table.len() == length && below(table, limit))
        };
        let consistent = fits(&support.carriers, carriers, n)
            && fits(&support.carrier_of, n, carriers)
            && fits(&support.used, p, carriers)
            && fits(&support.used_of, carriers, p)
            && support.carriers.is_some() == support.carrier_of.is_some()
            && support.used.is_some() == support.used_of.is_some()
            && (support.carriers.is_some() || carriers == n)
            && support.unmatched.as_deref().is_none_or(|points| below(points, n))
            && below(&coarse, p)
            && (surface.normals.len(), surface.cell.len()) == (p, p)
            && below(&surface.cell, coarse.len())
            && below(surface.adjacent.as_flattened(), coarse.len())
            && p > 0
            && !coarse.is_empty()
            && basis.k() > 0
            && features.len() == p * ENERGIES;
        if !consistent {
            return Err(fail("its tables do not fit together"));
        }
        let features = Array2::from_shape_vec((p, ENERGIES), features).map_err(matrix)?;
        let learned = |name: &str| -> Result<Array2<f32>, BlockError> {
            let found = values::<f32>(&block, name, Dtype::F32)?;
            Array2::from_shape_vec((p, found.len() / p), found).map_err(matrix)
        };
        let said: Vec<(WeightsId, Category)> =
            serde_json::from_str(text("embeddings")?).map_err(|e| BlockError(e.to_string()))?;
        let mut embeddings = Vec::with_capacity(said.len());
        for (index, (weights, category)) in said.into_iter().enumerate() {
            category.check().map_err(BlockError)?;
            let [features, parts] = learned_names(index);
            let (features, parts) = (learned(&features)?, learned(&parts)?);
            if parts.ncols() != category.parts.len() {
                return Err(fail("its parts are others"));
            }
            embeddings.push(PointEmbedding { weights, category: Arc::new(category), features, parts });
        }
        Ok(Self { shape, resampled, info, repairs, basis, support, coarse, surface, features, embeddings })
    }
}

/// What the features and the probabilities of parts of an embedding are called in a block.
fn learned_names(index: usize) -> [String; 2] {
    let number = if index == 0 { String::new() } else { format!("{}", index + 1) };
    [format!("learned{number}"), format!("partProbabilities{number}")]
}

fn contiguous<T>(slice: Option<&[T]>) -> Result<&[T], BlockError> {
    slice.ok_or_else(|| BlockError("a table is not contiguous".into()))
}

/// Values of a tensor, copied out because the block may lie at any address.
fn values<T: bytemuck::Pod>(block: &SafeTensors<'_>, name: &str, dtype: Dtype) -> Result<Vec<T>, BlockError> {
    let tensor = block.tensor(name).map_err(|e| BlockError(e.to_string()))?;
    if tensor.dtype() != dtype {
        return Err(BlockError(format!("{name} has the wrong type")));
    }
    Ok(bytemuck::allocation::pod_collect_to_vec(tensor.data()))
}

/// Values in rows of `N`, all of them whole.
fn rows<T: Copy, const N: usize>(name: &str, values: Vec<T>) -> Result<Vec<[T; N]>, BlockError> {
    match values.as_chunks::<N>() {
        (rows, []) => Ok(rows.to_vec()),
        _ => Err(BlockError(format!("{name} are no rows of {N}"))),
    }
}

/// A borrowed tensor on its way into the block.
struct Tensor<'a> {
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: &'a [u8],
}

impl<'a> Tensor<'a> {
    fn of<T: bytemuck::NoUninit>(dtype: Dtype, values: &'a [T], shape: &[usize]) -> Self {
        Self { dtype, shape: shape.to_vec(), bytes: bytemuck::cast_slice(values) }
    }
}

impl View for Tensor<'_> {
    fn dtype(&self) -> Dtype {
        self.dtype
    }

    fn shape(&self) -> &[usize] {
        &self.shape
    }

    fn data(&self) -> Cow<'_, [u8]> {
        self.bytes.into()
    }

    fn data_len(&self) -> usize {
        self.bytes.len()
    }
}
