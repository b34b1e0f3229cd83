//! Binary PLY and OFF files of a body.

use std::io::{self, Write};

use glam::DVec3;

/// Little-endian binary PLY: x, y, z as `float`, `label` as `uchar` if given, and triangles if there are any. `comments` go
/// to the header, one line each.
pub fn write_ply(
    out: &mut impl Write,
    points: &[DVec3],
    triangles: &[[u32; 3]],
    labels: Option<&[u32]>,
    comments: &[String],
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    for comment in comments {
        writeln!(out, "comment {comment}")?;
    }
    writeln!(out, "element vertex {}\nproperty float x\nproperty float y\nproperty float z", points.len())?;
    if labels.is_some() {
        writeln!(out, "property uchar label")?;
    }
    if !triangles.is_empty() {
        writeln!(out, "element face {}\nproperty list uchar uint vertex_indices", triangles.len())?;
    }
    writeln!(out, "end_header")?;
    for (i, p) in points.iter().enumerate() {
        for x in p.as_vec3().to_array() {
            out.write_all(&x.to_le_bytes())?;
        }
        if let Some(labels) = labels {
            out.write_all(&[labels[i] as u8])?;
        }
    }
    for t in triangles {
        out.write_all(&[3])?;
        for v in t {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    Ok(())
}

/// ASCII OFF with six decimals (micrometres, when positions are metres).
pub fn write_off(out: &mut impl Write, points: &[DVec3], triangles: &[[u32; 3]]) -> io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", points.len(), triangles.len())?;
    for p in points {
        writeln!(out, "{:.6} {:.6} {:.6}", p.x, p.y, p.z)?;
    }
    for [a, b, c] in triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}
