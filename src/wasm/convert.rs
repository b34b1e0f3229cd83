//! Between the crate's types and JavaScript's.

use js_sys::{Array, Float32Array, Float64Array, Object, Reflect, Uint8Array, Uint32Array};
use ndarray::Array2;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::json;
use sprs::CsMat;
use wasm_bindgen::{JsCast, JsValue};

use crate::maps::{Correspondence, FunctionalMap};
use crate::operators::{Laplacian, LaplacianBuilder, LaplacianKind};
use crate::pipeline::Error;
use crate::pipeline::Match;
use crate::pipeline::OptionError;
use crate::spectrum::{SpectralBasis, SpectrumError, SpectrumReport};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LaplacianOptions {
    pub(super) kind: Option<LaplacianKind>,
    k0: Option<usize>,
    k: Option<usize>,
    tau: Option<f64>,
    iterations: Option<usize>,
    sigma: Option<f64>,
}

impl LaplacianOptions {
    pub(super) fn builder(&self, kind: LaplacianKind) -> LaplacianBuilder<'static> {
        LaplacianBuilder::new(kind)
            .initial_neighbours(self.k0)
            .neighbours(self.k)
            .ratio(self.tau)
            .iterations(self.iterations)
            .sigma(self.sigma)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpectrumOptions {
    #[serde(default = "default_eigenpairs")]
    pub(super) eigenpairs: usize,
}

fn default_eigenpairs() -> usize {
    120
}

/// Options from a plain object. Through JSON, because that rejects unknown names, where reading the known ones off the object would not.
pub(super) fn options<T: DeserializeOwned>(given: &JsValue) -> Result<T, JsValue> {
    let text = js_sys::JSON::stringify(given)
        .map_err(|_| invalid("the options must be plain data, without BigInt or cycles"))?;
    serde_json::from_str(text.as_string().as_deref().unwrap_or("{}")).map_err(|e| {
        // The position within the JSON means nothing to whoever wrote an object.
        let reason = e.to_string();
        invalid(reason.split(" at line ").next().unwrap_or(&reason))
    })
}

/// Files by their names, from an object of byte arrays; none where there is none.
pub(super) fn files(given: &JsValue) -> Result<Vec<(String, Vec<u8>)>, JsValue> {
    let Some(object) = given.dyn_ref::<Object>() else { return Ok(Vec::new()) };
    Object::entries(object)
        .iter()
        .map(|entry| {
            let entry = Array::from(&entry);
            match (entry.get(0).as_string(), entry.get(1).dyn_into::<Uint8Array>()) {
                (Some(name), Ok(bytes)) => Ok((name, bytes.to_vec())),
                _ => Err(invalid("companions must be an object of names and Uint8Arrays")),
            }
        })
        .collect()
}

/// Options that are not what they should be, in a sentence.
pub(super) fn invalid(reason: impl ToString) -> JsValue {
    throw(OptionError::invalid(reason.to_string()).into())
}

/// An error as the plain object that TypeScript turns into a GeoSeError.
pub(super) fn throw(error: Error) -> JsValue {
    plain(&json!({ "code": error.code(), "message": error.to_string(), "details": error.details() }))
}

pub(super) fn plain(value: &impl Serialize) -> JsValue {
    value.serialize(&serde_wasm_bindgen::Serializer::json_compatible()).unwrap_or(JsValue::NULL)
}

/// An object with these properties.
fn object<const N: usize>(properties: [(&str, JsValue); N]) -> Result<JsValue, JsValue> {
    let object = Object::new();
    for (name, value) in properties {
        Reflect::set(&object, &name.into(), &value)?;
    }
    Ok(object.into())
}

fn u32s(values: &[u32]) -> JsValue {
    Uint32Array::from(values).into()
}

fn f64s<'a>(values: impl IntoIterator<Item = &'a f64>) -> JsValue {
    Float64Array::from(values.into_iter().copied().collect::<Vec<f64>>().as_slice()).into()
}

pub(super) fn laplacian_to_js(laplacian: &Laplacian) -> Result<JsValue, JsValue> {
    let narrow = |indices: &[usize]| u32s(&indices.iter().map(|&i| i as u32).collect::<Vec<u32>>());
    object([
        ("kind", laplacian.kind.name().into()),
        ("indptr", narrow(laplacian.matrix.indptr().raw_storage())),
        ("indices", narrow(laplacian.matrix.indices())),
        ("values", f64s(laplacian.matrix.data())),
        ("mass", f64s(&laplacian.mass)),
    ])
}

/// A valid (n, n) matrix, or why it is none.
pub(super) fn matrix_from_csr(
    indptr: &[u32],
    indices: &[u32],
    values: Vec<f64>,
    n: usize,
) -> Result<CsMat<f64>, SpectrumError> {
    let wide = |indices: &[u32]| indices.iter().map(|&i| i as usize).collect::<Vec<usize>>();
    CsMat::try_new((n, n), wide(indptr), wide(indices), values)
        .map_err(|(_, _, _, e)| SpectrumError::InvalidMatrix { reason: e.to_string() })
}

pub(super) fn spectrum_to_js(basis: &SpectralBasis, report: &SpectrumReport) -> Result<JsValue, JsValue> {
    object([
        ("eigenvalues", f64s(&basis.eigenvalues)),
        ("eigenvectors", f64s(&basis.eigenvectors)),
        ("mass", f64s(&basis.mass)),
        ("report", plain(report)),
    ])
}

pub(super) fn match_to_js(matched: &Match, peak_memory_bytes: f64) -> Result<JsValue, JsValue> {
    let [of_a, of_b] = &matched.overlap;
    let [target, confidence, overlap, map] = directed(&matched.a_to_b, of_a, &matched.c_ab)?;
    let reverse = object(directed(&matched.b_to_a, of_b, &matched.c_ba)?)?;
    let report = json!({
        "device": matched.device,
        "fallback": matched.fallback,
        "seconds": matched.seconds,
        "pointsUsed": matched.points_used,
        "peakMemoryBytes": peak_memory_bytes,
        "gpu": matched.gpu,
        "warnings": matched.warnings,
        "weights": matched.weights.as_ref().map(|id| json!({ "name": id.name, "version": id.version })),
        "category": matched.category,
        "scale": matched.scale,
    });
    object([target, confidence, overlap, map, ("reverse", reverse), ("report", plain(&report))])
}

fn directed(
    map: &Correspondence,
    overlap: &[f32],
    functional: &FunctionalMap,
) -> Result<[(&'static str, JsValue); 4], JsValue> {
    Ok([
        ("targetOf", u32s(&map.target)),
        ("confidence", Float32Array::from(map.confidence.as_slice()).into()),
        ("overlap", Float32Array::from(overlap).into()),
        ("functionalMap", matrix_to_js(&functional.matrix)?),
    ])
}

fn matrix_to_js(matrix: &Array2<f64>) -> Result<JsValue, JsValue> {
    object([("rows", matrix.nrows().into()), ("cols", matrix.ncols().into()), ("data", f64s(matrix))])
}
