//! What `geose-fmap match` writes: four kinds of file that say the same, and bodies whose colours correspond.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use geose_fmap::{Shape, read};
use serde_json::Value;
use shapes::{Random, Soup, scan};

/// The surface of a box of 200 × 240 × 400 millimetres that stands on its smallest side, 1000 from the origin, in some order.
fn standing_box(seed: u64) -> Soup {
    let n = 10_u32;
    let mut soup = Soup { points: vec![], faces: vec![] };
    let mut place = std::collections::HashMap::new();
    for axis in 0..3 {
        for side in [0, n] {
            let mut at = |i: u32, j: u32| {
                let mut p = [0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, i, j);
                *place.entry(p).or_insert_with(|| {
                    soup.points.push([0, 1, 2].map(|c| 1000.0 + f64::from(p[c]) * [20.0, 24.0, 40.0][c]));
                    soup.points.len() as u32 - 1
                })
            };
            for i in 0..n {
                for j in 0..n {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    soup.faces.extend(if side == n { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
                }
            }
        }
    }
    let order = Random(seed).permutation(soup.points.len());
    soup.renumbered(&order)
}

fn off(soup: &Soup) -> String {
    let mut text = format!("OFF\n{} {} 0\n", soup.points.len(), soup.faces.len());
    soup.points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    soup.faces.iter().for_each(|[a, b, c]| text += &format!("3 {a} {b} {c}\n"));
    text
}

/// A folder of this test's own, with two boxes in it: `a.off`, a mesh, and `b.off`, a mesh or a cloud.
fn folder(name: &str, b_is_mesh: bool) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let [a, b] = [1, 2].map(standing_box);
    std::fs::write(folder.join("a.off"), off(&a)).expect("written");
    std::fs::write(folder.join("b.off"), off(&if b_is_mesh { b } else { b.cloud() })).expect("written");
    folder
}

fn run(folder: &Path, output: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_geose-fmap"))
        .current_dir(folder)
        .args(["match", "a.off", "b.off", "--eigenpairs", "20", "-o", output])
        .output()
        .expect("the program")
}

fn written(folder: &Path, output: &str) -> Vec<u8> {
    let ran = run(folder, output);
    assert!(ran.status.success(), "{output}: {}", String::from_utf8_lossy(&ran.stderr));
    std::fs::read(folder.join(output)).expect("a file")
}

#[test]
fn no_scan_is_written_over() {
    let folder = folder("written-over", false);
    std::fs::copy(folder.join("b.off"), folder.join("map.b.ply")).expect("copied");
    let before = std::fs::read(folder.join("map.b.ply")).expect("a scan");
    let ran = Command::new(env!("CARGO_BIN_EXE_geose-fmap"))
        .current_dir(&folder)
        .args(["match", "a.off", "./map.b.ply", "-o", "map.ply"])
        .output()
        .expect("the program");
    assert!(!ran.status.success());
    assert!(String::from_utf8_lossy(&ran.stderr).contains("map.b.ply is one of the scans"));
    assert_eq!(std::fs::read(folder.join("map.b.ply")).expect("a scan"), before);
}

/// Targets of the points of A, as the CSV says.
fn targets(folder: &Path) -> Vec<usize> {
    let csv = String::from_utf8(written(folder, "map.csv")).expect("text");
    csv.lines().skip(1).map(|line| line.split(',').nth(1).expect("a target").parse().expect("a number")).collect()
}

/// Colours of a PLY that was written here: behind the three coordinates of each point, one record after the other.
fn ply_colours(bytes: &[u8], points: usize, coordinate: usize) -> Vec<[u8; 3]> {
    let start = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let record = 3 * coordinate + 3;
    (0..points)
        .map(|i| {
            let at = start + i * record + 3 * coordinate;
            [bytes[at], bytes[at + 1], bytes[at + 2]]
        })
        .collect()
}

/// JSON and data of a GLB.
fn chunks(bytes: &[u8]) -> (Value, &[u8]) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    (serde_json::from_slice(&bytes[20..20 + length]).expect("JSON"), &bytes[20 + length + 8..])
}

fn glb_colours(bytes: &[u8], points: usize) -> Vec<[f32; 3]> {
    let (document, data) = chunks(bytes);
    let view = &document["bufferViews"]
        [document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].as_u64().expect("colours") as usize];
    let start = view["byteOffset"].as_u64().expect("an offset") as usize;
    let number = |k: usize| f32::from_le_bytes(data[start + 4 * k..start + 4 * k + 4].try_into().expect("four bytes"));
    (0..points).map(|i| [0, 1, 2].map(|c| number(3 * i + c))).collect()
}

#[test]
fn json_has_the_fields_of_the_page_and_says_what_csv_says() {
    let folder = folder("exports-json", true);
    let targets = targets(&folder);
    let json: Value = serde_json::from_slice(&written(&folder, "map.json")).expect("JSON");
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<BTreeSet<_>>();
    let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
    // As www/src/exports/map-table.ts writes them.
    assert_eq!(keys(&json), set(&["a", "b", "match", "map"]));
    assert_eq!(keys(&json["a"]), set(&["name", "points", "kind", "prepared", "repairs"]));
    assert_eq!(
        keys(&json["match"]),
        set(&["refine", "parts", "landmarks", "device", "weights", "category", "scale", "warnings"])
    );
    assert_eq!(keys(&json["map"][0]), set(&["source", "target", "confidence", "overlap"]));
    assert_eq!((&json["a"]["name"], &json["b"]["kind"]), (&"a.off".into(), &"mesh".into()));
    assert_eq!((&json["a"]["points"], &json["a"]["prepared"]["eigenpairs"]), (&602.into(), &20.into()));
    assert_eq!((&json["match"]["device"], &json["match"]["refine"]), (&"cpu".into(), &"best".into()));
    let map = json["map"].as_array().expect("a list");
    assert_eq!(map.len(), targets.len());
    for (i, (line, target)) in map.iter().zip(targets).enumerate() {
        assert_eq!((&line["source"], &line["target"]), (&i.into(), &target.into()));
        assert!((0.0..=1.0).contains(&line["confidence"].as_f64().expect("a number")));
    }
}

#[test]
fn ply_holds_both_bodies_as_they_came_in_colours_that_correspond() {
    let folder = folder("exports-ply", true);
    let targets = targets(&folder);
    let files = [written(&folder, "map.ply"), std::fs::read(folder.join("map.b.ply")).expect("the second body")];
    let [a, b] = ["a.off", "b.off"].map(|name| scan(&folder.join(name)));
    for (bytes, original) in files.iter().zip([&a, &b]) {
        let back = read(bytes, Some("map.ply"), None).expect("our own PLY");
        assert_eq!((back.points(), back.faces(), back.repairs().len()), (original.points(), original.faces(), 0));
    }
    let [on_a, on_b] = [0, 1].map(|k| ply_colours(&files[k], 602, 4));
    assert!(targets.iter().zip(&on_a).all(|(&target, colour)| *colour == on_b[target]));
    assert!(on_b.iter().collect::<BTreeSet<_>>().len() > 300, "a place has its own colour");
}

#[test]
fn a_place_has_the_colour_that_the_page_gives_it() {
    let folder = folder("exports-place", true);
    written(&folder, "map.ply");
    let b = scan(&folder.join("b.off"));
    let colours = ply_colours(&std::fs::read(folder.join("map.b.ply")).expect("the second body"), 602, 4);
    // Places in the box of the body standing upright (x right, y up, z front), and what www/src/colour gives for them, run in Node.
    let page = [
        ([0.0, 0.0, 0.0], [38, 71, 175]),
        ([1.0, 1.0, 1.0], [255, 196, 44]),
        ([0.0, 1.0, 0.5], [162, 211, 255]),
        ([1.0, 0.0, 1.0], [156, 24, 0]),
        ([0.5, 0.0, 0.0], [76, 85, 83]),
    ];
    for ([x, y, z], expected) in page {
        // z is up, so the body's −y looks to the front.
        let place = [1000.0 + 200.0 * x, 1000.0 + 240.0 * (1.0 - z), 1000.0 + 400.0 * y];
        let point = b.points().iter().position(|&p| p == place).expect("a point there");
        assert_eq!(colours[point], expected, "at {x} {y} {z}");
    }
}

#[test]
fn glb_holds_both_bodies_upright_in_metres_in_colours_that_correspond() {
    for mesh in [true, false] {
        let folder = folder(if mesh { "exports-glb" } else { "exports-glb-cloud" }, mesh);
        let targets = targets(&folder);
        let files = [written(&folder, "map.glb"), std::fs::read(folder.join("map.b.glb")).expect("the second body")];
        let originals = ["a.off", "b.off"].map(|name| scan(&folder.join(name)));
        for (bytes, original) in files.iter().zip(&originals) {
            let back = read(bytes, Some("map.glb"), None).expect("our own GLB");
            assert_eq!((back.faces(), back.repairs().len()), (original.faces(), 0));
            for (p, [x, y, z]) in back.points().iter().zip(original.points()) {
                let expected = [0.001 * x, 0.001 * z, -0.001 * y];
                assert!((0..3).all(|c| (p[c] - expected[c]).abs() < 1e-6), "{p:?} is not {expected:?}");
            }
            let (document, data) = chunks(bytes);
            assert_eq!(document["buffers"][0]["byteLength"], data.len());
            assert_eq!(document["accessors"][0]["min"], serde_json::json!([-100.0, -120.0, -200.0]));
        }
        let [on_a, on_b] = [0, 1].map(|k| glb_colours(&files[k], 602));
        assert!(targets.iter().zip(&on_a).all(|(&target, colour)| *colour == on_b[target]));
        assert!(on_b.iter().flatten().all(|c| (0.0..=1.0).contains(c)));
    }
}

#[test]
fn bodies_far_from_the_origin_keep_their_shape() {
    let folder = folder("exports-far", true);
    let far = standing_box(2).moved(|p| p.map(|c| c + 1e7 + 0.1));
    std::fs::write(folder.join("b.off"), off(&far)).expect("written");
    written(&folder, "far.ply");
    let back: Shape = scan(&folder.join("far.b.ply"));
    assert_eq!(back.points(), scan(&folder.join("b.off")).points());
    written(&folder, "far.glb");
    let back = std::fs::read(folder.join("far.b.glb")).expect("the second body");
    let (document, _) = chunks(&back);
    let high = document["accessors"][0]["max"][2].as_f64().expect("a number");
    assert!((high - 200.0).abs() < 1e-3, "kept around the node's origin: {high}");
}

#[test]
fn another_extension_is_wrong_use_and_says_which_there_are() {
    let folder = folder("exports-unknown", true);
    for output in ["map.obj", "map", "map.csv.gz", ".csv"] {
        let ran = run(&folder, output);
        assert_eq!(ran.status.code(), Some(2), "{output}");
        let said = String::from_utf8_lossy(&ran.stderr);
        assert!([".csv", ".json", ".ply", ".glb"].iter().all(|e| said.contains(e)), "{said}");
        assert!(!folder.join(output).exists(), "{output}");
    }
    let nowhere = run(&folder, "no/such/folder/map.csv");
    assert_eq!(nowhere.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&nowhere.stderr).contains("no/such/folder"));
}

#[test]
fn landmarks_are_kept_to_the_point_and_refused_when_they_are_none() {
    let folder = folder("exports-landmarks", true);
    let run = |landmarks: &str| {
        Command::new(env!("CARGO_BIN_EXE_geose-fmap"))
            .current_dir(&folder)
            .args(["match", "a.off", "b.off", "-o", "map.json", "--eigenpairs", "20", "--landmarks", landmarks])
            .output()
            .expect("the program starts")
    };
    assert!(run("17:20,400:391").status.success());
    let json: Value = serde_json::from_slice(&std::fs::read(folder.join("map.json")).expect("a file")).expect("JSON");
    assert_eq!(json["match"]["landmarks"], serde_json::json!([[17, 20], [400, 391]]));
    for (i, j) in [(17, 20), (400, 391)] {
        assert_eq!((&json["map"][i]["target"], &json["map"][i]["confidence"]), (&j.into(), &1.0.into()));
    }
    for (landmarks, code, said) in [("17", 2, "two indices"), ("17:9999", 1, "9999"), ("17:20,17:21", 1, "point 17")] {
        let ended = run(landmarks);
        let words = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(code), "{landmarks}: {words}");
        assert!(words.contains(said), "{landmarks}: {words}");
    }
}

/// The codes of the repairs that a scan came with.
fn codes(scan: &Value) -> BTreeSet<&str> {
    let repairs = scan["repairs"].as_array().expect("a list");
    assert!(repairs.iter().all(|repair| repair["message"].is_string() && repair["count"].is_u64()));
    repairs.iter().map(|repair| repair["code"].as_str().expect("a name")).collect()
}

#[test]
fn a_floor_is_set_aside_by_a_name_and_kept_with_whole_scan() {
    let folder = folder("exports-floor", true);
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/www/public/samples/woman-standing.ply");
    let woman = read(&std::fs::read(sample).expect("a sample"), None, None).expect("a scan");
    let body = woman.points().iter().step_by(3).copied();
    let plate = (0..625_u32).map(|i| [f64::from(i % 25) / 12.0 - 1.0, -0.005, f64::from(i / 25) / 12.0 - 1.0]);
    let lines = body.chain(plate).map(|[x, y, z]| format!("{x} {y} {z}\n"));
    std::fs::write(folder.join("scene.xyz"), lines.collect::<String>()).expect("written");
    let ran = |arguments: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_geose-fmap"));
        let ran =
            program.current_dir(&folder).args(arguments).args(["--points", "1500"]).output().expect("the program");
        assert!(ran.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&ran.stderr));
        ran
    };
    let info = |more: &[&str]| -> Value {
        serde_json::from_slice(&ran(&[&["info", "scene.xyz", "--json"], more].concat()).stdout).expect("JSON")
    };
    assert!(codes(&info(&[])).contains("floor-set-aside"));
    assert!(!codes(&info(&["--whole-scan"])).contains("floor-set-aside"));

    let matched = |more: &[&str]| -> (Value, String) {
        let pair = ["match", "scene.xyz", "a.off", "-o", "scene.json", "--eigenpairs", "20", "--refine", "none"];
        let said = String::from_utf8(ran(&[&pair, more].concat()).stderr).expect("text");
        (serde_json::from_slice(&std::fs::read(folder.join("scene.json")).expect("a file")).expect("JSON"), said)
    };
    let unmatched = |json: &Value| {
        let map = json["map"].as_array().expect("a list");
        map.iter().filter(|line| line["target"].is_null()).count()
    };
    let (json, said) = matched(&[]);
    assert!(codes(&json["a"]).contains("floor-set-aside"));
    assert_eq!(json["a"]["prepared"]["wholeScan"], false);
    assert!(unmatched(&json) > 500, "{}", unmatched(&json));
    assert!(said.contains("note on scan A: a floor or a wall was set aside"), "{said}");
    let (json, said) = matched(&["--whole-scan"]);
    assert!(!codes(&json["a"]).contains("floor-set-aside") && !said.contains("a floor or a wall"), "{said}");
    assert_eq!(json["a"]["prepared"]["wholeScan"], true);
    assert!(unmatched(&json) <= 4, "{}", unmatched(&json));
}
