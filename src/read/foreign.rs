//! Files that are known for what they are and not read: scans in other formats, archives, and what a download gives in place of a scan.

use super::error::ReadError;

const AS_MESH: &str = "open it in a program for meshes, such as Blender or MeshLab, and save it as PLY, OBJ or GLB";
const AS_CLOUD: &str = "open it in a program for point clouds, such as CloudCompare, and save it as PLY";
const AS_POINTS: &str = "save the splats as a PLY that is not compressed (SuperSplat and splat-transform do), whose centres are read as points";
const UNPACKED: &str = "unpack it and take the scan inside";
const AS_SURFACE: &str = "make a surface of it (3D Slicer does) and save that as PLY, OBJ or STL";

/// What begins with these bytes.
const BEGINNINGS: [(&[u8], &str, &str); 28] = [
    (b"ASTM-E57", "an E57 scan", AS_CLOUD),
    (b"DRACO", "a Draco file (.drc)", "decode it (draco_decoder writes PLY and OBJ), or save the mesh without Draco"),
    (b"NGSP", "a compressed Gaussian splat (SPZ)", AS_POINTS),
    (b"Kaydara FBX Binary", "an FBX scene", AS_MESH),
    (b"; FBX", "an FBX scene in text", AS_MESH),
    (b"PXR-USDC", "a USD scene", AS_MESH),
    (b"#usda", "a USD scene in text", AS_MESH),
    (b"BLENDER", "a Blender scene", "export the mesh as PLY, OBJ or GLB"),
    (b"# vtk DataFile", "a VTK file", "save it as PLY, OBJ or STL (ParaView does)"),
    (b"# .PCD", "a PCD cloud", AS_CLOUD),
    (b"VERSION .7", "a PCD cloud", AS_CLOUD),
    (b"VERSION 0.7", "a PCD cloud", AS_CLOUD),
    (b"#VRML", "a VRML scene", AS_MESH),
    (b"#X3D", "an X3D scene", AS_MESH),
    (b"ISO-10303-21", "a STEP model", "save its surface as STL, OBJ or PLY from a program for CAD"),
    (b"xof 0", "a DirectX mesh", AS_MESH),
    (b"\x93NUMPY", "an array of NumPy", "save it as text (numpy.savetxt) or as PLY"),
    (b"\x89HDF", "an HDF5 file", "save the points as text or as PLY"),
    (b"MATLAB 5.0", "a MATLAB file", "save the points as text or as PLY"),
    (b"7z\xBC\xAF\x27\x1C", "an archive (7z)", UNPACKED),
    (b"Rar!", "an archive (RAR)", UNPACKED),
    (b"BZh", "a file compressed with bzip2", UNPACKED),
    (b"\xFD7zXZ", "a file compressed with xz", UNPACKED),
    (b"\x28\xB5\x2F\xFD", "a file compressed with Zstandard", UNPACKED),
    (b"%PDF", "a PDF", "save the scan itself as PLY, OBJ or GLB"),
    (
        b"version https://git-lfs",
        "not the scan but a pointer to it, as Git LFS keeps",
        "fetch the file itself (git lfs pull)",
    ),
    (b"<!DOCTYPE html", "a web page", "download the scan itself: the page was saved in its place"),
    (b"<html", "a web page", "download the scan itself: the page was saved in its place"),
];

/// Elements that an XML file is known by.
const ELEMENTS: [(&str, &str, &str); 6] = [
    ("<COLLADA", "a COLLADA scene (DAE)", AS_MESH),
    ("<X3D", "an X3D scene", AS_MESH),
    ("<VTKFile", "a VTK file", "save it as PLY, OBJ or STL (ParaView does)"),
    ("<amf", "an AMF model", AS_MESH),
    ("<model", "a 3MF model", AS_MESH),
    ("<html", "a web page", "download the scan itself: the page was saved in its place"),
];

/// Files that an archive (zip) is known by.
const INSIDE: [(&[u8], &str, &str); 6] = [
    (b"3D/", "a 3MF model", AS_MESH),
    (b".usd", "a USDZ scene", AS_MESH),
    (b"xl/", "a workbook of Excel", "save its table as CSV"),
    (b"meta.json", "a compressed Gaussian splat (SOG)", AS_POINTS),
    (b".npy", "arrays of NumPy", "save them as text (numpy.savetxt) or as PLY"),
    (b"doc.kml", "a KMZ file", AS_MESH),
];

/// Bytes in which an element of XML is looked for.
const PROLOGUE: usize = 4096;
/// Files of an archive whose names are looked at.
const ENTRIES: usize = 64;

/// What a file is that is certainly none of the formats read, with the way out.
pub(super) fn known(bytes: &[u8], name: Option<&str>) -> Option<ReadError> {
    let text = bytes.trim_ascii_start();
    let begins = |mark: &[u8]| text.get(..mark.len()).is_some_and(|b| b.eq_ignore_ascii_case(mark));
    let named = |ending: &str| name.is_some_and(|n| n.to_ascii_lowercase().ends_with(ending));
    if let Some((_, what, cure)) = BEGINNINGS.into_iter().find(|(mark, ..)| begins(mark)) {
        return Some(refusal(what, cure));
    }
    if bytes.starts_with(b"LASF") {
        // The highest bit of the point format marks compressed points.
        let compressed = bytes.get(104).is_some_and(|format| format & 0x80 != 0);
        return Some(refusal(if compressed { "a LAZ scan" } else { "a LAS scan" }, AS_CLOUD));
    }
    if bytes.starts_with(b"\x1F\x8B") {
        let splat = named(".spz");
        let what = if splat { "a compressed Gaussian splat (SPZ)" } else { "a file compressed with gzip" };
        return Some(refusal(what, if splat { AS_POINTS } else { UNPACKED }));
    }
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        let found = INSIDE.into_iter().find(|(part, ..)| entries(bytes).any(|name| has(name, part)));
        let (what, cure) = found.map_or(("an archive (zip)", UNPACKED), |(_, what, cure)| (what, cure));
        return Some(refusal(what, cure));
    }
    if begins(b"<") {
        let prologue = String::from_utf8_lossy(&text[..text.len().min(PROLOGUE)]);
        let found = ELEMENTS.into_iter().find(|(element, ..)| prologue.contains(element));
        return found.map(|(_, what, cure)| refusal(what, cure)).or_else(|| {
            begins(b"<?xml").then(|| refusal("an XML file that is no scan", "save the scan as PLY, OBJ or GLB"))
        });
    }
    if bytes.get(128..132) == Some(b"DICM") {
        return Some(refusal("a DICOM image", AS_SURFACE));
    }
    if matches!(bytes.get(344..348), Some(b"n+1\0" | b"ni1\0")) {
        return Some(refusal("a volume (NIfTI)", AS_SURFACE));
    }
    (begins(b";") && has(&text[..text.len().min(PROLOGUE)], b"FBXHeaderExtension"))
        .then(|| refusal("an FBX scene in text", AS_MESH))
}

/// What bytes that no format announces look like: splats of 32 bytes each, which have no header.
pub(super) fn like(bytes: &[u8], name: Option<&str>) -> Option<ReadError> {
    const SPLAT: usize = 32;
    const LOOKED_AT: usize = 64;
    let (splats, rest) = bytes.as_chunks::<SPLAT>();
    let is_splat = |splat: &[u8; SPLAT]| {
        let number =
            |k: usize| f32::from_le_bytes([splat[4 * k], splat[4 * k + 1], splat[4 * k + 2], splat[4 * k + 3]]);
        // Centre, then three extents, none of them negative, none enormous; denormals are what text and whole numbers look like.
        let fits = |c: f32| c == 0.0 || (1e-30..1e6).contains(&c.abs());
        (0..3).all(|k| fits(number(k))) && (3..6).all(|k| fits(number(k)) && number(k) >= 0.0)
    };
    let named = name.is_some_and(|n| n.to_ascii_lowercase().ends_with(".splat"));
    let looks = rest.is_empty() && splats.len() >= 50 && splats.iter().take(LOOKED_AT).all(is_splat);
    (named || looks).then(|| refusal("a Gaussian splat (.splat)", AS_POINTS))
}

/// A PLY that keeps Gaussian splats in chunks.
pub(super) fn compressed_splats() -> ReadError {
    refusal("a PLY of compressed Gaussian splats", AS_POINTS)
}

fn refusal(what: &'static str, cure: &'static str) -> ReadError {
    ReadError::UnsupportedFormat { what, cure }
}

/// Names of the first files of an archive.
fn entries(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut at = 0;
    let next = move || {
        let header = bytes.get(at..at + 30).filter(|h| h.starts_with(b"PK\x03\x04"))?;
        let half = |k: usize| usize::from(u16::from_le_bytes([header[k], header[k + 1]]));
        let size = u32::from_le_bytes([header[18], header[19], header[20], header[21]]) as usize;
        let name = bytes.get(at + 30..at + 30 + half(26))?;
        at = (at + 30 + half(26) + half(28)).checked_add(size)?;
        Some(name)
    };
    std::iter::from_fn(next).take(ENTRIES)
}

fn has(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|w| w == part)
}
