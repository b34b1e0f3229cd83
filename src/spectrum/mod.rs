//! Eigenpairs of L φ = λ M φ and the basis they make.

mod basis;
mod dense;
mod error;
mod factor;
mod lanczos;
mod problem;
mod signs;
mod solve;
mod sweeps;

pub use basis::SpectralBasis;
pub use error::SpectrumError;
pub(crate) use factor::Pencil;
pub(crate) use solve::check_size;
pub use solve::{SpectrumReport, spectrum};
