//! The device and what runs on it. On the CPU nothing waits, and calls that return at once keep a trap where it can be caught; a GPU has to be waited for.

use std::sync::Arc;

use js_sys::{Array, Function, Uint8Array};
use wasm_bindgen::prelude::*;

use super::convert::{match_to_js, options, plain, throw};
use super::{RawShape, memory_bytes, tell};
use crate::device::Cpu;
use crate::network::{Model, Weights};
use crate::pipeline::PreparedShape;
use crate::pipeline::Processor;
use crate::pipeline::{MatchOptions, PrepareOptions};
use crate::progress::{Progress, Stage};

/// The network on a device.
#[wasm_bindgen]
pub struct Device {
    processor: Processor,
    /// For tests: the stage in which the next call loses the GPU.
    lose_at: Option<String>,
}

/// Opens `'auto'`, `'cpu'` or `'webgpu'`, which fails without one. `again` opens the kind of device that was opened and tested before: where there is none
/// now the CPU does its work. `weights` are files (`Uint8Array`s) in place of those that ship.
#[wasm_bindgen]
pub async fn open_device(choice: JsValue, again: bool, weights: Option<Array>) -> Result<Device, JsValue> {
    let (model, choice) = (weights.map_or_else(|| Ok(Model::embedded().clone()), own_model)?, options(&choice)?);
    let processor = match again {
        true => Processor::reopen(model, choice).await,
        false => Processor::open(model, choice).await.map_err(|e| throw(e.into()))?,
    };
    Ok(Device { processor, lose_at: None })
}

/// Networks from files of weights.
fn own_model(files: Array) -> Result<Arc<Model>, JsValue> {
    let weights = files.iter().map(|file| Weights::from_bytes(&Uint8Array::new(&file).to_vec()).map(Arc::new));
    let model = weights.collect::<Result<Vec<_>, _>>().and_then(|weights| Model::on(weights, Cpu));
    Ok(Arc::new(model.map_err(|e| throw(e.into()))?))
}

#[wasm_bindgen]
impl Device {
    /// `{ kind, reason, adapter? }`.
    pub fn info(&self) -> JsValue {
        plain(self.processor.info())
    }

    /// Whether calls have to be waited for.
    pub fn waits(&self) -> bool {
        self.processor.waits()
    }

    /// Loses the GPU in a stage of the next call, as a driver might, so that tests can see the CPU take over.
    pub fn lose_at(&mut self, stage: String) {
        self.lose_at = Some(stage);
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
        let mut progress = self.progress(&listener);
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
        let mut progress = self.progress(&listener);
        let matched = self.processor.match_shapes(&a, &b, &options, &mut progress).await.map_err(throw)?;
        match_to_js(&matched, memory_bytes())
    }
}

impl Device {
    /// Tells `listener`, and loses the GPU where that was asked for.
    fn progress<'a>(&mut self, listener: &'a Function) -> Progress<'a> {
        let lose = self.lose_at.take().zip(self.processor.losing());
        Progress::new(move |stage, fraction| {
            tell(listener, stage, fraction);
            if let Some((at, lose)) = &lose
                && at == stage.name()
            {
                lose();
            }
            true
        })
    }
}
