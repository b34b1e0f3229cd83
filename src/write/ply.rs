//! A coloured scan as binary PLY.

use super::{Body, LinearRgb, to_srgb_byte};

/// Points in the order, place and unit they were read in, the faces if there are any, and `colours` (n) as sRGB bytes. Coordinates are f32
/// where that moves no point by a millionth of the scan's size, else f64.
pub(crate) fn ply(body: &Body, colours: &[LinearRgb]) -> Vec<u8> {
    let (points, faces) = (body.shape.points(), body.shape.faces());
    let finest = 1e-6 * body.scale;
    let single = points.as_flattened().iter().all(|&c| (c - f64::from(c as f32)).abs() < finest);
    let float = if single { "float" } else { "double" };
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", points.len());
    ["x", "y", "z"].iter().for_each(|axis| header += &format!("property {float} {axis}\n"));
    ["red", "green", "blue"].iter().for_each(|channel| header += &format!("property uchar {channel}\n"));
    if !faces.is_empty() {
        header += &format!("element face {}\nproperty list uchar int vertex_indices\n", faces.len());
    }
    header += "end_header\n";

    let mut bytes = header.into_bytes();
    bytes.reserve_exact(points.len() * if single { 15 } else { 27 } + 13 * faces.len());
    for (point, colour) in points.iter().zip(colours) {
        for &c in point {
            match single {
                true => bytes.extend((c as f32).to_le_bytes()),
                false => bytes.extend(c.to_le_bytes()),
            }
        }
        bytes.extend(colour.map(to_srgb_byte));
    }
    for face in faces {
        bytes.push(3);
        face.iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    }
    bytes
}
