//! Skeletons and morph targets of glTF: points as the file stands, and at rest.

use geose_fmap::{Error, Pose, ReadOptions, Shape, read_with};
use serde_json::{Value, json};

use crate::body_on_joints::Body;
use crate::sample::{assert_is_torus, glb, refused, repaired, torus};

/// What is read of a body on joints.
impl Body {
    fn read(&self, pose: Pose) -> Result<Shape, Error> {
        let bytes = glb(&self.document, &self.data);
        Ok(read_with(&bytes, &ReadOptions { pose, ..ReadOptions::default() })?)
    }

    /// How far points 0 and 63 are moved up.
    fn rise(&self) -> [f64; 2] {
        let shape = self.read(Pose::Saved).expect("a good body");
        assert_eq!(shape.repairs(), [], "what is applied is nothing to say");
        [0, 63].map(|i: usize| {
            assert_eq!(shape.points()[i][..2], torus().points[i][..2]);
            shape.points()[i][2] - torus().points[i][2]
        })
    }
}

#[test]
fn the_node_of_a_skinned_mesh_and_its_parents_do_not_move_it() {
    for own in [
        json!({ "mesh": 0, "skin": 0, "translation": [1, 2, 3] }),
        json!({ "mesh": 0, "skin": 0, "scale": [100, 100, 100], "rotation": [-0.6, 0, 0, 0.8] }),
        json!({ "mesh": 0, "skin": 0, "scale": [-1, 1, 1] }),
    ] {
        let mut body = Body::new();
        body.document["nodes"] =
            json!([{}, {}, own, { "children": [2], "translation": [0, 7, 0], "scale": [1, 1, -3] }]);
        body.document["scenes"][0]["nodes"] = json!([0, 1, 3]);
        for pose in [Pose::Saved, Pose::Rest] {
            let shape = body.read(pose).unwrap();
            assert_eq!((shape.points(), shape.faces()), (&torus().points[..], &torus().faces[..]));
        }
    }
}

#[test]
fn joints_move_what_hangs_on_them_from_where_it_was_bound() {
    let mut body = Body::new();
    body.document["nodes"][1]["translation"] = json!([0, 0, 5]);
    assert_eq!(body.rise(), [0.0, 5.0]);
    body.bind([0.0, 5.0]);
    assert_eq!(body.rise(), [0.0, 0.0]);
    body.document["nodes"][0]["translation"] = json!([0, 0, 2]);
    body.document["nodes"][0]["children"] = json!([1]);
    body.document["scenes"][0]["nodes"] = json!([0, 2]);
    assert_eq!(body.rise(), [2.0, 2.0]);
    // A skeleton that no scene shows moves the body all the same.
    body.document["scenes"][0]["nodes"] = json!([2]);
    assert_eq!(body.rise(), [2.0, 2.0]);
}

#[test]
fn a_joint_turns_what_hangs_on_it() {
    let half = 0.5_f64.sqrt();
    let mut body = Body::new();
    body.document["nodes"][1]["rotation"] = json!([0, 0, half, half]);
    let shape = body.read(Pose::Saved).unwrap();
    for (i, (p, [x, y, z])) in shape.points().iter().zip(torus().points).enumerate() {
        let expected = if i < 32 { [x, y, z] } else { [-y, x, z] };
        assert!((0..3).all(|k| (p[k] - expected[k]).abs() < 1e-6), "{i}: {p:?} is not {expected:?}");
    }
    assert_eq!(shape.faces(), torus().faces);
}

#[test]
fn weights_of_every_type_blend_joints_and_sum_to_one() {
    let sixteen = |w: [u16; 4]| w.into_iter().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let floats = |w: [f32; 4]| w.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    for (component, weights, rise) in [
        (5126, floats([0.25, 0.75, 0.0, 0.0]), 7.5),
        (5126, floats([1.0, 3.0, 0.0, 0.0]), 7.5),
        (5121, vec![51, 204, 0, 0], 8.0),
        (5123, sixteen([13107, 52428, 0, 0]), 8.0),
        (5126, floats([0.0, 0.0, 0.0, 0.0]), 0.0),
    ] {
        let mut body = Body::new();
        let joints = body.accessor(5123, "VEC4", 64, &sixteen([0, 1, 0, 0]).repeat(64));
        let weights = body.accessor(component, "VEC4", 64, &weights.repeat(64));
        body.document["accessors"][weights]["normalized"] = json!(component != 5126);
        body.document["meshes"][0]["primitives"][0]["attributes"] =
            json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
        body.document["nodes"][1]["translation"] = json!([0, 0, 10]);
        let [first, last] = body.rise();
        assert!((first - rise).abs() < 1e-9 && (last - rise).abs() < 1e-9, "{component}: {first} {last}, not {rise}");
    }
}

#[test]
fn a_second_set_of_joints_counts() {
    let mut body = Body::new();
    let joints = body.accessor(5121, "VEC4", 64, &[1, 1, 1, 1].repeat(64));
    let halves: Vec<u8> = [0.5_f32, 0.25, 0.25, 0.0].into_iter().flat_map(f32::to_le_bytes).collect();
    let weights = body.accessor(5126, "VEC4", 64, &halves.repeat(64));
    let attributes = &mut body.document["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = json!(joints);
    attributes["WEIGHTS_1"] = json!(weights);
    body.document["nodes"][1]["translation"] = json!([0, 0, 10]);
    assert_eq!(body.rise(), [5.0, 10.0]);
}

#[test]
fn joints_that_mirror_turn_the_triangles() {
    let mut body = Body::new();
    body.document["nodes"][0]["scale"] = json!([-1, 1, 1]);
    body.document["nodes"][1]["scale"] = json!([-1, 1, 1]);
    let shape = body.read(Pose::Saved).unwrap();
    assert_eq!((shape.points()[3][0], shape.faces()[0]), (-torus().points[3][0], [0, 9, 8]));
}

#[test]
fn morph_targets_move_points_by_the_weights_of_the_node_or_else_of_the_mesh() {
    let mut body = Body::new();
    body.target();
    body.target();
    assert_eq!(body.rise(), [0.0, 0.0]);
    body.document["meshes"][0]["weights"] = json!([0.5, 0.25]);
    assert_eq!(body.rise(), [0.75, 0.75]);
    body.document["nodes"][2]["weights"] = json!([0, 2]);
    assert_eq!(body.rise(), [2.0, 2.0]);
    // Targets first, joints then.
    body.document["nodes"][1]["scale"] = json!([1, 1, 3]);
    let shape = body.read(Pose::Saved).unwrap();
    assert_eq!(shape.points()[63][2], 3.0 * (torus().points[63][2] + 2.0));
    // Without a skin the node counts.
    body.document["nodes"][2] = json!({ "mesh": 0, "weights": [1, 1], "scale": [1, 1, 2] });
    let shape = body.read(Pose::Saved).unwrap();
    assert_eq!(shape.points()[63][2], 2.0 * (torus().points[63][2] + 2.0));
}

#[test]
fn at_rest_nothing_is_applied_and_that_is_said() {
    let mut body = Body::new();
    body.target();
    body.document["meshes"][0]["weights"] = json!([3]);
    body.document["nodes"][1]["translation"] = json!([0, 0, 5]);
    let shape = body.read(Pose::Rest).unwrap();
    assert_eq!(shape.points(), torus().points);
    assert_eq!((repaired(&shape, "skins-ignored"), repaired(&shape, "morph-targets-ignored")), (1, 1));
}

#[test]
fn several_meshes_on_one_skeleton_stand_where_it_has_them() {
    let mut body = Body::new();
    body.document["meshes"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }));
    body.document["nodes"] = json!([
        {},
        { "translation": [0, 0, 5] },
        { "mesh": 0, "skin": 0, "translation": [9, 9, 9] },
        { "mesh": 1, "translation": [10, 0, 0] },
    ]);
    body.document["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let shape = body.read(Pose::Saved).unwrap();
    assert_eq!((shape.points()[0], shape.points()[63][2]), (torus().points[0], torus().points[63][2] + 5.0));
    assert_eq!(shape.points()[64][0], torus().points[0][0] + 10.0, "a mesh without a skin is placed by its node");
}

#[test]
fn skeletons_that_make_no_sense_are_refused_and_do_not_matter_at_rest() {
    type Change = fn(&mut Body);
    let cases: [(&str, Change); 6] = [
        ("point 32 hangs on joint 1, but the skin has 1", |b| b.document["skins"][0]["joints"] = json!([0])),
        ("it has 2 joints and 1 inverse bind matrices", |b| {
            b.bind([0.0, 0.0]);
            let inverses = b.document["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
            b.document["accessors"][inverses]["count"] = json!(1);
        }),
        ("another number of items", |b| b.document["accessors"][2]["count"] = json!(63)),
        ("joints must be unsigned", |b| b.document["accessors"][2]["componentType"] = json!(5120)),
        ("weights need the type VEC4", |b| b.document["accessors"][3]["type"] = json!("VEC3")),
        ("is its own ancestor", |b| {
            b.document["nodes"] = json!([{ "children": [1] }, { "children": [0] }, { "mesh": 0, "skin": 0 }]);
            b.document["scenes"][0]["nodes"] = json!([2]);
        }),
    ];
    for (problem, change) in cases {
        let mut body = Body::new();
        change(&mut body);
        let (code, message, _) = refused(body.read(Pose::Saved));
        assert_eq!(code, "malformed-file", "{message}");
        assert!(message.contains(problem), "{message}");
        assert_eq!(body.read(Pose::Rest).unwrap().points(), torus().points, "{problem}");
    }
    let mut body = Body::new();
    body.document["nodes"][2]["skin"] = json!(4);
    assert_eq!(refused(body.read(Pose::Saved)).0, "malformed-file");
}

#[test]
fn targets_that_small_files_name_again_and_again_are_refused() {
    let mut body = Body::new();
    let targets: Vec<Value> = (0..60_000).map(|_| json!({ "POSITION": 0 })).collect();
    body.document["meshes"][0]["weights"] = json!(vec![1; targets.len()]);
    body.document["meshes"][0]["primitives"][0]["targets"] = json!(targets);
    body.document["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 });
    body.document["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0 }, { "mesh": 0 }]);
    match body.read(Pose::Saved) {
        Err(error) => assert_eq!(error.code(), "too-large"),
        Ok(_) => panic!("ten million points of targets"),
    }
}

#[test]
fn a_pose_is_nothing_to_other_formats() {
    let off = crate::sample::off(&torus());
    assert_is_torus(&read_with(off.as_bytes(), &ReadOptions { pose: Pose::Rest, ..ReadOptions::default() }).unwrap());
}
