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

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 0.5, -1.0)];

    #[test]
    fn ply_holds_what_its_header_says() {
        let mut bytes = Vec::new();
        write_ply(&mut bytes, &POINTS, &[[0, 1, 2]], Some(&[0, 3, 13]), &["a note".to_owned()]).expect("memory");
        let end = b"end_header\n";
        let body = bytes.windows(end.len()).position(|w| w == end).expect("ends") + end.len();
        let header = str::from_utf8(&bytes[..body]).expect("text");
        assert!(
            header.starts_with("ply\nformat binary_little_endian 1.0\ncomment a note\nelement vertex 3\n"),
            "{header}"
        );
        assert_eq!(bytes.len() - body, 3 * 13 + 13);
        assert_eq!(bytes[body + 2 * 13 + 8..][..5], [0, 0, 0x80, 0xbf, 13], "z = -1 and label 13");
    }

    #[test]
    fn off_is_plain_text() {
        let mut bytes = Vec::new();
        write_off(&mut bytes, &POINTS, &[[0, 1, 2]]).expect("memory");
        let text = String::from_utf8(bytes).expect("text");
        assert!(text.starts_with("OFF\n3 1 0\n0.000000 ") && text.ends_with("\n3 0 1 2\n"), "{text}");
    }
}
