//! Bodies that touch themselves on purpose: a hand or a sole is brought to a chosen place of the skin by searching the angles of its limb.

use std::ops::Range;

use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use super::chance::{happens, normal, pick, pick_by, uniform};
use super::data::{BODY_VERTICES, BodyData};
use super::pose::{Arm, Leg, Pose};
use super::poses::Stance;
use super::reach::Reach;
use super::skeleton::Skeleton;

/// A way to touch oneself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// The sole of one foot against the other leg, as in the yoga pose.
    Tree,
    /// A hand (left, right) on a place of the body each, or free.
    Hands(Stance, [Option<Place>; 2]),
    /// Each hand on the other arm.
    ArmsCrossed,
    /// Palm against palm.
    Palms,
    /// Only the legs.
    Legs(Stance),
}

/// A place for a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// On its own side.
    Hip,
    /// Front of the trunk, low and high.
    Belly,
    /// The other side's too.
    Chest,
    /// The small of the back.
    Back,
    /// Crown, back and sides.
    Head,
    /// From chin to forehead.
    Face,
    /// Outer side of its own thigh, as when standing to attention.
    ThighSide,
    /// Front of its own thigh.
    Thigh,
    /// Its own knee.
    Knee,
    /// Of the other side.
    Shoulder,
    /// Of the other side.
    UpperArm,
    /// Of the other side.
    Forearm,
}

impl Gesture {
    /// Any gesture.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        use Place::*;
        let stand =
            pick_by(rng, &[(4.0, Stance::Standing), (1.0, Stance::Wide), (1.0, Stance::Stride), (0.7, Stance::Lunge)]);
        let low = pick_by(
            rng,
            &[(1.0, Stance::Crouch), (1.0, Stance::Sit), (1.0, Stance::HalfKneel), (1.0, Stance::BendDown)],
        );
        let one = |rng: &mut ChaCha8Rng, place| {
            if happens(rng, 0.5) { [Some(place), None] } else { [None, Some(place)] }
        };
        match uniform(rng, 0.0..20.0) as u32 {
            0..=3 => Self::Tree,
            4..=5 => Self::Hands(stand, [Some(Hip); 2]),
            6 => Self::Hands(stand, one(rng, Hip)),
            7..=8 => {
                let place = *pick(rng, &[Head, Face]);
                Self::Hands(*pick(rng, &[stand, low]), one(rng, place))
            }
            9 => Self::Hands(stand, [Some(Head); 2]),
            10 => Self::Hands(stand, [Some(*pick(rng, &[Belly, Chest, Back])), Some(*pick(rng, &[Belly, Hip, Back]))]),
            11 => {
                let place = *pick(rng, &[Belly, Chest, Back, Shoulder]);
                Self::Hands(stand, one(rng, place))
            }
            12..=13 => Self::ArmsCrossed,
            14 => Self::Palms,
            15..=16 => Self::Hands(Stance::Together, [Some(ThighSide); 2]),
            17 => Self::Hands(low, [Some(*pick(rng, &[Thigh, Knee])); 2]),
            18 => Self::Legs(Stance::Together),
            _ => Self::Legs(Stance::Crossed),
        }
    }

    /// The pose to start from.
    pub fn stance(self) -> Stance {
        match self {
            Self::Hands(stance, _) | Self::Legs(stance) => stance,
            Self::Tree | Self::ArmsCrossed | Self::Palms => Stance::Standing,
        }
    }
}

impl Place {
    /// Whether a spot lies here for the hand of `side` (0 left). `part` is an index into [`super::parts::PARTS`], `at` the place on the neutral body in
    /// metres, `height` its share of the neutral body's.
    fn holds(self, side: usize, part: usize, at: DVec3, height: f64) -> bool {
        let outward = if side == 0 { at.x } else { -at.x };
        let torso = |low: f64, high: f64| part == 1 && (low..high).contains(&height);
        match self {
            Self::Hip => torso(0.53, 0.64) && outward > 0.10,
            Self::Belly => torso(0.55, 0.68) && at.z > 0.04 && outward > -0.05,
            Self::Chest => torso(0.68, 0.79) && at.z > 0.03,
            Self::Back => torso(0.53, 0.66) && at.z < -0.05 && outward > -0.05,
            Self::Head => part == 0 && height > 0.92 && outward > -0.04 && at.z < 0.07,
            Self::Face => part == 0 && height > 0.87 && outward > -0.03 && at.z > 0.05,
            Self::ThighSide => part == 8 + side && height > 0.38 && outward > 0.15,
            Self::Thigh => part == 8 + side && (0.32..0.44).contains(&height) && at.z > 0.02,
            Self::Knee => (part == 8 + side || part == 10 + side) && (0.25..0.32).contains(&height) && at.z > 0.0,
            Self::Shoulder => (part == 1 || part == 3 - side) && (0.76..0.84).contains(&height) && outward < -0.1,
            Self::UpperArm => part == 3 - side,
            Self::Forearm => part == 5 - side,
        }
    }
}

/// The posed skin that a limb is to touch and not to pass through, in the axes and the unit of [`Skeleton::motions`] (decimetres).
pub struct Skin<'a> {
    /// Spots on the body.
    pub reach: &'a Reach,
    /// Part of each spot.
    pub parts: &'a [u32],
    /// Place of each spot.
    pub places: Vec<DVec3>,
    /// Outward unit normal of each spot.
    pub normals: Vec<DVec3>,
}

/// A place to touch: where, and the outward normal there.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    place: DVec3,
    normal: DVec3,
}

impl Skin<'_> {
    /// A spot for the hand of `side` (0 left), if the body has one there.
    pub fn place(&self, place: Place, side: usize, rng: &mut ChaCha8Rng) -> Option<Goal> {
        let stature = self.reach.neutral.iter().map(|p| p.y).fold(0.0, f64::max);
        self.spot(rng, |part, at| place.holds(side, part, at, at.y / stature))
    }

    /// Inner side of the leg of `side`, from the shank to above the knee.
    pub fn inner_leg(&self, side: usize, rng: &mut ChaCha8Rng) -> Option<Goal> {
        let stature = self.reach.neutral.iter().map(|p| p.y).fold(0.0, f64::max);
        let axis = if side == 0 { 1.0 } else { -1.0 } * 0.11;
        let spots = |part, at: DVec3| {
            (part == 8 + side || part == 10 + side)
                && (0.12..0.40).contains(&(at.y / stature))
                && (at.x - axis) * axis < -0.002
                && at.z.abs() < 0.09
        };
        self.spot(rng, spots)
    }

    fn spot(&self, rng: &mut ChaCha8Rng, wanted: impl Fn(usize, DVec3) -> bool) -> Option<Goal> {
        let spots: Vec<usize> =
            (0..self.places.len()).filter(|&i| wanted(self.parts[i] as usize, self.reach.neutral[i])).collect();
        let &spot = (!spots.is_empty()).then(|| pick(rng, &spots))?;
        Some(Goal { place: self.places[spot], normal: self.normals[spot] })
    }

    /// A plane between the palms before the chest: for the left hand, which the right one mirrors.
    pub fn before_chest(&self, rng: &mut ChaCha8Rng) -> Option<Goal> {
        let chest = self.place(Place::Chest, 0, rng)?.place;
        let place = DVec3::new(0.0, chest.y + uniform(rng, -1.5..1.0), chest.z + uniform(rng, 1.0..3.0));
        Some(Goal { place, normal: DVec3::X })
    }
}

/// The part of a limb that touches, and points of it that must stay outside the body.
pub struct Limb {
    side: usize,
    is_arm: bool,
    bone: usize,
    /// Where it touches on the person at rest, and which way that faces.
    contact: Goal,
    /// Bone, place at rest, and how far from other skin it has to stay.
    clear: Vec<(usize, DVec3, f64)>,
}

/// Search steps per limb.
const STEPS: usize = 90;
/// Random angles the search starts from.
const STARTS: usize = 30;

impl Limb {
    /// The palm of `side` (0 left) of a person whose rest vertices are `rest`.
    pub fn palm(data: &BodyData, rest: &[DVec3], skeleton: &Skeleton, side: usize) -> Option<Self> {
        let bone = |name: &str| skeleton.find(&format!("{name}_{}", ["l", "r"][side]));
        let (hand, knuckle, tip) = (bone("hand")?, bone("middle_01")?, bone("middle_03")?);
        let along = |b: usize| skeleton.bones[b].tail - skeleton.bones[b].head;
        // Fingers are half curled at rest, towards the palm.
        let curl = along(knuckle).cross(along(tip)).try_normalize()?;
        let palm = curl.cross(along(knuckle)).try_normalize()?;
        let middle = skeleton.bones[hand].head.lerp(skeleton.bones[knuckle].head, 0.7);
        let contact = surface(data, rest, &[hand, knuckle], middle, palm);
        let fore = bone("lowerarm")?;
        let (elbow, wrist) = (skeleton.bones[fore].head, skeleton.bones[hand].head);
        let clear = vec![
            (fore, elbow, 0.45),
            (fore, elbow.lerp(wrist, 0.4), 0.42),
            (fore, elbow.lerp(wrist, 0.75), 0.33),
            (hand, wrist, 0.25),
            (tip, skeleton.bones[tip].tail, 0.08),
        ];
        Some(Self { side, is_arm: true, bone: hand, contact, clear })
    }

    /// The sole of `side` (0 left).
    pub fn sole(data: &BodyData, rest: &[DVec3], skeleton: &Skeleton, side: usize) -> Option<Self> {
        let bone = |name: &str| skeleton.find(&format!("{name}_{}", ["l", "r"][side]));
        let (foot, ball, shank) = (bone("foot")?, bone("ball")?, bone("calf")?);
        let middle = skeleton.bones[foot].head.lerp(skeleton.bones[ball].head, 0.5);
        let contact = surface(data, rest, &[foot, ball], middle, DVec3::NEG_Y);
        let (knee, ankle) = (skeleton.bones[shank].head, skeleton.bones[shank].tail);
        let clear = vec![
            (shank, knee, 0.55),
            (shank, knee.lerp(ankle, 0.5), 0.5),
            (shank, ankle, 0.4),
            (ball, skeleton.bones[ball].tail, 0.15),
        ];
        Some(Self { side, is_arm: false, bone: foot, contact, clear })
    }

    /// The angles of this limb in `pose` changed so that it touches `goal` with `gap` decimetres left, on a body `size` times an adult's. `None` if the limb does not
    /// get there.
    pub fn touch(
        &self,
        pose: &Pose,
        skeleton: &Skeleton,
        skin: &Skin,
        goal: Goal,
        gap: f64,
        size: f64,
        rng: &mut ChaCha8Rng,
    ) -> Option<Pose> {
        let ranges = self.ranges();
        let own: &[u32] = &if self.is_arm {
            [2, 4, 6].map(|p| p + self.side as u32)
        } else {
            [8, 10, 12].map(|p| p + self.side as u32)
        };
        let others: Vec<usize> = (0..skin.places.len()).filter(|&i| !own.contains(&skin.parts[i])).collect();
        let target = goal.place + gap * goal.normal;
        let cost = |angles: &[f64]| {
            let motions = skeleton.motions(&self.bent(pose, angles).turns(skeleton));
            let at = motions[self.bone].apply(self.contact.place);
            let facing = (motions[self.bone].rotation * self.contact.normal).dot(goal.normal);
            let mut cost = (at.distance(target) / (0.15 * size)).powi(2) + 3.0 * (1.0 + facing);
            for &(bone, point, radius) in &self.clear {
                let p = motions[bone].apply(point);
                let near = |&&i: &&usize| p.distance_squared(skin.places[i]);
                if let Some(&i) = others.iter().min_by(|a, b| near(a).total_cmp(&near(b))) {
                    let between = p - skin.places[i];
                    // Far spots do not say which side of them is inside.
                    if between.length() < 2.0 * size {
                        cost += ((radius * size - between.dot(skin.normals[i])) / (0.15 * size)).max(0.0).powi(2);
                    }
                }
            }
            cost
        };
        let drawn = (0..STARTS).map(|_| ranges.iter().map(|r| uniform(rng, r.clone())).collect::<Vec<f64>>());
        let drawn: Vec<Vec<f64>> = drawn.collect();
        let (mut best, mut angles) = (f64::INFINITY, Vec::new());
        for start in drawn {
            let c = cost(&start);
            if c < best {
                (best, angles) = (c, start);
            }
        }
        // A (1 + 1) evolution strategy with the one-fifth rule.
        let mut step = 25.0;
        for _ in 0..STEPS {
            let tried: Vec<f64> =
                angles.iter().zip(&ranges).map(|(a, r)| (a + step * normal(rng)).clamp(r.start, r.end)).collect();
            let c = cost(&tried);
            if c < best {
                (best, angles) = (c, tried);
                step *= 1.5;
            } else {
                step = (step * 0.9).max(0.5);
            }
        }
        (best < 4.0).then(|| self.bent(pose, &angles))
    }

    /// Angles the limb may take.
    fn ranges(&self) -> Vec<Range<f64>> {
        if self.is_arm {
            vec![0.0..170.0, -75.0..135.0, -80.0..100.0, 0.0..135.0, -80.0..120.0, -50.0..60.0]
        } else {
            vec![5.0..90.0, 0.0..50.0, -10.0..85.0, 60.0..130.0, -50.0..15.0]
        }
    }

    fn bent(&self, pose: &Pose, angles: &[f64]) -> Pose {
        let mut pose = pose.clone();
        match (self.is_arm, angles) {
            (true, &[raise, forward, twist, elbow, pronation, wrist]) => {
                let arm = &mut pose.arms[self.side];
                *arm = Arm { raise, forward, twist, elbow, pronation, wrist, curl: arm.curl };
            }
            (false, &[raise, out, twist, knee, ankle]) => {
                pose.legs[self.side] = Leg { raise, out, twist, knee, ankle: Some(ankle) };
            }
            _ => {}
        }
        pose
    }
}

/// The skin of `bones` outermost along `normal` near the line through `middle`.
fn surface(data: &BodyData, rest: &[DVec3], bones: &[usize], middle: DVec3, normal: DVec3) -> Goal {
    let rows = data.weights.rows().iter().zip(rest).take(BODY_VERTICES);
    let near = rows.filter(|(row, p)| {
        let between = **p - middle;
        bones.contains(&row[0].0) && (between - between.dot(normal) * normal).length() < 0.3
    });
    let height = near.map(|(_, p)| (*p - middle).dot(normal)).fold(0.0, f64::max);
    Goal { place: middle + height * normal, normal }
}
