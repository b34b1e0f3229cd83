use crate::sample::{all_formats, assert_is_torus, csv, obj, off, parse, ply_text, repaired, stl_text, torus, xyz};

fn utf16(text: &str, unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(unit).collect()
}

#[test]
fn every_text_format_is_read_in_utf_16_of_either_order_with_or_without_a_mark() {
    let gltf = all_formats().into_iter().find(|(name, _)| *name == "a.gltf").expect("glTF").1;
    for (name, text) in [
        ("a.off", off(&torus())),
        ("a.obj", obj(&torus())),
        ("a.ply", ply_text(&torus())),
        ("a.stl", stl_text(&torus())),
        ("a.xyz", xyz(&torus())),
        ("a.csv", csv(&torus())),
        ("a.gltf", String::from_utf8(gltf).expect("text")),
    ] {
        let expected = parse(&text, name).expect("the original");
        for unit in [u16::to_le_bytes, u16::to_be_bytes] {
            for text in [text.clone(), format!("\u{feff}{text}"), text.replace('\n', "\r\n")] {
                for name in [name, "a", "a.txt"] {
                    let shape = parse(utf16(&text, unit), name).unwrap_or_else(|e| panic!("{name}: {e}"));
                    assert_eq!(shape, expected, "{name}");
                }
            }
        }
    }
}

#[test]
fn names_in_latin_1_are_no_obstacle() {
    let latin = |text: String| text.chars().map(|c| c as u32 as u8).collect::<Vec<u8>>();
    let table = csv(&torus())
        .replace("x,y,z", "x,y,z,gr\u{f6}\u{df}e")
        .replacen("\n", "\0", 1)
        .replace('\n', ",1\n")
        .replace('\0', "\n");
    let shape = parse(latin(table), "a.csv").unwrap();
    assert_eq!((shape.points(), repaired(&shape, "columns-ignored")), (&torus().points[..], 1));
    assert!(shape.repairs()[0].message.ends_with("gr\u{f6}\u{df}e"), "{}", shape.repairs()[0].message);
    assert_is_torus(&parse(latin(format!("o K\u{f6}rper\n{}", obj(&torus()))), "a.obj").unwrap());
    assert_is_torus(&parse(latin(ply_text(&torus()).replace("made by a test", "K\u{f6}rper")), "a.ply").unwrap());
    assert_is_torus(&parse(latin(format!("# K\u{f6}rper\n{}", off(&torus()))), "a.off").unwrap());
    assert!(parse(latin(stl_text(&torus()).replace("made by a test", "K\u{f6}rper")), "a.stl").is_ok());
    let (_, gltf) = all_formats().into_iter().find(|(name, _)| *name == "a.gltf").expect("glTF");
    let gltf = String::from_utf8(gltf).expect("text").replacen('{', "{\"extras\":\"K\u{f6}rper\",", 1);
    assert_is_torus(&parse(latin(gltf), "a.gltf").unwrap());
}
