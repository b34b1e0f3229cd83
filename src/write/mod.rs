//! A scan in colours, as a file.

mod colour;
mod glb;
mod ply;

pub(crate) use colour::{LinearRgb, from_srgb_byte, place_colour, to_srgb_byte, upright};
pub(crate) use glb::glb;
pub(crate) use ply::ply;

use crate::shape::{Axis, Shape};

/// What is written: a scan, and what is known of its size and stand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<'b> {
    pub shape: &'b Shape,
    pub name: Option<&'b str>,
    /// `"m"`, `"cm"` or `"mm"`, where it is clear.
    pub unit: Option<&'b str>,
    pub up: Option<Axis>,
    /// √area, in the unit of the scan.
    pub scale: f64,
}
