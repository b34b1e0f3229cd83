//! Files cut anywhere, noise, and single enormous things make no reader panic or hang. What is broken at random, and memory, is in
//! `readers_survive.rs`.

use std::time::{Duration, Instant};

use geose_fmap::read;

use crate::sample::all_files;

/// A small generator with a period long enough for a test (SplitMix64, Steele et al. 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % bound as u64) as usize
    }
}

/// Reads and insists on a shape or an error with a code and a sentence.
fn survives(bytes: &[u8], name: &str) -> bool {
    let start = Instant::now();
    let result = read(bytes, Some(name), None);
    assert!(start.elapsed() < Duration::from_secs(10), "{name}: {} bytes took {:?}", bytes.len(), start.elapsed());
    match result {
        Ok(shape) => {
            let points = shape.points().len();
            assert!(shape.faces().iter().flatten().all(|&i| (i as usize) < points));
            true
        }
        Err(error) => {
            assert!(!error.code().is_empty() && error.details().is_object() && error.to_string().len() > 10);
            false
        }
    }
}

#[test]
fn a_file_cut_anywhere_is_a_shape_or_an_error() {
    for (name, bytes, _) in all_files() {
        let read = (0..bytes.len()).filter(|&end| survives(&bytes[..end], name)).count();
        assert!(read < bytes.len(), "{name}: some cut must be refused");
        if ["little.ply", "big.ply", "a.glb", "binary.stl"].contains(&name) {
            assert_eq!(read, 0, "{name}: every cut of a binary file is noticed");
        }
    }
}

#[test]
fn noise_behind_every_magic_word_is_survived() {
    let mut random = Random(3);
    for magic in ["", "OFF\n", "ply\n", "v 0 0 0\n", "glTF\x02\0\0\0", "{", "solid\n", "3\n1 2 3\n", "x;y;z\n"] {
        for length in 0..300 {
            let noise: Vec<u8> = (0..length).map(|_| random.below(256) as u8).collect();
            for name in ["a.off", "a.ply", "a.obj", "a.glb", "a.gltf", "a.stl", "a.xyz", "a.pts", "a.csv"] {
                survives(&[magic.as_bytes(), &noise].concat(), name);
            }
        }
    }
}

#[test]
fn one_enormous_polygon_and_one_enormous_line_are_survived() {
    let corners = (0..400_000).map(|i| (i % 64).to_string()).collect::<Vec<_>>().join(" ");
    let points: String = (0..64).map(|i| format!("{} {} {}\n", i % 8, i / 8, i % 5)).collect();
    assert!(survives(format!("OFF\n64 1 0\n{points}400000 {corners}\n").as_bytes(), "a.off"));
    survives(" ".repeat(2_000_000).as_bytes(), "a.obj");
    survives("v 1 2 3 \\\n".repeat(200_000).as_bytes(), "a.obj");
    survives(format!("v {} 0 0", "1".repeat(1_000_000)).as_bytes(), "a.obj");
}

#[test]
fn megabytes_of_blank_lines_at_the_end_are_read_once() {
    let blank = "\n".repeat(20_000_000);
    let rows: String = (0..100_000).map(|i| format!("{} {} {}\n", i % 317, i / 317, i % 7)).collect();
    let facet = |i: usize| {
        let x = i as f64;
        format!("facet normal 0 0 1\nouter loop\nvertex {x} 0 0\nvertex {x} 1 0\nvertex {x} 0 1\nendloop\nendfacet\n")
    };
    let facets: String = (0..30_000).map(facet).collect();
    for (name, text) in [("a.xyz", rows), ("a.stl", format!("solid\n{facets}endsolid\n"))] {
        assert!(survives((text + &blank).as_bytes(), name), "{name}");
    }
}

#[test]
fn a_sentence_about_json_does_not_repeat_a_string_of_any_length() {
    for document in [
        format!("\"{}\"", "ä".repeat(100_000)),
        format!("{{\"asset\": {{\"version\": \"2.0\"}}, \"nodes\": [\"{}\"]}}", "n".repeat(100_000)),
    ] {
        for (name, bytes) in [
            ("a.gltf", document.clone().into_bytes()),
            ("a.glb", crate::sample::glb(&serde_json::from_str(&document).unwrap(), &[])),
        ] {
            let sentence =
                read(&bytes, Some(name), Some(name[2..].parse().unwrap())).expect_err("no document").to_string();
            assert!(sentence.len() < 1000, "{name}: {} bytes", sentence.len());
        }
    }
}
