//! Poses as a handful of joint angles, in degrees, the same for every person.
//!
//! Angles say where a limb goes, not how far it turns from the rest pose: `elbow: 0` is a straight arm, `raise: 90` a level
//! one, whatever the rest pose of the rig is. The right side is the left side mirrored.

use glam::{DQuat, DVec3};

use super::skeleton::Skeleton;

/// A whole body's pose. [`Pose::default`] stands straight with hanging arms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Of the whole body at the hips.
    pub pelvis: Bend,
    /// From hips to shoulders, spread over three bones.
    pub spine: Bend,
    /// From shoulders to head, spread over two bones.
    pub neck: Bend,
    /// Left and right arm.
    pub arms: [Arm; 2],
    /// Left and right leg.
    pub legs: [Leg; 2],
}

/// Bending of a vertical part of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Forward.
    pub forward: f64,
    /// Towards the person's left.
    pub left: f64,
    /// Turning the front towards the person's left.
    pub turn: f64,
}

/// One arm, seen from its own side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Arm {
    /// Upper arm: 0 hangs, 90 is level, 180 points up.
    pub raise: f64,
    /// Where a raised arm points: 0 to its own side, 90 forward.
    pub forward: f64,
    /// About the upper arm, inwards.
    pub twist: f64,
    /// 0 is straight.
    pub elbow: f64,
    /// About the forearm, palm turning inwards and back.
    pub pronation: f64,
    /// Towards the palm.
    pub wrist: f64,
    /// Each finger joint, on top of the half-open hand at rest.
    pub curl: f64,
}

/// One leg, seen from its own side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leg {
    /// Thigh: 0 hangs, 90 points forward, negative back.
    pub raise: f64,
    /// Thigh to its own side.
    pub out: f64,
    /// About the thigh, toes outwards.
    pub twist: f64,
    /// 0 is straight.
    pub knee: f64,
    /// Toes up; `None` keeps the sole level.
    pub ankle: Option<f64>,
}

/// Limits of the joints in degrees: what stays clear of tearing the skin and, mostly, of the body passing through itself.
pub mod limits {
    use std::ops::RangeInclusive;
    /// Of [`super::Arm::raise`].
    pub const ARM_RAISE: RangeInclusive<f64> = 0.0..=170.0;
    /// Of [`super::Arm::elbow`].
    pub const ELBOW: RangeInclusive<f64> = 0.0..=135.0;
    /// Of [`super::Leg::raise`].
    pub const LEG_RAISE: RangeInclusive<f64> = -30.0..=95.0;
    /// Of [`super::Leg::out`].
    pub const LEG_OUT: RangeInclusive<f64> = -10.0..=50.0;
    /// Of [`super::Leg::knee`].
    pub const KNEE: RangeInclusive<f64> = 0.0..=130.0;
    /// Of the three parts of a [`super::Bend`].
    pub const BEND: RangeInclusive<f64> = -60.0..=90.0;
}

impl Pose {
    /// Whether every limited angle is inside its limits.
    pub fn is_within_limits(&self) -> bool {
        let bends = [self.pelvis, self.spine, self.neck];
        let bend = |b: &Bend| [b.forward, b.left, b.turn].iter().all(|a| limits::BEND.contains(a));
        let arm = |a: &Arm| limits::ARM_RAISE.contains(&a.raise) && limits::ELBOW.contains(&a.elbow);
        let leg = |l: &Leg| {
            limits::LEG_RAISE.contains(&l.raise) && limits::LEG_OUT.contains(&l.out) && limits::KNEE.contains(&l.knee)
        };
        bends.iter().all(bend) && self.arms.iter().all(arm) && self.legs.iter().all(leg)
    }

    /// The same pose seen in a mirror: left and right change places.
    pub fn mirrored(&self) -> Self {
        let flip = |b: Bend| Bend { forward: b.forward, left: -b.left, turn: -b.turn };
        let ([al, ar], [ll, lr]) = (self.arms, self.legs);
        Self {
            pelvis: flip(self.pelvis),
            spine: flip(self.spine),
            neck: flip(self.neck),
            arms: [ar, al],
            legs: [lr, ll],
        }
    }

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
        self.set_side(side, "lowerarm", about(hinge, arm.elbow - degrees_between(upper, fore)) * pronation);
        self.set_side(side, "hand", pronation);
        Some(())
    }

    fn hand(&mut self, side: Side, arm: &Arm) -> Option<()> {
        let curl_axis = self.direction(side, "middle_01")?.cross(self.direction(side, "middle_03")?).try_normalize()?;
        let hand = self.skeleton.find(&side.bone("hand"))?;
        self.turns[hand] *= side.mirror_turn(about(curl_axis, arm.wrist));
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
        let knee = about(hinge, leg.knee - degrees_between(thigh, calf));
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

fn degrees_between(a: DVec3, b: DVec3) -> f64 {
    a.angle_between(b).to_degrees()
}
