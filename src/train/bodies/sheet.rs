//! Many random bodies in one file, in rows: to be looked at.

use std::fs;
use std::path::Path;

use glam::{DQuat, DVec3};

use super::BodyModel;
use super::samples::SampleError;
use super::write::write_ply;

/// Bodies in a row.
const COLUMNS: usize = 8;
/// Distances between columns and rows in metres.
const CELL: [f64; 2] = [1.6, 2.2];
/// Bodies turn their left side forward a little (radians).
const TURN: f64 = -0.5;

/// Writes the bodies of `count` seeds from `seed` on as one labelled mesh (binary PLY, metres, rows downwards from the first).
pub fn write_sheet(model: &BodyModel, out: &Path, count: usize, seed: u64) -> Result<Vec<String>, SampleError> {
    let template = model.template(5000)?;
    let (mut points, mut triangles, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..count {
        let body = model.random_body(&template, seed + i as u64)?;
        let first = points.len() as u32;
        let cell = DVec3::new((i % COLUMNS) as f64 * CELL[0], -((i / COLUMNS) as f64) * CELL[1], 0.0);
        let turn = DQuat::from_rotation_y(TURN);
        points.extend(template.pick(&body.skin).into_iter().map(|p| turn * p + cell));
        triangles.extend(template.triangles.iter().map(|t| t.map(|v| v + first)));
        labels.extend(&template.labels);
    }
    let mut bytes = Vec::new();
    write_ply(&mut bytes, &points, &triangles, Some(&labels), &[]).expect("writing to memory does not fail");
    fs::write(out, bytes).map_err(|source| SampleError::Write { path: out.to_owned(), source })?;
    Ok(vec![out.display().to_string()])
}
