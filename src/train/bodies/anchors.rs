//! Poses that people struck for MakeHuman (CC0, see `motions/README.md`): frames of motion files, varied.
//!
//! Their two rigs are not the one that moves our bodies. Each bone of ours takes the turn of the joint that moves the same stretch of the body, after the
//! turn that lays our rest direction on theirs (one of the rigs rests with level arms). Fingers keep to their own limits and are drawn.

use std::sync::OnceLock;

use glam::{DQuat, DVec3};
use rand_chacha::ChaCha8Rng;

use super::bvh::Bvh;
use super::chance::{happens, normal, normal_vector, pick, uniform};
use super::pose::Pose;
use super::skeleton::Skeleton;

/// The files.
const FILES: [&str; 19] = [
    include_str!("../../../data/motions/benchmark.bvh"),
    include_str!("../../../data/motions/dance1.bvh"),
    include_str!("../../../data/motions/fight01.bvh"),
    include_str!("../../../data/motions/fight02.bvh"),
    include_str!("../../../data/motions/fight03.bvh"),
    include_str!("../../../data/motions/fight04.bvh"),
    include_str!("../../../data/motions/fly01.bvh"),
    include_str!("../../../data/motions/fly02.bvh"),
    include_str!("../../../data/motions/gym01.bvh"),
    include_str!("../../../data/motions/run01.bvh"),
    include_str!("../../../data/motions/sit01.bvh"),
    include_str!("../../../data/motions/standing01.bvh"),
    include_str!("../../../data/motions/standing02.bvh"),
    include_str!("../../../data/motions/standing03.bvh"),
    include_str!("../../../data/motions/standing04.bvh"),
    include_str!("../../../data/motions/standing05.bvh"),
    include_str!("../../../data/motions/standing06.bvh"),
    include_str!("../../../data/motions/walk1.bvh"),
    include_str!("../../../data/motions/zombieWalk1.bvh"),
];

/// A bone of ours, and in either rig the joint that turns it. `_l` and `.L` stand for both sides.
struct Twin {
    bone: &'static str,
    joints: [&'static str; 2],
    /// Where the bone's rest direction leads, ours and theirs, and where theirs begins; without it the rest poses agree.
    towards: Option<(&'static str, [(&'static str, &'static str); 2])>,
}

const fn twin(bone: &'static str, joints: [&'static str; 2]) -> Twin {
    Twin { bone, joints, towards: None }
}

/// Our bones but for fingers and toes.
const TWINS: [Twin; 13] = [
    twin("pelvis", ["root", "Hips"]),
    twin("spine_01", ["spine04", "Spine1"]),
    twin("spine_02", ["spine02", "Spine2"]),
    twin("spine_03", ["spine01", "Spine3"]),
    twin("neck_01", ["neck02", "Neck"]),
    twin("head", ["head", "Head"]),
    twin("clavicle_l", ["shoulder01.L", "Clavicle_L"]),
    Twin {
        bone: "upperarm_l",
        joints: ["upperarm02.L", "UpArm_L"],
        towards: Some(("lowerarm_l", [("upperarm01.L", "lowerarm01.L"), ("UpArm_L", "LoArm_L")])),
    },
    Twin {
        bone: "lowerarm_l",
        joints: ["lowerarm01.L", "LoArm_L"],
        towards: Some(("hand_l", [("lowerarm01.L", "wrist.L"), ("LoArm_L", "Hand_L")])),
    },
    Twin {
        bone: "thigh_l",
        joints: ["upperleg02.L", "UpLeg_L"],
        towards: Some(("calf_l", [("upperleg01.L", "lowerleg01.L"), ("UpLeg_L", "LoLeg_L")])),
    },
    Twin {
        bone: "calf_l",
        joints: ["lowerleg01.L", "LoLeg_L"],
        towards: Some(("foot_l", [("lowerleg01.L", "foot.L"), ("LoLeg_L", "Foot_L")])),
    },
    twin("foot_l", ["foot.L", "Foot_L"]),
    Twin {
        bone: "hand_l",
        joints: ["wrist.L", "Hand_L"],
        towards: Some(("middle_01_l", [("wrist.L", "finger3-1.L"), ("Hand_L", "Middle1_L")])),
    },
];

/// Bones that are taken together from another pose.
const GROUPS: [&[&str]; 5] = [
    &["clavicle_l", "upperarm_l", "lowerarm_l", "hand_l"],
    &["clavicle_r", "upperarm_r", "lowerarm_r", "hand_r"],
    &["thigh_l", "calf_l", "foot_l"],
    &["thigh_r", "calf_r", "foot_r"],
    &["neck_01", "head"],
];
/// How often each of them is.
const EXCHANGED: f64 = 0.3;
/// Standard deviation of the turn that every joint gets besides, in degrees.
const VARIED: f64 = 5.0;

/// A pose of the files for `skeleton`: any frame, perhaps mirrored, some limbs exchanged for those of a random pose, every joint varied a little. Turns as for
/// [`Skeleton::motions`].
pub fn random_turns(skeleton: &Skeleton, rng: &mut ChaCha8Rng) -> Vec<DQuat> {
    static PARSED: OnceLock<Vec<Bvh>> = OnceLock::new();
    let files =
        PARSED.get_or_init(|| FILES.iter().map(|text| Bvh::parse(text).expect("the files here are valid")).collect());
    let file = pick(rng, files);
    let frame = uniform(rng, 0.0..file.frames() as f64) as usize;
    let mut turns = turns(skeleton, file, frame);
    if happens(rng, 0.5) {
        turns = mirrored(skeleton, &turns);
    }
    let other = Pose::random(rng).turns(skeleton);
    for group in GROUPS {
        if happens(rng, EXCHANGED) {
            group.iter().filter_map(|name| skeleton.find(name)).for_each(|b| turns[b] = other[b]);
        }
    }
    for (b, bone) in skeleton.bones.iter().enumerate() {
        if is_finger(&bone.name) {
            turns[b] = other[b];
        } else if bone.parent.is_some() && !bone.name.starts_with("ball") {
            let axis = normal_vector(rng).normalize_or(DVec3::X);
            turns[b] *= DQuat::from_axis_angle(axis, (VARIED * normal(rng)).to_radians());
        }
    }
    turns
}

fn is_finger(bone: &str) -> bool {
    ["thumb", "index", "middle", "ring", "pinky"].iter().any(|finger| bone.starts_with(finger))
}

/// The turns of one frame.
fn turns(skeleton: &Skeleton, file: &Bvh, frame: usize) -> Vec<DQuat> {
    let turned = file.turned(frame);
    let rig = usize::from(file.find(TWINS[0].joints[0]).is_none());
    let mut ours: Vec<Option<DQuat>> = vec![None; skeleton.bones.len()];
    for side in ["l", "r"] {
        // The names of the left side for this one.
        let bone = |name: &str| skeleton.find(&name.strip_suffix("_l").map_or(name.into(), |n| format!("{n}_{side}")));
        let joint = |name: &str| {
            let stem = name.strip_suffix(".L").map(|n| (n, '.')).or(name.strip_suffix("_L").map(|n| (n, '_')));
            file.find(&stem.map_or(name.into(), |(n, dot)| format!("{n}{dot}{}", side.to_uppercase())))
        };
        for twin in &TWINS {
            let (Some(b), Some(j)) = (bone(twin.bone), joint(twin.joints[rig])) else { continue };
            let laid = twin.towards.and_then(|(to, theirs)| {
                let (from, end) = theirs[rig];
                let ours = skeleton.bones[bone(to)?].head - skeleton.bones[b].head;
                let theirs = file.joints[joint(end)?].place - file.joints[joint(from)?].place;
                Some(DQuat::from_rotation_arc(ours.try_normalize()?, theirs.try_normalize()?))
            });
            ours[b] = Some(turned[j] * laid.unwrap_or(DQuat::IDENTITY));
        }
    }
    // What no joint turns goes with its parent.
    let mut all: Vec<DQuat> = Vec::with_capacity(ours.len());
    let mut turns = Vec::with_capacity(ours.len());
    for (bone, own) in skeleton.bones.iter().zip(ours) {
        let parent = bone.parent.map_or(DQuat::IDENTITY, |p| all[p]);
        let own = own.unwrap_or(parent);
        turns.push((parent.inverse() * own).normalize());
        all.push(own);
    }
    turns
}

/// The pose seen in a mirror.
fn mirrored(skeleton: &Skeleton, turns: &[DQuat]) -> Vec<DQuat> {
    let twin = |name: &str| match (name.strip_suffix("_l"), name.strip_suffix("_r")) {
        (Some(stem), _) => skeleton.find(&format!("{stem}_r")),
        (_, Some(stem)) => skeleton.find(&format!("{stem}_l")),
        _ => None,
    };
    let image = |q: DQuat| DQuat::from_xyzw(q.x, -q.y, -q.z, q.w);
    skeleton.bones.iter().enumerate().map(|(b, bone)| image(turns[twin(&bone.name).unwrap_or(b)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::skeleton::RestBone;

    /// Where the joints of a file are, as a skeleton of ours.
    fn skeleton(file: &Bvh) -> Skeleton {
        let rig = usize::from(file.find("root").is_none());
        let place = |name: &str| file.joints[file.find(name).expect(name)].place;
        let mut bones: Vec<RestBone> = Vec::new();
        let mut add = |name: &str, parent: &str, joint: &str| {
            let parent = bones.iter().position(|b| b.name == parent);
            bones.push(RestBone { name: name.to_owned(), parent, head: place(joint), tail: place(joint) });
        };
        let names: [[&str; 10]; 2] = [
            [
                "upperarm01.",
                "lowerarm01.",
                "wrist.",
                "finger3-1.",
                "upperleg01.",
                "lowerleg01.",
                "foot.",
                "L",
                "R",
                "root",
            ],
            ["UpArm_", "LoArm_", "Hand_", "Middle1_", "UpLeg_", "LoLeg_", "Foot_", "L", "R", "Hips"],
        ];
        let names = names[rig];
        add("pelvis", "", names[9]);
        for (side, theirs) in [("l", names[7]), ("r", names[8])] {
            let chain = ["upperarm", "lowerarm", "hand", "middle_01", "thigh", "calf", "foot"];
            for (i, name) in chain.iter().enumerate() {
                let parent = if i % 4 == 0 { "pelvis".to_owned() } else { format!("{}_{side}", chain[i - 1]) };
                add(&format!("{name}_{side}"), &parent, &format!("{}{theirs}", names[i]));
            }
        }
        Skeleton { bones }
    }

    #[test]
    fn limbs_point_where_those_of_the_file_point_whatever_our_rest_pose() {
        for text in FILES {
            let file = Bvh::parse(text).expect("valid");
            let rig = usize::from(file.find("root").is_none());
            let mut ours = skeleton(&file);
            // Another rest pose than theirs: arms and legs turned about the shoulders and the hips.
            for (limb, angle) in
                [("arm", 0.4), ("hand", 0.4), ("middle", 0.4), ("thigh", -0.2), ("calf", -0.2), ("foot", -0.2)]
            {
                for b in ours.bones.iter_mut().filter(|b| b.name.contains(limb)) {
                    b.head = DQuat::from_rotation_z(angle) * b.head;
                }
            }
            let frame = file.frames() - 1;
            let (turned, motions) = (file.turned(frame), ours.motions(&turns(&ours, &file, frame)));
            for twin in TWINS.iter().filter(|t| t.towards.is_some()) {
                let (to, theirs) = twin.towards.expect("filtered");
                let at = |name: &str| ours.find(name).map(|b| (b, ours.bones[b].head)).expect(name);
                let ((bone, from), (_, end)) = (at(twin.bone), at(to));
                let ours = motions[bone].rotation * (end - from).normalize();
                let place = |name: &str| file.joints[file.find(name).expect(name)].place;
                let (from, end) = theirs[rig];
                let joint = file.find(twin.joints[rig]).expect("known");
                let theirs = turned[joint] * (place(end) - place(from)).normalize();
                assert!(ours.distance(theirs) < 1e-9, "{}: {ours} {theirs}", twin.bone);
            }
        }
    }

    #[test]
    fn a_mirrored_pose_moves_the_other_side() {
        let ours = skeleton(&Bvh::parse(FILES[2]).expect("valid"));
        let turns = turns(&ours, &Bvh::parse(FILES[2]).expect("valid"), 0);
        let image = mirrored(&ours, &turns);
        let (l, r) = (ours.find("calf_l").expect("known"), ours.find("calf_r").expect("known"));
        assert!(turns[l].angle_between(image[l]) > 0.01);
        let flip = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
        assert!((image[r] * DVec3::Y).distance(flip(turns[l] * DVec3::Y)) < 1e-12);
        assert_eq!(mirrored(&ours, &image), turns);
    }
}
