//! Nothing a file can hold makes a reader panic, hang, or take memory that the file does not account for: valid files of every format,
//! broken 2000 times each, always in the same ways.
#![cfg(not(target_arch = "wasm32"))]

#[path = "readers/body_on_joints.rs"]
mod body_on_joints;
#[path = "fuzzing/memory.rs"]
mod memory;
#[path = "fuzzing/mutation.rs"]
mod mutation;
#[path = "readers/sample.rs"]
mod sample;
mod shapes;
#[path = "readers/unfolding.rs"]
mod unfolding;

use std::panic::catch_unwind;
use std::time::{Duration, Instant};

use geose_fmap::read;
use memory::peak_of;
use mutation::broken;
use sample::all_files;
use shapes::Random;

/// What reading a file of so many bytes may hold at one time: what is in it several times may be read that often, as long as it stays small.
fn allowed(bytes: usize) -> usize {
    (1 << 20) + (64 * bytes).max(32 << 20)
}

/// What was seen of all files of a format.
#[derive(Default)]
struct Seen {
    read: usize,
    refused: usize,
    most: usize,
    longest: Duration,
}

/// Reads, and insists on a shape or an error with a code and a sentence, soon and without much memory.
fn survives(name: &str, what: &str, bytes: &[u8], seen: &mut Seen) {
    let start = Instant::now();
    let (result, peak) = peak_of(|| catch_unwind(|| read(bytes, Some(name), None)));
    let took = start.elapsed();
    let case = || {
        format!("{name}, {what}, {} bytes: {:?}", bytes.len(), String::from_utf8_lossy(&bytes[..bytes.len().min(400)]))
    };
    assert!(took < Duration::from_secs(1), "{took:?} for {}", case());
    assert!(peak <= allowed(bytes.len()), "{peak} bytes held for {}", case());
    match result.unwrap_or_else(|_| panic!("panic at {}", case())) {
        Ok(shape) => {
            let points = shape.points().len();
            assert!(shape.points().iter().flatten().all(|c| c.is_finite()), "{}", case());
            assert!(shape.faces().iter().flatten().all(|&i| (i as usize) < points), "{}", case());
            assert!(shape.repairs().iter().all(|r| r.count > 0 && r.message.contains(' ')), "{}", case());
            seen.read += 1;
        }
        Err(error) => {
            let sentence = error.to_string();
            assert!(
                sentence.contains(' ') && sentence.len() > 10 && sentence.len() < 1000,
                "{sentence:?} for {}",
                case()
            );
            assert!(!error.code().is_empty() && error.details().is_object(), "{}", case());
            seen.refused += 1;
        }
    }
    seen.most = seen.most.max(peak);
    seen.longest = seen.longest.max(took);
}

/// Valid files with what is read by code of its own: joints and morph targets, headings, UTF-16, a count that says nothing, one line.
fn unusual_files() -> Vec<(&'static str, Vec<u8>)> {
    let torus = sample::torus();
    let mut body = body_on_joints::Body::new();
    body.bind([0.0, 1.0]);
    body.target();
    body.document["meshes"][0]["weights"] = serde_json::json!([0.5]);
    let mut streamed = sample::stl_binary(&torus);
    streamed[80..84].fill(0);
    let rows = torus.points.iter().enumerate();
    let table: String = rows.map(|(i, [x, y, z])| format!("{i};\"{x}\";{y};{z}\n").replace('.', ",")).collect();
    let ply = sample::ply_text(&torus).replacen("double z", "double z\nproperty double scalar_label", 1);
    // The header has eleven lines now.
    let labelled = |(i, line): (usize, &str)| {
        if (11..75).contains(&i) { format!("{line} {}.0\n", i / 9) } else { format!("{line}\n") }
    };
    let labels: String = ply.lines().enumerate().map(labelled).collect();
    vec![
        ("posed.glb", sample::glb(&body.document, &body.data)),
        ("streamed.stl", streamed),
        ("line.stl", sample::stl_text(&torus).replace('\n', " ").into_bytes()),
        ("headings.csv", format!("id;X [mm];Y [mm];Z [mm]\n{table}").into_bytes()),
        ("numbered.csv", table.into_bytes()),
        ("wide.xyz", sample::xyz(&torus).encode_utf16().flat_map(u16::to_le_bytes).collect()),
        ("labels.ply", labels.into_bytes()),
    ]
}

#[test]
fn files_broken_in_two_thousand_ways_each_are_survived() {
    let files = all_files().into_iter().map(|(name, bytes, _)| (name, bytes));
    for (name, bytes) in files.chain(unusual_files()) {
        let mut random = Random(1);
        let mut seen = Seen::default();
        for _ in 0..2000 {
            let (what, broken) = broken(&bytes, &mut random);
            survives(name, what, &broken, &mut seen);
        }
        let Seen { read, refused, most, longest } = seen;
        println!(
            "{name} ({} bytes): {read} read, {refused} refused, at most {most} bytes held, {longest:?}",
            bytes.len()
        );
        assert!(read > 0 && refused > 500, "{name}: {read} read and {refused} refused, so little was tried");
    }
}

#[test]
fn large_good_files_take_memory_in_proportion() {
    let whole = shapes::torus(2.0, 0.7, 400, 200);
    let large = sample::Sample {
        points: whole.points.iter().map(|p| p.map(|c| f64::from(c as f32))).collect(),
        faces: whole.faces,
    };
    let files = [
        ("a.off", sample::off(&large).into_bytes()),
        ("a.obj", sample::obj(&large).into_bytes()),
        ("a.ply", sample::ply_binary(&large, false)),
        ("a.glb", sample::glb(&sample::gltf_document(&large), &sample::gltf_data(&large))),
        ("text.stl", sample::stl_text(&large).into_bytes()),
        ("binary.stl", sample::stl_binary(&large)),
        ("a.csv", sample::csv(&large).into_bytes()),
    ];
    for (name, bytes) in files {
        let (shape, peak) = peak_of(|| read(&bytes, Some(name), None));
        assert!(shape.is_ok_and(|s| s.points().len() >= 80_000), "{name}");
        println!("{name}: {:.1} times its {} bytes held", peak as f64 / bytes.len() as f64, bytes.len());
        assert!(peak <= 16 * bytes.len(), "{name}: {peak} held for {}", bytes.len());
    }
}

#[test]
fn files_that_unfold_are_refused_before_they_do() {
    let torus = sample::torus();
    let large = shapes::torus(2.0, 0.7, 400, 200);
    let large = sample::Sample { points: large.points, faces: large.faces };
    let lists = |before, item| unfolding::json_of(before, item, "", 2_000_000);
    let files = [
        ("zeros", unfolding::zeros(1_000_000, 64)),
        ("zeros in little", unfolding::zeros(40_000, 1000)),
        ("instances", unfolding::instances(&torus, 20_000)),
        ("instances of much", unfolding::instances(&large, 1000)),
        ("instances of nothing", {
            let mut document = sample::gltf_document(&torus);
            document["accessors"]
                .as_array_mut()
                .unwrap()
                .push(serde_json::json!({ "bufferView": 0, "componentType": 5126, "count": 0, "type": "VEC3" }));
            let empty = serde_json::json!({ "attributes": { "POSITION": 2 } });
            document["meshes"][0]["primitives"] = vec![empty; 2000].into();
            document["nodes"] = vec![serde_json::json!({ "mesh": 0 }); 2000].into();
            document["scenes"][0]["nodes"] = (0..2000).collect();
            sample::glb(&document, &sample::gltf_data(&torus))
        }),
        ("one list of corners", unfolding::drawn_again(500, &large)),
        ("an accessor of few points", unfolding::sparse(5_000_000)),
        ("empty objects", lists("\"nodes\":", "{}")),
        ("objects", lists("\"extras\":", "{\"a\":{}}")),
        ("scenes", lists("\"nodes\":[{}],\"scenes\":", "{\"nodes\":[0]}")),
    ];
    for (what, bytes) in files {
        let start = Instant::now();
        let (result, peak) = peak_of(|| read(&bytes, None, None));
        let error = result.expect_err(what);
        println!("{what}: {} bytes, {peak} held, {:?}", bytes.len(), start.elapsed());
        assert_eq!(error.code(), "too-large", "{what}: {error}");
        let limit = (64 * bytes.len()).max(32 << 20);
        assert_eq!(error.details()["limit"], limit, "{what}");
        assert!(error.to_string().contains(&format!("{limit} bytes in memory")), "{what}: {error}");
        assert!(peak <= (8 << 20) + 32 * bytes.len(), "{what}: {peak} held for {}", bytes.len());
    }
}

#[test]
fn files_that_unfold_as_real_ones_do_are_read_within_their_bounds() {
    let torus = sample::torus();
    let many = "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":";
    let files = [
        ("a cloud, compressed 13 times", unfolding::walk(2_000_000, false), 1_900_000),
        ("a fan, compressed 12 times", unfolding::walk(1_000_000, true), 900_000),
        ("a mesh a thousand times", unfolding::instances(&torus, 1000), 64_000),
        ("faces of several primitives", unfolding::drawn_again(100, &torus), 64),
        ("an accessor of few points", unfolding::sparse(500_000), 500_000),
        ("points that hang on joints eight times", unfolding::hung(400_000), 400_000),
        ("nothing but roots", unfolding::json_of("\"scenes\":[{\"nodes\":", "0", "}],\"nodes\":[{}]", 2_000_000), 0),
        ("nothing but children", unfolding::json_of("\"nodes\":[{\"children\":", "0", "}]", 2_000_000), 0),
        ("nothing but joints", unfolding::json_of("\"nodes\":[{}],\"skins\":[{\"joints\":", "0", "}]", 2_000_000), 0),
        (
            "nothing but primitives",
            unfolding::json_of(
                many,
                "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}",
                "",
                2_000_000,
            ),
            0,
        ),
    ];
    for (what, bytes, points) in files {
        let start = Instant::now();
        let (result, peak) = peak_of(|| read(&bytes, None, None));
        let times = peak as f64 / bytes.len() as f64;
        println!("{what}: {} bytes, {times:.1} times as many held, {:?}", bytes.len(), start.elapsed());
        assert!(peak <= allowed(bytes.len()), "{what}: {peak} held for {}", bytes.len());
        match result {
            Ok(shape) => assert!(shape.points().len() >= points, "{what}: {}", shape.points().len()),
            Err(error) => assert!(points == 0 && error.code() != "too-large", "{what}: {error}"),
        }
    }
}

#[test]
fn every_byte_of_a_header_may_be_any_byte() {
    let files = all_files().into_iter().map(|(name, bytes, _)| (name, bytes));
    for (name, bytes) in files.chain(unusual_files()) {
        let mut seen = Seen::default();
        for at in 0..bytes.len().min(150) {
            for value in [0, b'0', b'9', b'\n', b'-', 127, 255] {
                let mut broken = bytes.clone();
                broken[at] = value;
                survives(name, "one byte changed", &broken, &mut seen);
            }
        }
        assert!(seen.refused > 0, "{name}");
    }
}
