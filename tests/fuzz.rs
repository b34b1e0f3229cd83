//! Every target of `fuzzing` over what it starts from and some thousand mutations of that, always the same. `npm run fuzz` goes on from there.
#![cfg(not(target_arch = "wasm32"))]

#[path = "readers/body_on_joints.rs"]
mod body_on_joints;
#[path = "readers/compressed_torus.rs"]
mod compressed_torus;
mod fuzzing;
#[path = "fuzzing/mutation.rs"]
mod mutation;
#[path = "readers/sample.rs"]
mod sample;
mod shapes;

use std::panic::catch_unwind;
use std::time::Instant;

use mutation::broken;
use shapes::Random;

/// Runs a target on each of its seeds and on `mutations` of them, each broken one to four times, and names the bytes that it does not survive.
fn survives(name: &str, mutations: usize) {
    let start = Instant::now();
    let target = fuzzing::target(name);
    let seeds = (target.seeds)();
    let run = |bytes: &[u8]| {
        let show = || bytes.escape_ascii().to_string();
        assert!(catch_unwind(|| (target.run)(bytes)).is_ok(), "{name} does not survive b\"{}\"", show());
    };
    seeds.iter().for_each(|seed| run(seed));
    let mut random = Random(7);
    for _ in 0..mutations {
        let mut bytes = seeds[random.below(seeds.len())].clone();
        for _ in 0..=random.below(4) {
            if !bytes.is_empty() {
                bytes = broken(&bytes, &mut random).1;
            }
        }
        run(&bytes);
    }
    println!("{name}: {} seeds and {mutations} mutations in {:.1?}", seeds.len(), start.elapsed());
}

#[test]
fn every_reader_survives_what_nobody_wrote() {
    let readers = &fuzzing::TARGETS[..10];
    assert!(readers.iter().all(|target| !(target.seeds)().is_empty()));
    readers.iter().for_each(|target| survives(target.name, 20_000));
}

#[test]
fn arbitrary_points_and_faces_are_prepared_and_matched_or_refused() {
    survives("prepare", 250);
}

#[test]
fn stored_shapes_survive_any_change_of_their_bytes() {
    survives("stored_bytes", 2000);
    survives("stored_edits", 300);
}

/// Inputs that long runs have found, as small as they come.
#[test]
fn a_mesh_of_slivers_is_searched_for_planes_in_the_time_of_others() {
    let found: [&[u8]; 2] = [
        &[
            30, 237, 109, 38, 166, 158, 101, 229, 142, 229, 22, 109, 150, 10, 241, 101, 126, 229, 6, 113, 30, 134, 101,
            166, 237, 38, 109, 158, 229, 142, 229, 22, 109, 150, 10, 241, 101, 126, 150,
        ],
        &[
            218, 45, 122, 205, 50, 66, 173, 226, 77, 250, 77, 90, 205, 194, 45, 26, 173, 186, 77, 114, 13, 18, 0, 0, 9,
            255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 178, 0, 0, 0, 0, 0, 0, 178, 234,
            141, 138, 45, 130, 45,
        ],
    ];
    let start = Instant::now();
    found.iter().for_each(|bytes| fuzzing::scans::survives(bytes));
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

#[test]
fn a_stored_shape_with_fewer_descriptors_than_others_is_refused() {
    let mut block = fuzzing::stored::Block::of(&fuzzing::scans::TORI[0].to_bytes().expect("a torus is stored"));
    let features = block.tensors.get_mut("features").expect("descriptors");
    features.shape[1] -= 1;
    features.bytes.truncate(features.bytes.len() - 4 * features.shape[0]);
    let refusal = geose_fmap::PreparedShape::from_bytes(&block.bytes()).expect_err("refused");
    assert!(refusal.to_string().contains("do not fit together"), "{refusal}");
}

#[test]
fn a_stored_shape_with_a_place_that_is_no_number_is_refused() {
    let mut block = fuzzing::stored::Block::of(&fuzzing::scans::TORI[0].to_bytes().expect("a torus is stored"));
    block.tensors.get_mut("positions").expect("positions").bytes[..8].copy_from_slice(&f64::NAN.to_le_bytes());
    assert!(geose_fmap::PreparedShape::from_bytes(&block.bytes()).is_err());
}

#[test]
fn a_stored_shape_with_a_reliability_that_is_no_share_is_refused() {
    for reliability in [1.5, -0.1] {
        let mut shape = fuzzing::scans::TORI[0].clone();
        shape.info.reliability = reliability;
        assert!(geose_fmap::PreparedShape::from_bytes(&shape.to_bytes().expect("a torus is stored")).is_err());
    }
}

#[test]
fn a_stored_shape_of_which_no_samples_are_adjacent_is_matched() {
    let mut block = fuzzing::stored::Block::of(&fuzzing::scans::TORI[0].to_bytes().expect("a torus is stored"));
    let adjacent = block.tensors.get_mut("adjacent").expect("pairs of samples");
    (adjacent.shape[0], adjacent.bytes) = (0, Vec::new());
    fuzzing::stored::survives(&block.bytes());
}

#[test]
fn a_sentence_about_a_stored_shape_does_not_repeat_a_text_of_any_length() {
    let block = format!("{{\"__metadata__\": \"{}\"}}", "t".repeat(100_000));
    let bytes = [&(block.len() as u64).to_le_bytes()[..], block.as_bytes()].concat();
    let refusal = geose_fmap::PreparedShape::from_bytes(&bytes).expect_err("refused").to_string();
    assert!(refusal.len() < 1000, "{} bytes", refusal.len());
}
