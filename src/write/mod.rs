//! Scans with a colour per point, as files for other programs. The page writes the same (`www/src/exports`).

mod glb;
mod ply;

pub(crate) use glb::glb;
pub(crate) use ply::ply;
