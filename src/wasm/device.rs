//! The device and what runs on it. On the CPU nothing waits, and calls that return at once keep a trap where it can be caught; a GPU has to be waited for.

use js_sys::Function;
use wasm_bindgen::prelude::*;

use super::convert::{match_to_js, options, plain, throw};
use super::{RawShape, memory_bytes, progress};
use crate::model::Model;
use crate::options::{MatchOptions, PrepareOptions};
use crate::prepared::PreparedShape;
use crate::processor::{DeviceKind, Processor};
use crate::progress::Stage;

/// The network on a device.
#[wasm_bindgen]
pub struct Device {
    processor: Processor,
}

/// Opens `'auto'`, `'cpu'` or `'webgpu'`.
#[wasm_bindgen]
pub async fn open_device(choice: JsValue) -> Result<Device, JsValue> {
    let choice = options(&choice)?;
    let processor = Processor::open(Model::embedded(), choice).await.map_err(|e| throw(e.into()))?;
    Ok(Device { processor })
}

#[wasm_bindgen]
impl Device {
    /// `{ kind, reason, adapter? }`.
    pub fn info(&self) -> JsValue {
        plain(self.processor.info())
    }

    /// Whether calls have to be waited for.
    pub fn waits(&self) -> bool {
        self.processor.info().kind == DeviceKind::Webgpu
    }

    /// Consumes the scan and returns the prepared block. Only where nothing waits.
    pub fn prepare(&mut self, shape: RawShape, given: JsValue, listener: &Function) -> Result<Vec<u8>, JsValue> {
        pollster::block_on(self.prepare_waiting(shape, given, listener.clone()))
    }

    /// Consumes the scan and returns the prepared block.
    pub async fn prepare_waiting(
        &mut self,
        shape: RawShape,
        given: JsValue,
        listener: Function,
    ) -> Result<Vec<u8>, JsValue> {
        let options: PrepareOptions = options(&given)?;
        let RawShape { shape, name, seconds } = shape;
        let mut progress = progress(&listener);
        progress.add_seconds(Stage::Read, seconds);
        let prepared = self.processor.prepare(shape, name, &options, &mut progress).await.map_err(throw)?;
        prepared.to_bytes().map_err(|e| throw(e.into()))
    }

    /// Matches two prepared blocks. Only where nothing waits.
    pub fn match_pair(
        &mut self,
        a: Vec<u8>,
        b: Vec<u8>,
        given: JsValue,
        listener: &Function,
    ) -> Result<JsValue, JsValue> {
        pollster::block_on(self.match_pair_waiting(a, b, given, listener.clone()))
    }

    /// Matches two prepared blocks.
    pub async fn match_pair_waiting(
        &mut self,
        a: Vec<u8>,
        b: Vec<u8>,
        given: JsValue,
        listener: Function,
    ) -> Result<JsValue, JsValue> {
        let options: MatchOptions = options(&given)?;
        let block = |bytes: Vec<u8>| PreparedShape::from_bytes(&bytes).map_err(|e| throw(e.into()));
        let (a, b) = (block(a)?, block(b)?);
        let mut progress = progress(&listener);
        let matched = self.processor.match_shapes(&a, &b, &options, &mut progress).await.map_err(throw)?;
        match_to_js(&matched, memory_bytes())
    }
}
