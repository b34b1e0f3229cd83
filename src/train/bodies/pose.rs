//! Poses as a handful of joint angles, in degrees, the same for every person.
//!
//! Angles say where a limb goes, not how far it turns from the rest pose: `elbow: 0` is a straight arm, `raise: 90` a level
//! one, whatever the rest pose of the rig is. The right side is the left side mirrored.

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
    /// 0 is straight seen from the side; a knock-knee stays one.
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
}
