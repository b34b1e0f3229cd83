//! What JavaScript calls: convert, call, convert back. Everything runs inside a worker, and all but the GPU is synchronous.
//!
//! A typed error is thrown as a plain object `{ code, message, details }`; anything else that is thrown is a trap, after which the
//! instance must be discarded.

mod convert;
mod device;
mod remains;

use js_sys::Function;
use wasm_bindgen::prelude::*;
use web_time::Instant;

use crate::pipeline::Error;
use crate::pipeline::PreparedShape;
use crate::progress::{Progress, Stage};
use crate::read::{Format, ReadOptions, read_with};
use crate::shape::Shape;
use crate::{operators, spectrum as spectra};
pub use device::{Device, open_device};
pub use remains::{last_panic, refused_bytes};

use convert::{
    LaplacianOptions, SpectrumOptions, files, invalid, laplacian_to_js, matrix_from_csr, options, spectrum_to_js, throw,
};

#[wasm_bindgen(start)]
fn start() {
    remains::keep_panics();
}

/// A scan as read, not yet prepared.
#[wasm_bindgen]
pub struct RawShape {
    shape: Shape,
    name: Option<String>,
    /// Time that reading took.
    seconds: f64,
}

impl RawShape {
    fn timed(name: Option<String>, read: impl FnOnce() -> Result<Shape, Error>) -> Result<Self, JsValue> {
        let start = Instant::now();
        let shape = read().map_err(throw)?;
        Ok(Self { shape, name, seconds: start.elapsed().as_secs_f64() })
    }
}

/// Reads a file's bytes. `format` is an extension's name where the bytes do not tell, `pose` that of a body with a skeleton, and `companions`
/// an object of files beside this one: names and bytes.
#[wasm_bindgen]
pub fn read_file(
    bytes: &[u8],
    name: Option<String>,
    format: Option<String>,
    pose: Option<String>,
    companions: &JsValue,
) -> Result<RawShape, JsValue> {
    let format: Option<Format> = format.map(|f| f.parse()).transpose().map_err(|e| throw(Error::Read(e)))?;
    let pose = pose.map(|p| serde_json::from_value(p.into()).map_err(invalid)).transpose()?.unwrap_or_default();
    let files = files(companions)?;
    let companions: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (&**name, &**bytes)).collect();
    let options = ReadOptions { name: name.as_deref(), format, pose, companions: &companions };
    RawShape::timed(name.clone(), || Ok(read_with(bytes, &options)?))
}

/// A scan from arrays: positions (3n), faces (3m), labels (n).
#[wasm_bindgen]
pub fn read_arrays(
    positions: &[f64],
    faces: Option<Vec<u32>>,
    labels: Option<Vec<u32>>,
    name: Option<String>,
) -> Result<RawShape, JsValue> {
    let faces = faces.unwrap_or_default();
    RawShape::timed(name, || Ok(Shape::from_arrays(positions, &faces, labels.as_deref())?))
}

/// Consumes the scan and returns its Laplacian, every point counting.
#[wasm_bindgen]
pub fn laplacian(shape: RawShape, options_given: JsValue, listener: &Function) -> Result<JsValue, JsValue> {
    laplacian_of(&shape.shape, &options_given, listener)
}

/// The same for the scan inside a prepared block.
#[wasm_bindgen]
pub fn laplacian_of_prepared(block: &[u8], options_given: JsValue, listener: &Function) -> Result<JsValue, JsValue> {
    let prepared = PreparedShape::from_bytes(block).map_err(|e| throw(e.into()))?;
    laplacian_of(&prepared.shape, &options_given, listener)
}

fn laplacian_of(shape: &Shape, options_given: &JsValue, listener: &Function) -> Result<JsValue, JsValue> {
    let options: LaplacianOptions = options(options_given)?;
    let kind = options.kind.unwrap_or_else(|| operators::default_kind(shape));
    let laplacian = options.builder(kind).build(shape, &mut progress(listener)).map_err(|e| throw(e.into()))?;
    laplacian_to_js(&laplacian)
}

/// Eigenpairs of a Laplacian given as compressed rows.
#[wasm_bindgen]
pub fn spectrum(
    indptr: &[u32],
    indices: &[u32],
    values: Vec<f64>,
    mass: &[f64],
    options_given: JsValue,
    listener: &Function,
) -> Result<JsValue, JsValue> {
    let SpectrumOptions { eigenpairs } = options(&options_given)?;
    let matrix = matrix_from_csr(indptr, indices, values, mass.len()).map_err(|e| throw(e.into()))?;
    let (basis, report) =
        spectra::spectrum(&matrix, mass, eigenpairs, &mut progress(listener)).map_err(|e| throw(e.into()))?;
    spectrum_to_js(&basis, &report)
}

/// Version of the crate.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// Bytes of linear memory. It never shrinks, so this is its peak.
#[wasm_bindgen]
pub fn memory_bytes() -> f64 {
    core::arch::wasm32::memory_size(0) as f64 * 65_536.0
}

/// Traps, so that tests can see a caller recover from a trap.
#[wasm_bindgen]
pub fn trap() {
    core::arch::wasm32::unreachable()
}

/// Traps after it was waited for, where nobody is there to catch it.
#[wasm_bindgen]
pub async fn trap_waiting() {
    let _ = wasm_bindgen_futures::JsFuture::from(js_sys::Promise::resolve(&JsValue::NULL)).await;
    core::arch::wasm32::unreachable()
}

fn progress(listener: &Function) -> Progress<'_> {
    Progress::new(|stage, fraction| {
        tell(listener, stage, fraction);
        true
    })
}

/// A listener cannot stop a wasm call; what it throws is its own concern.
fn tell(listener: &Function, stage: Stage, fraction: f64) {
    let _ = listener.call2(&JsValue::UNDEFINED, &stage.name().into(), &fraction.into());
}
