//! Body parts: their names, and which of them meet.

use ndarray::ArrayView1;

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

/// The paper's C = 8, as it may have meant it: an arm with its hand and a shank with its foot are one.
pub const GROUPS: [&str; 8] =
    ["head", "torso", "left arm", "right arm", "left thigh", "right thigh", "left shank", "right shank"];

/// The group, an index into [`GROUPS`], of each of [`PARTS`].
pub const GROUP_OF_PART: [u8; 14] = [0, 1, 2, 3, 2, 3, 2, 3, 4, 5, 6, 7, 6, 7];

/// Parts that meet on a person, besides each with itself.
const MEETING: [[usize; 2]; 13] =
    [[0, 1], [1, 2], [1, 3], [1, 8], [1, 9], [2, 4], [3, 5], [4, 6], [5, 7], [8, 10], [9, 11], [10, 12], [11, 13]];

/// Probability that two points belong to one part or to parts that meet, by their probabilities (14) of parts, as if these were independent of each other:
/// where both are in doubt between parts that do not meet, it is as low as where they differ.
pub(crate) fn meeting(p: ArrayView1<f32>, q: ArrayView1<f32>) -> f32 {
    let same: f32 = p.dot(&q);
    same + MEETING.iter().map(|&[i, j]| p[i] * q[j] + p[j] * q[i]).sum::<f32>()
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, array};

    use super::{GROUP_OF_PART, GROUPS, MEETING, PARTS, meeting};

    fn certain(part: usize) -> Array1<f32> {
        let mut row = Array1::zeros(PARTS.len());
        row[part] = 1.0;
        row
    }

    #[test]
    fn a_group_has_its_parts_side_and_its_limb() {
        let limb = |name: &str| match name.rsplit(' ').next() {
            Some("forearm" | "hand") => "arm".to_owned(),
            Some("foot") => "shank".to_owned(),
            last => last.unwrap_or_default().to_owned(),
        };
        let side = |name: &str| name.split_once(' ').map(|(side, _)| side.to_owned());
        for (part, group) in PARTS.iter().zip(GROUP_OF_PART) {
            let group = GROUPS[usize::from(group)];
            assert_eq!((side(part), limb(part)), (side(group), limb(group)), "{part} {group}");
        }
    }

    #[test]
    fn parts_meet_themselves_and_their_neighbours_on_both_sides_alike() {
        let side = |part: usize, from: &str, to: &str| {
            let name = PARTS[part].replace(from, to);
            PARTS.iter().position(|other| *other == name).expect("both sides have the same parts")
        };
        for (i, one) in PARTS.iter().enumerate() {
            for (j, another) in PARTS.iter().enumerate() {
                let (p, q) = (certain(i), certain(j));
                let met = meeting(p.view(), q.view());
                let listed = i == j || MEETING.contains(&[i.min(j), i.max(j)]);
                assert_eq!(met, if listed { 1.0 } else { 0.0 }, "{one} {another}");
                assert_eq!(met, meeting(q.view(), p.view()));
                let other = |part: usize| {
                    if PARTS[part].starts_with("left") {
                        side(part, "left", "right")
                    } else {
                        side(part, "right", "left")
                    }
                };
                assert_eq!(met, meeting(certain(other(i)).view(), certain(other(j)).view()));
            }
        }
        let doubtful = array![0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(meeting(doubtful.view(), certain(4).view()), 0.5, "torso or hand beside a forearm");
    }
}
