//! Fourteen sided body parts, from the skinning weights.

use super::skeleton::Bone;
use super::skinning::Weights;
use crate::network::Category;

/// Names of the sided parts; a label is an index here. Left is the person's own left. The paper has C = 8 and does not say which; these are finer, and sets
/// with other classes are compared after merging by name.
pub const PARTS: [&str; 14] = [
    "head",
    "torso",
    "left upper arm",
    "right upper arm",
    "left forearm",
    "right forearm",
    "left hand",
    "right hand",
    "left thigh",
    "right thigh",
    "left shank",
    "right shank",
    "left foot",
    "right foot",
];

/// The category of the bodies made here. Its shares of the area are those of 24 of them (seeds from 800101).
pub fn people() -> Category {
    let category = Category::from_json(include_str!("../../../data/categories/people.json"));
    category.expect("the category beside the source is sound")
}

/// The part a bone of the `game_engine` rig belongs to: neck to the head, shoulder blades to the torso, fingers to the hand.
pub fn part_of_bone(bone: &str) -> usize {
    let (name, right) = match (bone.strip_suffix("_l"), bone.strip_suffix("_r")) {
        (Some(name), _) => (name, 0),
        (_, Some(name)) => (name, 1),
        _ => (bone, 0),
    };
    match name {
        "head" | "neck_01" => 0,
        "upperarm" => 2 + right,
        "lowerarm" => 4 + right,
        "thigh" => 8 + right,
        "calf" => 10 + right,
        "foot" | "ball" => 12 + right,
        _ if ["hand", "index", "middle", "ring", "pinky", "thumb"].iter().any(|p| name.starts_with(p)) => 6 + right,
        _ => 1,
    }
}

/// The same part of the other side; head and torso have none but their own.
pub fn mirrored_part(label: u32) -> u32 {
    if label < 2 { label } else { label ^ 1 }
}

/// A label per vertex: the part whose bones move it most.
pub fn labels(bones: &[Bone], weights: &Weights) -> Vec<u32> {
    let parts: Vec<usize> = bones.iter().map(|b| part_of_bone(&b.name)).collect();
    let heaviest = |row: &Vec<(usize, f64)>| {
        let mut sums = [0.0; PARTS.len()];
        for &(bone, weight) in row {
            sums[parts[bone]] += weight;
        }
        (0..PARTS.len()).rev().max_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap_or(1) as u32
    };
    weights.rows().iter().map(heaviest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_and_its_mirror_image_differ_in_their_side_alone() {
        for (label, name) in PARTS.iter().enumerate() {
            let other = PARTS[mirrored_part(label as u32) as usize];
            assert_eq!(other, name.replace("left", "LEFT").replace("right", "left").replace("LEFT", "right"));
        }
    }

    #[test]
    fn every_bone_goes_to_its_own_side() {
        assert_eq!(PARTS[part_of_bone("thumb_02_l")], "left hand");
        assert_eq!(PARTS[part_of_bone("calf_r")], "right shank");
        assert_eq!(PARTS[part_of_bone("clavicle_r")], "torso");
        assert_eq!(PARTS[part_of_bone("neck_01")], "head");
    }
}
