//! What every verb takes: options that several share, scans, and files to write.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use crate::device::Cpu;
use crate::network::{Model, Weights};
use crate::operators::LaplacianKind;
use crate::pipeline::{DeviceChoice, OptionError, PrepareOptions, Processor};
use crate::shape::Axis;

/// Options that prepare a scan.
#[derive(Args, Clone, Debug)]
pub(super) struct Preparing {
    /// Points that take part in the matching; up to 1.5 times as many stay whole.
    #[arg(long, default_value_t = 5000)]
    pub points: usize,
    /// Eigenpairs of the basis.
    #[arg(long, default_value_t = 120)]
    pub eigenpairs: usize,
    /// geodesic, geodesic-literal, euclidean, gaussian or cotangent; by default cotangent on meshes and geodesic on clouds.
    #[arg(long)]
    pub laplacian: Option<LaplacianKind>,
    /// The axis that points up: x, y or z.
    #[arg(long, value_parser = parse::<Axis>)]
    pub up: Option<Axis>,
    /// All of a scan is the body: no floor, furniture, other body, loose piece or garment in it is set aside.
    #[arg(long)]
    pub whole_scan: bool,
}

impl Preparing {
    pub fn options(&self) -> PrepareOptions {
        PrepareOptions {
            points: self.points,
            eigenpairs: self.eigenpairs,
            laplacian: self.laplacian,
            up: self.up,
            whole_scan: self.whole_scan,
            ..Default::default()
        }
    }

    /// Refuses what is out of range, before anything is read.
    pub fn check(&self) -> Result<(), Failure> {
        Ok(self.options().check().map_err(WrongUse)?)
    }
}

/// Options on what a program runs with.
#[derive(Args, Clone, Debug)]
pub(super) struct Running {
    /// What computes: auto, cpu or webgpu.
    #[arg(long, default_value = "auto", value_parser = parse::<DeviceChoice>)]
    pub device: DeviceChoice,
    /// Network weights in place of the built-in ones. May be given several times, for several kinds of bodies: those most at home with a pair match it.
    #[arg(long)]
    pub weights: Vec<PathBuf>,
    /// Seed of whatever is random; a match has nothing random in it.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

impl Running {
    /// The device of choice, with the network.
    pub fn processor(&self) -> Result<Processor, Failure> {
        Ok(pollster::block_on(Processor::open(self.model()?, self.device))?)
    }

    /// For what runs on the processor only.
    pub fn check_cpu(&self) -> Result<(), Failure> {
        match self.device {
            DeviceChoice::Webgpu => Err("this runs on the CPU only: use --device auto or cpu".into()),
            DeviceChoice::Auto | DeviceChoice::Cpu => Ok(()),
        }
    }

    /// The network.
    pub fn model(&self) -> Result<Arc<Model>, Failure> {
        if self.weights.is_empty() {
            return Ok(Model::embedded().clone());
        }
        let mut weights = Vec::with_capacity(self.weights.len());
        for path in &self.weights {
            let failed = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
            let bytes = std::fs::read(path).map_err(|e| failed(&e))?;
            let one = Arc::new(Weights::from_bytes(&bytes).map_err(|e| failed(&e))?);
            // By itself first: what does not fit its network is told with the file it came from.
            Model::on([one.clone()], Cpu).map_err(|e| failed(&e))?;
            weights.push(one);
        }
        Ok(Arc::new(Model::on(weights, Cpu)?))
    }
}

/// What went wrong, in a sentence.
pub(super) type Failure = Box<dyn std::error::Error>;

/// An option that can be told to be wrong before anything is read.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub(super) struct WrongUse(#[from] pub OptionError);

/// A name as the options of the library spell it.
pub(super) fn parse<T: serde::de::DeserializeOwned>(name: &str) -> Result<T, String> {
    serde_json::from_value(name.into()).map_err(|e| e.to_string())
}

/// Writes a file and says so: some verbs write two.
pub(super) fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
    std::fs::write(path, contents).map_err(|e| format!("{}: {e}", path.display()))?;
    eprintln!("written: {}", path.display());
    Ok(())
}
