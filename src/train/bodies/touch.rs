//! Bodies that touch themselves on purpose: a hand or a sole is brought to a chosen place of the skin by searching the angles of its limb.

use std::ops::Range;

use glam::{DQuat, DVec3};
use rand_chacha::ChaCha8Rng;

use super::Rest;
use super::chance::{happens, normal, pick, pick_by, uniform};
use super::data::{BODY_VERTICES, BodyData};
use super::joints::LimbKind;
use super::pose::{Arm, Leg, Pose};
use super::poses::Stance;
use super::reach::Reach;
use super::skeleton::{Motion, Skeleton};

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
            10 => Self::Hands(stand, [Some(*pick(rng, &[Belly, Chest])), Some(*pick(rng, &[Belly, Hip]))]),
            11 => {
                let place = *pick(rng, &[Belly, Chest, Shoulder]);
                Self::Hands(stand, one(rng, place))
            }
            12..=13 => Self::ArmsCrossed,
            14 => Self::Palms,
            15..=16 => Self::Hands(Stance::Together, [Some(ThighSide); 2]),
            17 => {
                // One knee on the ground is out of reach.
                let places = if low == Stance::HalfKneel { &[Thigh][..] } else { &[Thigh, Knee] };
                Self::Hands(low, [Some(*pick(rng, places)); 2])
            }
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
    /// What limbs must not pass through besides.
    pub walls: Vec<Goal>,
}

/// A place to touch: where, and the outward normal there.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    place: DVec3,
    normal: DVec3,
}

/// Spots of a place among which the limb chooses the one it reaches best.
const CHOICES: usize = 6;

impl Skin<'_> {
    /// Spots for the hand of `side` (0 left); none if the body has none there.
    pub fn place(&self, place: Place, side: usize, rng: &mut ChaCha8Rng) -> Vec<Goal> {
        let stature = self.reach.neutral.iter().map(|p| p.y).fold(0.0, f64::max);
        self.some(rng, |part, at| place.holds(side, part, at, at.y / stature))
    }

    /// Inner side of the leg of `side`, from the shank to above the knee.
    pub fn inner_leg(&self, side: usize, rng: &mut ChaCha8Rng) -> Vec<Goal> {
        let stature = self.reach.neutral.iter().map(|p| p.y).fold(0.0, f64::max);
        let axis = if side == 0 { 1.0 } else { -1.0 } * 0.11;
        let spots = |part, at: DVec3| {
            (part == 8 + side || part == 10 + side)
                && (0.12..0.40).contains(&(at.y / stature))
                && (at.x - axis) * axis < -0.002
                && at.z.abs() < 0.09
        };
        self.some(rng, spots)
    }

    fn some(&self, rng: &mut ChaCha8Rng, wanted: impl Fn(usize, DVec3) -> bool) -> Vec<Goal> {
        let spots: Vec<usize> =
            (0..self.places.len()).filter(|&i| wanted(self.parts[i] as usize, self.reach.neutral[i])).collect();
        let goal = |&spot: &usize| Goal { place: self.places[spot], normal: self.normals[spot] };
        (0..CHOICES.min(spots.len())).map(|_| goal(pick(rng, &spots))).collect()
    }

    /// Where palms meet before the chest: goals for the left one on the plane of symmetry, which becomes a wall.
    pub fn before_chest(&mut self, rng: &mut ChaCha8Rng) -> Vec<Goal> {
        let chest = self.place(Place::Chest, 0, rng);
        let before = |c: Goal| DVec3::new(0.0, c.place.y + uniform(rng, -1.5..1.0), c.place.z + uniform(rng, 1.0..3.0));
        let places: Vec<DVec3> = chest.into_iter().map(before).collect();
        let grid = (-6..=6).flat_map(|y| (-6..=6).map(move |z| DVec3::new(0.0, f64::from(y), f64::from(z)) * 0.4));
        let wall = |place| Goal { place, normal: DVec3::X };
        self.walls = grid.flat_map(|to| places.iter().map(move |p| wall(*p + to))).collect();
        places.into_iter().map(wall).collect()
    }
}

/// The part of a limb that touches, and points of it that must stay outside the body.
pub struct Limb {
    side: usize,
    kind: LimbKind,
    bone: usize,
    /// Where it touches on the person at rest, and which way that faces.
    contact: Goal,
    /// Bone, place at rest, and how far from other skin it has to stay on an adult (dm).
    clear: Vec<(usize, DVec3, f64)>,
    /// How much it matters that the skins face each other: palms can, ankles cannot turn soles so far.
    facing: f64,
    /// Stature over an adult's.
    size: f64,
    /// On a hand the curl at which the fingers are straight.
    pub flat: f64,
}

/// Random angles among which the search finds its starts.
const DRAWN: usize = 200;
/// Searches from the best of them.
const STARTS: usize = 3;
/// Steps of each search.
const STEPS: usize = 110;
/// A centimetre and a half on an adult (dm): the distance, and the depth of other points, that cost as much as each other and count 1.
const TOLERANCE: f64 = 0.15;
/// The best angles may cost this much, or the limb is said not to reach.
const ENOUGH: f64 = 2.5;

impl Limb {
    /// The palm of `side` (0 left) of a person at rest.
    pub fn palm(data: &BodyData, rest: &Rest, side: usize) -> Option<Self> {
        let skeleton = &rest.skeleton;
        let bone = |name: &str| skeleton.find(&format!("{name}_{}", ["l", "r"][side]));
        let (hand, knuckle, tip) = (bone("hand")?, bone("middle_01")?, bone("middle_03")?);
        let along = |b: usize| skeleton.bones[b].tail - skeleton.bones[b].head;
        // Fingers are half curled at rest, towards the palm.
        let curl = along(knuckle).cross(along(tip)).try_normalize()?;
        let palm = curl.cross(along(knuckle)).try_normalize()?;
        let middle = skeleton.bones[hand].head.lerp(skeleton.bones[knuckle].head, 0.7);
        let contact = surface(data, &rest.shape, &[hand, knuckle], middle, palm);
        let fore = bone("lowerarm")?;
        let (elbow, wrist) = (skeleton.bones[fore].head, skeleton.bones[hand].head);
        let mut clear = vec![
            (fore, elbow, 0.5),
            (fore, elbow.lerp(wrist, 0.25), 0.48),
            (fore, elbow.lerp(wrist, 0.5), 0.42),
            (fore, elbow.lerp(wrist, 0.75), 0.34),
            (hand, wrist, 0.27),
        ];
        for finger in ["index_03", "middle_03", "pinky_03", "thumb_03"] {
            let b = bone(finger)?;
            clear.push((b, skeleton.bones[b].tail, 0.06));
        }
        let flat = -along(knuckle).angle_between(along(tip)).to_degrees() / 2.0;
        let (kind, size) = (LimbKind::Arm, rest.size());
        Some(Self { side, kind, bone: hand, contact, clear, facing: 3.0, size, flat })
    }

    /// The sole of `side` (0 left).
    pub fn sole(data: &BodyData, rest: &Rest, side: usize) -> Option<Self> {
        let skeleton = &rest.skeleton;
        let bone = |name: &str| skeleton.find(&format!("{name}_{}", ["l", "r"][side]));
        let (foot, ball, shank) = (bone("foot")?, bone("ball")?, bone("calf")?);
        let middle = skeleton.bones[foot].head.lerp(skeleton.bones[ball].head, 0.5);
        let contact = surface(data, &rest.shape, &[foot, ball], middle, DVec3::NEG_Y);
        let (knee, ankle) = (skeleton.bones[shank].head, skeleton.bones[shank].tail);
        let clear = vec![
            (shank, knee, 0.6),
            (shank, knee.lerp(ankle, 0.5), 0.55),
            (shank, ankle, 0.42),
            (ball, skeleton.bones[ball].tail, 0.2),
        ];
        let (kind, size) = (LimbKind::Leg, rest.size());
        Some(Self { side, kind, bone: foot, contact, clear, facing: 1.0, size, flat: 0.0 })
    }

    /// The angles of this limb in `pose` changed so that it touches one of the `goals` with `gap` decimetres left. `None` if the limb does not get there.
    pub fn touch(
        &self,
        pose: &Pose,
        rest: &Rest,
        skin: &Skin,
        goals: &[Goal],
        gap: f64,
        rng: &mut ChaCha8Rng,
    ) -> Option<Pose> {
        let ranges = self.ranges();
        let search = Search { limb: self, pose, skeleton: &rest.skeleton, goals, gap, obstacles: self.obstacles(skin) };
        let mut turns = pose.turns(&rest.skeleton);
        let mut drawn: Vec<(f64, Vec<f64>)> = (0..DRAWN)
            .map(|_| {
                let angles: Vec<f64> = ranges.iter().map(|r| uniform(rng, r.clone())).collect();
                (search.distance(&search.motions(&angles, &mut turns)), angles)
            })
            .collect();
        drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = (f64::INFINITY, Vec::new());
        for (_, mut angles) in drawn.into_iter().take(STARTS) {
            let mut least = search.cost(&angles, &mut turns, f64::INFINITY);
            // A (1 + 1) evolution strategy with the one-fifth rule.
            let mut step = 20.0;
            for _ in 0..STEPS {
                let tried: Vec<f64> =
                    angles.iter().zip(&ranges).map(|(a, r)| (a + step * normal(rng)).clamp(r.start, r.end)).collect();
                let cost = search.cost(&tried, &mut turns, least);
                if cost < least {
                    (least, angles) = (cost, tried);
                    step *= 1.5;
                } else {
                    step = (step * 0.9).max(0.5);
                }
            }
            if least < best.0 {
                best = (least, angles);
            }
            if best.0 < ENOUGH {
                break;
            }
        }
        (best.0 < ENOUGH).then(|| self.bent(pose, &best.1))
    }

    /// Skin that is not the limb's own.
    fn obstacles(&self, skin: &Skin) -> Vec<Goal> {
        let own = match self.kind {
            LimbKind::Arm => [2, 4, 6],
            LimbKind::Leg => [8, 10, 12],
        };
        let own = own.map(|part| part + self.side as u32);
        let others = (0..skin.places.len()).filter(|&i| !own.contains(&skin.parts[i]));
        others
            .map(|i| Goal { place: skin.places[i], normal: skin.normals[i] })
            .chain(skin.walls.iter().copied())
            .collect()
    }

    /// Angles the limb may take.
    fn ranges(&self) -> Vec<Range<f64>> {
        match self.kind {
            LimbKind::Arm => vec![0.0..170.0, -75.0..135.0, -80.0..100.0, 0.0..135.0, -80.0..120.0, -50.0..60.0],
            LimbKind::Leg => vec![5.0..90.0, 0.0..62.0, -10.0..75.0, 60.0..130.0, -50.0..15.0],
        }
    }

    fn bent(&self, pose: &Pose, angles: &[f64]) -> Pose {
        let mut pose = pose.clone();
        match (self.kind, angles) {
            (LimbKind::Arm, &[raise, forward, twist, elbow, pronation, wrist]) => {
                let arm = &mut pose.arms[self.side];
                *arm = Arm { raise, forward, twist, elbow, pronation, wrist, curl: arm.curl };
            }
            (LimbKind::Leg, &[raise, out, twist, knee, ankle]) => {
                pose.legs[self.side] = Leg { raise, out, twist, knee, ankle: Some(ankle) };
            }
            _ => {}
        }
        pose
    }
}

/// What a limb looks for.
struct Search<'a> {
    limb: &'a Limb,
    pose: &'a Pose,
    skeleton: &'a Skeleton,
    goals: &'a [Goal],
    gap: f64,
    obstacles: Vec<Goal>,
}

impl Search<'_> {
    fn motions(&self, angles: &[f64], turns: &mut Vec<DQuat>) -> Vec<Motion> {
        self.limb.bent(self.pose, angles).turn_limb(self.limb.kind, self.limb.side, self.skeleton, turns);
        self.skeleton.motions(turns)
    }

    /// How far the limb is from the goal it is nearest to, and how askew.
    fn distance(&self, motions: &[Motion]) -> f64 {
        let motion = motions[self.limb.bone];
        let (at, normal) = (motion.apply(self.limb.contact.place), motion.rotation * self.limb.contact.normal);
        let to = |goal: &Goal| {
            let off = at.distance(goal.place + self.gap * goal.normal) / (TOLERANCE * self.limb.size);
            off * off + self.limb.facing * (1.0 + normal.dot(goal.normal))
        };
        self.goals.iter().map(to).fold(f64::INFINITY, f64::min)
    }

    /// That, and what other points of the limb lack in distance from the body; infinite once it is more than `bound`.
    fn cost(&self, angles: &[f64], turns: &mut Vec<DQuat>, bound: f64) -> f64 {
        let motions = self.motions(angles, turns);
        let size = self.limb.size;
        let mut cost = self.distance(&motions);
        for &(bone, point, radius) in &self.limb.clear {
            if cost >= bound {
                return f64::INFINITY;
            }
            let p = motions[bone].apply(point);
            let (mut nearest, mut height) = (f64::INFINITY, f64::INFINITY);
            for o in &self.obstacles {
                let between = p - o.place;
                if between.length_squared() < nearest {
                    (nearest, height) = (between.length_squared(), between.dot(o.normal));
                }
            }
            // Far spots do not say which side of them is inside.
            if nearest < (2.0 * size) * (2.0 * size) {
                cost += ((radius * size - height) / (TOLERANCE * size)).max(0.0).powi(2);
            }
        }
        cost
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
