//! What is said of a map that may be wrong, and not of one that is right.

use super::*;

/// Whether a warning of the match has these words.
fn warns(found: &Match, words: &str) -> bool {
    found.warnings.iter().any(|warning| warning.message.contains(words))
}

#[test]
fn a_map_that_changes_lengths_is_doubted_and_whole_bodies_and_pieces_are_not() {
    let [woman, man] = [body(BODIES[0]), body(BODIES[3])];
    let mut upper = soup(&woman);
    let waist = 1.0;
    upper.faces.retain(|face| face.iter().all(|&i| upper.points[i as usize][1] > waist));
    let kept: Vec<u32> = (0..5000).filter(|&i| upper.points[i as usize][1] > waist).collect();
    let mut row = vec![u32::MAX; 5000];
    kept.iter().zip(0..).for_each(|(&i, r)| row[i as usize] = r);
    let faces = upper.faces.iter().map(|face| face.map(|i| row[i as usize])).collect();
    let upper = Soup { points: kept.iter().map(|&i| upper.points[i as usize]).collect(), faces };
    let options = PrepareOptions::default();
    let [woman, man, upper] = [woman, man, upper.shape()].map(|shape| prepared(shape, &options));
    let doubted = |a: &PreparedShape, b: &PreparedShape| warns(&matched(a, b), "changes lengths");
    assert!(!doubted(&woman, &man) && !doubted(&man, &woman));
    assert!(!doubted(&upper, &man) && !doubted(&man, &upper));
    assert!(doubted(&prepared(blob(3).shape(), &options), &man));
}

#[test]
fn labels_that_name_other_parts_on_one_body_than_on_the_other_are_doubted() {
    let [a, b] = [body(BODIES[0]), body(BODIES[3])];
    let relabelled = |change: &dyn Fn(u32) -> u32| {
        let labels = b.labels().expect("sample bodies have labels").iter().map(|&label| change(label)).collect();
        let shape = Shape::new(b.points().to_vec(), b.faces().to_vec(), Some(labels)).expect("a valid shape");
        prepared(shape, &quick())
    };
    let a = prepared(a, &quick());
    let options = MatchOptions { parts: Parts::Given, refine: Refinement::None, ..Default::default() };
    let with = |change: &dyn Fn(u32) -> u32| matched_with(&a, &relabelled(change), &options);
    let doubted = |found: &Match| warns(found, "labelled alike");
    assert!(!doubted(&with(&|label| label).expect("a match")));
    let count = parts().len() as u32;
    assert!(doubted(&with(&|label| (label + 1) % count).expect("a match")));
    // Left and right exchanged.
    let side =
        |label: u32| parts().iter().position(|name| *name == mirrored(parts()[label as usize])).expect("a part") as u32;
    assert!(doubted(&with(&side).expect("a match")));
    let refused = with(&|label| label + 100).expect_err("no label in common");
    assert_eq!(refused.code(), "no-shared-labels");
}

/// Names of the parts that the network that ships knows.
fn parts() -> Vec<&'static str> {
    Model::embedded().networks()[0].category().part_names()
}

fn mirrored(part: &str) -> String {
    match part.split_once(' ') {
        Some(("left", rest)) => format!("right {rest}"),
        Some(("right", rest)) => format!("left {rest}"),
        _ => part.to_owned(),
    }
}

#[test]
fn landmarks_that_the_map_contradicts_are_named() {
    let half = PrepareOptions { points: 2500, ..Default::default() };
    let [a, b] = [BODIES[0], BODIES[3]].map(|file| prepared(body(file), &half));
    let map = matched(&a, &b).a_to_b;
    let surest = |part: &str| {
        let label = parts().iter().position(|name| *name == part).expect("a part") as u32;
        let labels = a.shape.labels().expect("sample bodies have labels");
        let points = (0..labels.len()).filter(|&i| labels[i] == label);
        let best = points.max_by(|&i, &j| map.confidence[i].total_cmp(&map.confidence[j])).expect("points");
        [best as u32, map.target[best]]
    };
    let [head, left, right, foot] = ["head", "left hand", "right hand", "left foot"].map(surest);
    let named = |landmarks: Vec<[u32; 2]>| -> Vec<String> {
        let found = matched_with(&a, &b, &MatchOptions { landmarks, ..Default::default() }).expect("a match");
        found.warnings.into_iter().filter(|w| w.code == "landmark-contradicted").map(|w| w.message).collect()
    };
    assert_eq!(named(vec![head, left, right, foot]), Vec::<String>::new());
    let told = named(vec![left, [head[0], foot[1]]]);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains(&format!("point {} of A with point {} of B", head[0], foot[1])), "{told:?}");
    assert_eq!(named(vec![[left[0], right[1]], [right[0], left[1]]]).len(), 2, "hands exchanged");
}
