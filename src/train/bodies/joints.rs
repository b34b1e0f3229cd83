//! Turns the angles of a [`Pose`] into a turn of every bone.

use glam::{DQuat, DVec3};

use super::pose::{Arm, Bend, Leg, Pose};
use super::skeleton::Skeleton;

impl Pose {
    /// A turn for every bone of a `game_engine` skeleton, for [`Skeleton::motions`]. Bones the skeleton lacks are skipped.
    pub fn turns(&self, skeleton: &Skeleton) -> Vec<DQuat> {
        let mut turns = Turns { skeleton, turns: vec![DQuat::IDENTITY; skeleton.bones.len()] };
        turns.set("pelvis", bend(self.pelvis, 1.0));
        for bone in ["spine_01", "spine_02", "spine_03"] {
            turns.set(bone, bend(self.spine, 3.0));
        }
        for bone in ["neck_01", "head"] {
            turns.set(bone, bend(self.neck, 2.0));
        }
        for (side, (arm, leg)) in [Side::Left, Side::Right].into_iter().zip(self.arms.iter().zip(&self.legs)) {
            turns.arm(side, arm);
            turns.hand(side, arm);
            turns.leg(side, leg);
        }
        turns.turns
    }
}

impl Pose {
    /// Sets the turns of one limb's bones as [`Pose::turns`] would, those of the fingers apart; `side` is 0 for the left. The sole is level only if the turn of the
    /// pelvis is already there.
    pub fn turn_limb(&self, limb: LimbKind, side: usize, skeleton: &Skeleton, turns: &mut Vec<DQuat>) {
        let name = if side == 0 { Side::Left } else { Side::Right };
        let mut all = Turns { skeleton, turns: std::mem::take(turns) };
        match limb {
            LimbKind::Arm => {
                all.arm(name, &self.arms[side]);
                all.wrist(name, &self.arms[side]);
            }
            LimbKind::Leg => {
                all.leg(name, &self.legs[side]);
            }
        }
        *turns = all.turns;
    }
}

/// An arm or a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LimbKind {
    /// From the shoulder blade to the wrist.
    Arm,
    /// From the hip to the ankle.
    Leg,
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

impl Side {
    fn bone(self, name: &str) -> String {
        format!("{name}_{}", if self == Side::Left { "l" } else { "r" })
    }

    /// To the left side and back: its own inverse.
    fn mirror(self, v: DVec3) -> DVec3 {
        if self == Side::Left { v } else { DVec3::new(-v.x, v.y, v.z) }
    }

    fn mirror_turn(self, q: DQuat) -> DQuat {
        if self == Side::Left { q } else { DQuat::from_xyzw(q.x, -q.y, -q.z, q.w) }
    }
}

struct Turns<'a> {
    skeleton: &'a Skeleton,
    turns: Vec<DQuat>,
}

impl Turns<'_> {
    fn set(&mut self, bone: &str, turn: DQuat) {
        if let Some(b) = self.skeleton.find(bone) {
            self.turns[b] = turn;
        }
    }

    /// A turn worked out for the left side.
    fn set_side(&mut self, side: Side, bone: &str, turn: DQuat) {
        self.set(&side.bone(bone), side.mirror_turn(turn));
    }

    /// A bone's rest direction, as if it were on the left.
    fn direction(&self, side: Side, bone: &str) -> Option<DVec3> {
        Some(side.mirror(self.skeleton.direction(&side.bone(bone))?))
    }

    fn arm(&mut self, side: Side, arm: &Arm) -> Option<()> {
        let (upper, fore) = (self.direction(side, "upperarm")?, self.direction(side, "lowerarm")?);
        let (sin, cos) = arm.raise.to_radians().sin_cos();
        let (forward, sideways) = arm.forward.to_radians().sin_cos();
        let to = DVec3::new(sin * sideways, -cos, sin * forward);
        let swing = DQuat::from_rotation_arc(upper, to);
        // The shoulder blade takes part in raising the arm, hardly in lowering it.
        let share = if to.y > upper.y { 0.25 } else { 0.1 };
        let blade = DQuat::IDENTITY.slerp(swing, share);
        self.set_side(side, "clavicle", blade);
        self.set_side(side, "upperarm", blade.inverse() * about(to, arm.twist) * swing);

        // The rest pose bends the elbow, so it knows the hinge.
        let hinge = upper.cross(fore).try_normalize()?;
        let pronation = about(fore, arm.pronation / 2.0);
        self.set_side(side, "lowerarm", about(hinge, arm.elbow - degrees_between(hinge, upper, fore)) * pronation);
        self.set_side(side, "hand", pronation);
        Some(())
    }

    /// Bends the wrist; the axis about which wrist and fingers bend.
    fn wrist(&mut self, side: Side, arm: &Arm) -> Option<DVec3> {
        let curl_axis = self.direction(side, "middle_01")?.cross(self.direction(side, "middle_03")?).try_normalize()?;
        let hand = self.skeleton.find(&side.bone("hand"))?;
        self.turns[hand] *= side.mirror_turn(about(curl_axis, arm.wrist));
        Some(curl_axis)
    }

    fn hand(&mut self, side: Side, arm: &Arm) -> Option<()> {
        let curl_axis = self.wrist(side, arm)?;
        for finger in ["index", "middle", "ring", "pinky", "thumb"] {
            let tip = self.direction(side, &format!("{finger}_03"));
            let axis = self.direction(side, &format!("{finger}_01")).zip(tip).map(|(a, b)| a.cross(b));
            let curl = if finger == "thumb" { arm.curl / 3.0 } else { arm.curl };
            for joint in ["01", "02", "03"] {
                let turn = about(axis.and_then(DVec3::try_normalize).unwrap_or(curl_axis), curl);
                self.set_side(side, &format!("{finger}_{joint}"), turn);
            }
        }
        Some(())
    }

    fn leg(&mut self, side: Side, leg: &Leg) -> Option<()> {
        let (thigh, calf) = (self.direction(side, "thigh")?, self.direction(side, "calf")?);
        let to = about(DVec3::X, -leg.raise) * about(DVec3::Z, leg.out) * DVec3::NEG_Y;
        let swing = about(to, -leg.twist) * DQuat::from_rotation_arc(thigh, to);
        let hinge = (DVec3::X - DVec3::X.dot(thigh) * thigh).try_normalize()?;
        let knee = about(hinge, leg.knee - degrees_between(hinge, thigh, calf));
        self.set_side(side, "thigh", swing);
        self.set_side(side, "calf", knee);
        let ankle = match leg.ankle {
            Some(angle) => about(hinge, -angle),
            None => {
                // Undo what hips and knee did, but for the heading of the toes.
                let pelvis = self.skeleton.find("pelvis").map_or(DQuat::IDENTITY, |b| side.mirror_turn(self.turns[b]));
                let shank = pelvis * swing * knee;
                let toes = (pelvis * swing * hinge).cross(DVec3::Y);
                let heading = DQuat::from_rotation_y(toes.x.atan2(toes.z));
                shank.inverse() * heading
            }
        };
        self.set_side(side, "foot", ankle);
        Some(())
    }
}

fn about(axis: DVec3, degrees: f64) -> DQuat {
    DQuat::from_axis_angle(axis, degrees.to_radians())
}

/// One of `bones` equal turns that add up to `bend`.
fn bend(bend: Bend, bones: f64) -> DQuat {
    about(DVec3::Y, bend.turn / bones) * about(DVec3::Z, -bend.left / bones) * about(DVec3::X, bend.forward / bones)
}

/// Degrees that `about` the unit `axis` take `from` to `to`, both seen along the axis.
fn degrees_between(axis: DVec3, from: DVec3, to: DVec3) -> f64 {
    let along = from.dot(axis) * to.dot(axis);
    axis.dot(from.cross(to)).atan2(from.dot(to) - along).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::bodies::skeleton::RestBone;

    /// A symmetric stick figure with bent elbows and legs apart.
    fn stick_figure() -> Skeleton {
        let mut bones = Vec::new();
        let mut add = |name: &str, parent: Option<usize>, head: [f64; 3], tail: [f64; 3]| {
            bones.push(RestBone { name: name.to_owned(), parent, head: head.into(), tail: tail.into() });
            bones.len() - 1
        };
        let pelvis = add("pelvis", None, [0.0, 10.0, 0.0], [0.0, 11.0, 0.0]);
        let mut spine = pelvis;
        for (name, y) in [("spine_01", 11.0), ("spine_02", 12.0), ("spine_03", 13.0)] {
            spine = add(name, Some(spine), [0.0, y, 0.0], [0.0, y + 1.0, 0.0]);
        }
        for (side, s) in [("l", 1.0), ("r", -1.0)] {
            let mut limb = |names: [&str; 3], parent, joints: [[f64; 3]; 4]| {
                let joints = joints.map(|[x, y, z]| [s * x, y, z]);
                (0..3).fold(parent, |p, i| add(&format!("{}_{side}", names[i]), Some(p), joints[i], joints[i + 1]))
            };
            let arm = [[0.5, 14.0, 0.0], [1.5, 14.0, 0.0], [3.0, 12.5, 0.0], [4.0, 11.5, 1.5]];
            let elbow = limb(["clavicle", "upperarm", "lowerarm"], spine, arm);
            limb(
                ["hand", "middle_01", "middle_03"],
                elbow,
                [arm[3], [4.3, 11.1, 2.0], [4.6, 10.8, 2.5], [4.8, 10.5, 2.7]],
            );
            limb(
                ["thigh", "calf", "foot"],
                pelvis,
                [[1.0, 9.5, 0.0], [1.5, 5.0, 0.2], [2.0, 1.0, 0.0], [2.0, 0.0, 1.0]],
            );
        }
        Skeleton { bones }
    }

    fn tails(skeleton: &Skeleton, pose: &Pose) -> Vec<DVec3> {
        let motions = skeleton.motions(&pose.turns(skeleton));
        skeleton.bones.iter().zip(&motions).map(|(b, m)| m.apply(b.tail)).collect()
    }

    fn posed_direction(skeleton: &Skeleton, pose: &Pose, bone: &str) -> DVec3 {
        let b = skeleton.find(bone).expect("known");
        skeleton.motions(&pose.turns(skeleton))[b].rotation * skeleton.direction(bone).expect("has a length")
    }

    fn lively() -> Pose {
        Pose {
            pelvis: Bend { forward: 10.0, left: 5.0, turn: -20.0 },
            spine: Bend { forward: 30.0, left: -15.0, turn: 25.0 },
            neck: Bend { turn: 10.0, ..Bend::default() },
            arms: [
                Arm { raise: 120.0, forward: 40.0, twist: 20.0, elbow: 80.0, pronation: 30.0, wrist: 20.0, curl: 15.0 },
                Arm { raise: 20.0, forward: -10.0, elbow: 5.0, ..Arm::default() },
            ],
            legs: [
                Leg { raise: 70.0, out: 20.0, twist: 10.0, knee: 90.0, ankle: None },
                Leg { raise: -10.0, knee: 20.0, ankle: Some(10.0), ..Leg::default() },
            ],
        }
    }

    #[test]
    fn a_mirrored_pose_gives_the_mirrored_body() {
        let skeleton = stick_figure();
        let (a, b) = (tails(&skeleton, &lively()), tails(&skeleton, &lively().mirrored()));
        for (bone, tail) in skeleton.bones.iter().zip(&a) {
            let twin = match bone.name.rsplit_once('_') {
                Some((name, "l")) => format!("{name}_r"),
                Some((name, "r")) => format!("{name}_l"),
                _ => bone.name.clone(),
            };
            let other = b[skeleton.find(&twin).expect("symmetric")];
            assert!(tail.distance(DVec3::new(-other.x, other.y, other.z)) < 1e-12, "{}", bone.name);
        }
    }

    #[test]
    fn angles_say_where_limbs_go_whatever_the_rest_pose() {
        let skeleton = stick_figure();
        let hanging = Pose::default();
        for bone in ["upperarm_l", "lowerarm_l", "upperarm_r", "lowerarm_r", "thigh_l", "thigh_r"] {
            let down = posed_direction(&skeleton, &hanging, bone);
            assert!(down.distance(DVec3::NEG_Y) < 1e-12, "{bone} {down}");
        }
        // Shanks lean outwards as at rest; half a degree of that shows from the side.
        assert!(posed_direction(&skeleton, &hanging, "calf_r").z.abs() < 0.01);
        let arm = Arm { raise: 90.0, forward: 90.0, ..Arm::default() };
        let ahead = Pose { arms: [arm; 2], ..Pose::default() };
        assert!(posed_direction(&skeleton, &ahead, "lowerarm_r").distance(DVec3::Z) < 1e-12);
        let leg = Leg { raise: 90.0, knee: 90.0, ..Leg::default() };
        let sitting = Pose { legs: [leg; 2], ..Pose::default() };
        assert!(posed_direction(&skeleton, &sitting, "thigh_l").distance(DVec3::Z) < 1e-12);
        assert!(posed_direction(&skeleton, &sitting, "calf_l").z.abs() < 0.01);
    }

    #[test]
    fn elbows_bend_forward_knees_back_and_left_is_plus_x() {
        let skeleton = stick_figure();
        let bent = Pose { arms: [Arm { elbow: 60.0, ..Arm::default() }; 2], ..Pose::default() };
        assert!(posed_direction(&skeleton, &bent, "lowerarm_l").z > 0.5);
        let bent = Pose { legs: [Leg { knee: 60.0, ..Leg::default() }; 2], ..Pose::default() };
        assert!(posed_direction(&skeleton, &bent, "calf_r").z < -0.5);
        let lean = Pose { spine: Bend { left: 40.0, ..Bend::default() }, ..Pose::default() };
        assert!(posed_direction(&skeleton, &lean, "spine_03").x > 0.5);
        let aside = Pose { arms: [Arm { raise: 90.0, ..Arm::default() }; 2], ..Pose::default() };
        assert!(posed_direction(&skeleton, &aside, "upperarm_l").x > 0.99);
    }

    #[test]
    fn a_level_sole_stays_level_under_bent_legs() {
        let skeleton = stick_figure();
        let foot = skeleton.find("foot_l").expect("known");
        let pose = lively();
        let up = skeleton.motions(&pose.turns(&skeleton))[foot].rotation * DVec3::Y;
        assert!(up.distance(DVec3::Y) < 1e-12, "{up}");
        assert!(pose.is_within_limits());
        assert!(!Pose { arms: [Arm { elbow: 150.0, ..Arm::default() }; 2], ..pose }.is_within_limits());
    }
}
