//! A shape ready to be matched, and the flat block of bytes it travels in.
//!
//! The block is in the safetensors format: named tensors behind a JSON header. Whoever holds the bytes owns the shape; a worker that dies takes
//! nothing with it.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use ndarray::{Array1, Array2, ArrayView1, Axis};
use safetensors::tensor::{Dtype, SafeTensors, View, serialize};
use serde::{Deserialize, Serialize};

use crate::descriptors::SampledSurface;
use crate::device::Fallback;
use crate::lifting::Sampled;
use crate::maps::Matchable;
use crate::network::{Category, PointEmbedding, WeightsId};
use crate::operators::LaplacianKind;
use crate::shape::{self, Repair, Shape, Support};
use crate::spectrum::SpectralBasis;
use crate::vector::{cross, dot, minus};

/// Version of the block's layout.
const FORMAT: &str = "geose-prepared 6";

/// What was found about a scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
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
    /// Points that take part in the matching.
    pub points_used: usize,
    /// `"m"`, `"cm"` or `"mm"` where the size fits a body, else nothing.
    pub unit: Option<String>,
    /// The coordinate axis a standing body would have upright: given, or clearly the longest.
    pub up_axis: Option<shape::Axis>,
    /// Root of the surface area (a cloud's is estimated) in the unit of the upload: lengths are divided by it.
    pub scale: f64,
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

/// Mesh or cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShapeKind {
    /// With faces in use.
    Mesh,
    /// Points only.
    Cloud,
}

/// Everything [`match_shapes`](crate::match_shapes) needs to know about one scan.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedShape {
    /// The scan as read.
    pub shape: Shape,
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

/// Bytes that are not a prepared shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("these bytes are not a prepared shape: {0}")]
pub struct BlockError(String);

impl BlockError {
    /// Stable machine-readable name.
    pub fn code(&self) -> &'static str {
        "invalid-block"
    }
}

impl PreparedShape {
    /// Points used, p.
    pub fn points_used(&self) -> usize {
        self.support.points_used(self.shape.points().len())
    }

    /// The scan and which of its points were used.
    pub(crate) fn sampled(&self) -> Sampled<'_> {
        Sampled { shape: &self.shape, support: &self.support, scale: self.info.scale }
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
        let mut points = Array2::from_shape_fn((p, 3), |(row, c)| self.shape.points()[self.support.uploaded(row)][c]);
        let centroid = mass.dot(&points);
        points -= &centroid;
        points /= self.info.scale;
        let basis = SpectralBasis {
            eigenvalues: &self.basis.eigenvalues * total,
            eigenvectors: eigenvectors * total.sqrt(),
            mass,
        };
        let (features, coarse, surface) = (self.features.clone(), self.coarse.clone(), self.surface.clone());
        Matchable { basis, points, features, learned: None, coarse, surface }
    }

    /// What these weights said of it, if they were asked.
    pub fn embedding(&self, weights: &WeightsId) -> Option<&PointEmbedding> {
        self.embeddings.iter().find(|embedding| embedding.weights == *weights)
    }

    /// The category that the shape is most at home with.
    pub fn category(&self) -> Option<&Category> {
        Some(&*self.embeddings.first()?.category)
    }

    /// Positions (p, 3) of the points used, in the unit of the upload.
    pub(crate) fn points_of_rows(&self) -> Vec<[f64; 3]> {
        (0..self.points_used()).map(|row| self.shape.points()[self.support.uploaded(row)]).collect()
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
        if self.info.kind == ShapeKind::Mesh {
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
        let repairs: Vec<Repair> = serde_json::from_str(text("repairs")?).map_err(|e| BlockError(e.to_string()))?;
        let block = SafeTensors::deserialize(bytes).map_err(|e| BlockError(e.to_string()))?;
        let u32s = |name: &str| values::<u32>(&block, name, Dtype::U32);
        let f64s = |name: &str| values::<f64>(&block, name, Dtype::F64);
        let optional = |name: &str| block.names().contains(&name).then(|| u32s(name)).transpose();

        let points: Vec<[f64; 3]> = f64s("positions")?.as_chunks::<3>().0.to_vec();
        let faces: Vec<[u32; 3]> = u32s("faces")?.as_chunks::<3>().0.to_vec();
        let shape = Shape::already_valid(points, faces, optional("labels")?);
        let (eigenvalues, mass) = (Array1::from(f64s("eigenvalues")?), Array1::from(f64s("mass")?));
        let matrix = |e: ndarray::ShapeError| BlockError(e.to_string());
        let eigenvectors =
            Array2::from_shape_vec((mass.len(), eigenvalues.len()), f64s("eigenvectors")?).map_err(matrix)?;
        let features = values::<f32>(&block, "features", Dtype::F32)?;
        let coarse = u32s("coarse")?;
        let surface = SampledSurface {
            normals: f64s("normals")?.as_chunks::<3>().0.to_vec(),
            oriented: text("oriented")? == "true",
            cell: u32s("cell")?,
            adjacent: u32s("adjacent")?.as_chunks::<2>().0.to_vec(),
        };
        let support = Support {
            carriers: optional("carriers")?,
            carrier_of: optional("carrierOf")?,
            used: optional("used")?,
            used_of: optional("usedOf")?,
            unmatched: optional("unmatched")?,
        };
        let (n, carriers) = (shape.points().len(), mass.len());
        let p = support.points_used(n);
        let below = |indices: &[u32], limit: usize| indices.iter().all(|&i| (i as usize) < limit);
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
            && below(shape.faces().as_flattened(), n)
            && shape.labels().is_none_or(|l| l.len() == n)
            && p > 0
            && features.len() % p == 0;
        if !consistent {
            return Err(fail("its tables do not fit together"));
        }
        let features = Array2::from_shape_vec((p, features.len() / p), features).map_err(matrix)?;
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
        let basis = SpectralBasis { eigenvalues, eigenvectors, mass };
        Ok(Self { shape, info, repairs, basis, support, coarse, surface, features, embeddings })
    }
}

/// What the features and the probabilities of parts of an embedding are called in a block.
fn learned_names(index: usize) -> [String; 2] {
    let number = if index == 0 { String::new() } else { format!("{}", index + 1) };
    [format!("learned{number}"), format!("partProbabilities{number}")]
}

/// The most probable part (p) of each row of probabilities (p, c); the first of equals.
fn likeliest_parts(probabilities: &Array2<f32>) -> Vec<u8> {
    let likeliest = |row: ArrayView1<f32>| {
        let first = (0, f32::NEG_INFINITY);
        row.iter().zip(0..).fold(first, |(part, most), (&p, i)| if p > most { (i, p) } else { (part, most) }).0
    };
    probabilities.rows().into_iter().map(likeliest).collect()
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
