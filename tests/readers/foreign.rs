use crate::sample::{Sample, parse, ply_binary, refused, torus};

/// An archive with one empty file in it.
fn zip(name: &str) -> Vec<u8> {
    let mut bytes = b"PK\x03\x04".to_vec();
    bytes.resize(26, 0);
    bytes.extend((name.len() as u16).to_le_bytes());
    bytes.extend([0, 0]);
    bytes.extend(name.as_bytes());
    bytes
}

/// `mark` at `at` among zeros.
fn marked(at: usize, mark: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; 400];
    bytes[at..at + mark.len()].copy_from_slice(mark);
    bytes
}

#[test]
fn scans_in_other_formats_are_named_with_the_way_out() {
    let las = |format: u8| {
        let mut bytes = marked(0, b"LASF");
        bytes[104] = format;
        bytes
    };
    let splat: Vec<u8> = torus()
        .points
        .iter()
        .flat_map(|p| {
            let numbers = p.iter().map(|&c| c as f32).chain([0.01, 0.02, 0.005]);
            numbers.flat_map(f32::to_le_bytes).chain([200, 100, 50, 255, 128, 128, 128, 255]).collect::<Vec<u8>>()
        })
        .collect();
    for (bytes, name, what) in [
        (marked(0, b"ASTM-E57"), "a.e57", "an E57 scan"),
        (las(3), "a.las", "a LAS scan"),
        (las(0x83), "a.laz", "a LAZ scan"),
        (marked(0, b"Kaydara FBX Binary  "), "a.fbx", "an FBX scene"),
        (b"; FBX 7.3.0 project file\nFBXHeaderExtension: {".to_vec(), "a.fbx", "an FBX scene in text"),
        (b"<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">".to_vec(), "a.dae", "a COLLADA scene"),
        (zip("3D/3dmodel.model"), "a.3mf", "a 3MF model"),
        (zip("scene.usdc"), "a.usdz", "a USDZ scene"),
        (zip("body.ply"), "a.zip", "an archive (zip)"),
        (zip("xl/workbook.xml"), "a.xlsx", "a workbook of Excel"),
        (b"PXR-USDC".to_vec(), "a.usd", "a USD scene"),
        (marked(0, b"DRACO\x02\x02"), "a.drc", "a Draco file"),
        (marked(0, b"\x1F\x8B\x08"), "a.spz", "a compressed Gaussian splat (SPZ)"),
        (marked(0, b"\x1F\x8B\x08"), "a.stl.gz", "a file compressed with gzip"),
        (splat, "a.splat", "a Gaussian splat (.splat)"),
        (marked(128, b"DICM"), "a.dcm", "a DICOM image"),
        (marked(344, b"n+1\0"), "a.nii", "a volume (NIfTI)"),
        (b"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\n".to_vec(), "a.pcd", "a PCD cloud"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n".to_vec(), "a.ply", "a pointer to it"),
        (b"<!doctype html><html>".to_vec(), "a.stl", "a web page"),
    ] {
        for name in [name, "scan", "scan.obj"] {
            let is_named = name != "a.spz" && what.contains("SPZ") || what.contains("(.splat)") && name == "scan.obj";
            if is_named {
                continue; // what gzip holds is known by its name only, and splats have no mark
            }
            let (code, message, details) = refused(parse(&bytes, name));
            assert_eq!(code, "unsupported-format", "{name}: {message}");
            assert!(
                message.contains(what) && message.contains("; ") && details["what"].is_string(),
                "{name}: {message}"
            );
        }
    }
}

#[test]
fn splats_in_chunks_of_a_ply_are_named_and_splats_in_a_plain_one_are_points() {
    let header = "ply\nformat binary_little_endian 1.0\nelement chunk 1\nproperty float min_x\nelement vertex 64\n\
                  property uint packed_position\nproperty uint packed_rotation\nproperty uint packed_scale\n\
                  property uint packed_color\nend_header\n";
    let (code, message, _) = refused(parse([header.as_bytes(), &[0; 4 + 64 * 16]].concat(), "a.compressed.ply"));
    assert_eq!(code, "unsupported-format");
    assert!(message.contains("splats") && message.contains("not compressed"), "{message}");
    let plain = ply_binary(&Sample { faces: vec![], ..torus() }, false);
    assert_eq!(parse(plain, "a.ply").unwrap().points(), torus().points);
}

#[test]
fn a_binary_stl_is_one_whatever_its_header_says() {
    let mut bytes = crate::sample::stl_binary(&torus());
    bytes[..9].copy_from_slice(b"BLENDER 4");
    assert_eq!(parse(bytes, "a.stl").unwrap().faces().len(), 128);
}
