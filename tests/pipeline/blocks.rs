//! A prepared shape survives its bytes, and other bytes are refused.

use super::*;

#[test]
fn a_prepared_shape_comes_back_from_its_bytes() {
    let cloud = prepared(fibonacci_sphere(300).shape(), &PrepareOptions { points: 100, ..quick() });
    for shape in [&*SMALL, &*BODY, &cloud] {
        let back = PreparedShape::from_bytes(&shape.to_bytes().expect("bytes")).expect("a prepared shape");
        assert_eq!((&back.info, &back.repairs), (&shape.info, &shape.repairs));
        assert!(back.basis == shape.basis && back.features == shape.features);
        assert!((&back.support, &back.coarse) == (&shape.support, &shape.coarse));
        assert!(back.shape.points() == shape.shape.points() && back.shape.faces() == shape.shape.faces());
        assert!(back.shape.labels() == shape.shape.labels());
    }
    let back = PreparedShape::from_bytes(&SMALL.to_bytes().expect("bytes")).expect("a prepared shape");
    let options = MatchOptions::default();
    let [one, other] = [&*SMALL, &back].map(|shape| matched_with(shape, &BODY, &options).expect("a match"));
    assert_eq!(one.a_to_b, other.a_to_b, "and matches as before");
}

#[test]
fn parts_in_a_block_are_as_given_or_else_the_likeliest_for_the_network() {
    let parts_of = |shape: &PreparedShape| -> serde_json::Value {
        let bytes = shape.to_bytes().expect("bytes");
        let (_, header) = SafeTensors::read_metadata(&bytes).expect("a header");
        let likeliest =
            SafeTensors::deserialize(&bytes).expect("tensors").tensor("partLabels").expect("parts").data().to_vec();
        let probabilities = &shape.embeddings[0].parts;
        assert_eq!(
            (likeliest.len(), probabilities.ncols()),
            (shape.points_used(), shape.embeddings[0].category.parts.len())
        );
        for (&part, row) in likeliest.iter().zip(probabilities.rows()) {
            assert!(row.iter().all(|&p| p <= row[part as usize]) && (row.sum() - 1.0).abs() < 1e-5, "{part} of {row}");
        }
        serde_json::from_str(&header.metadata().as_ref().expect("metadata")["parts"]).expect("JSON")
    };
    let given = serde_json::json!({ "names": ["part 0", "part 1", "part 2"], "source": "given" });
    assert_eq!(parts_of(&SMALL), given);
    let mut numbered = SMALL.clone();
    for labels in [None, Some((0..163).map(|i| 1000 * i).collect())] {
        numbered.shape =
            Shape::new(SMALL.shape.points().to_vec(), SMALL.shape.faces().to_vec(), labels).expect("valid");
        let category = numbered.category().expect("a category");
        let of: Vec<usize> = category.parts.iter().map(|part| part.group).collect();
        let groups = serde_json::json!({ "names": category.groups, "of": of });
        let predicted = serde_json::json!({ "names": category.part_names(), "source": "predicted", "groups": groups });
        assert_eq!(parts_of(&numbered), predicted);
    }
}

/// A block that is no longer what was written is refused, or at least can be matched without a panic, as A in even rounds and as B in odd ones.
fn survive(bytes: &[u8], round: usize) -> Result<(), BlockError> {
    let shape = PreparedShape::from_bytes(bytes)?;
    let [a, b] = if round.is_multiple_of(2) { [&shape, &*SMALL] } else { [&*SMALL, &shape] };
    if let Ok(found) = matched_with(a, b, &MatchOptions { landmarks: vec![[0, 0]], ..Default::default() }) {
        assert_eq!(found.a_to_b.target.len(), a.shape.points().len());
    }
    Ok(())
}

#[test]
fn a_block_cut_anywhere_is_refused() {
    let bytes = BODY.to_bytes().expect("bytes");
    for end in (0..bytes.len()).step_by(1000).chain(bytes.len() - 20..bytes.len()) {
        let error = PreparedShape::from_bytes(&bytes[..end]).expect_err("cut short");
        assert_eq!(error.code(), "invalid-block", "cut at {end}");
    }
    let small = SMALL.to_bytes().expect("bytes");
    for end in 0..small.len().min(4000) {
        assert!(PreparedShape::from_bytes(&small[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn a_block_with_flipped_bytes_never_panics() {
    let bytes = SMALL.to_bytes().expect("bytes");
    let header = 8 + u64::from_le_bytes(bytes[..8].try_into().expect("eight")) as usize;
    let mut random = Random(12);
    let mut refused = 0;
    for round in 0..500 {
        let mut broken = bytes.clone();
        // A third in the header, where every byte has a meaning.
        let at = random.below(if round % 3 == 0 { header } else { bytes.len() });
        broken[at] ^= 1 << random.below(8);
        if round % 4 < 2 {
            broken[at] = random.bits() as u8;
        }
        refused += usize::from(survive(&broken, round).is_err());
    }
    println!("{refused} of 500 broken blocks refused");
    assert!(refused > 100, "{refused}");
}

#[test]
fn bytes_that_were_never_a_block_are_refused() {
    let mut other_version = SMALL.to_bytes().expect("bytes");
    let at = other_version.windows(15).position(|w| w == b"geose-prepared ").expect("the format");
    other_version[at + 15] = b'1';
    let huge = [&u64::MAX.to_le_bytes()[..], &[b'{'; 100]].concat();
    let empty = [&2u64.to_le_bytes()[..], b"{}"].concat();
    for bytes in [&[][..], b"ply\nformat ascii 1.0\n", &[0; 64], &huge, &empty, &other_version] {
        let error = PreparedShape::from_bytes(bytes).expect_err("refused");
        assert_eq!(error.code(), "invalid-block");
        assert!(error.to_string().len() > 40, "a sentence: {error}");
    }
}
