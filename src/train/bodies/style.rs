//! Proportions of drawn characters: a large head, large hands and feet, short legs.

use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::chance::{happens, uniform};
use super::skeleton::Skeleton;
use super::skinning::Weights;

/// How much larger than a person's some parts of a body are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// The head without the neck.
    pub head: f64,
    /// Hands.
    pub hands: f64,
    /// Feet.
    pub feet: f64,
    /// The length of the legs.
    pub legs: f64,
}

impl Default for Style {
    /// A person's.
    fn default() -> Self {
        Self { head: 1.0, hands: 1.0, feet: 1.0, legs: 1.0 }
    }
}

impl Style {
    /// Of the body of a seed: a drawn one for a `share` of the seeds. Whoever is not drawn is the person whom the seed gives without this.
    pub fn of_seed(seed: u64, share: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // Another stream than those of the body, its pose and its scan.
        rng.set_stream(3);
        if !happens(&mut rng, share) {
            return Self::default();
        }
        let mut drawn = |range: std::ops::Range<f64>| uniform(&mut rng, range);
        Self { head: drawn(1.2..3.2), hands: drawn(0.9..1.9), feet: drawn(0.9..1.7), legs: drawn(0.5..1.05) }
    }

    /// The person with these proportions.
    pub(super) fn applied(&self, shape: &mut [DVec3], skeleton: &mut Skeleton, weights: &Weights) {
        if *self == Self::default() {
            return;
        }
        let rest = &mut (shape, skeleton);
        for side in ["_l", "_r"] {
            let named = |bone: &str| format!("{bone}{side}");
            let leg = ["thigh", "calf", "foot", "ball"].map(named);
            stretched(
                rest,
                weights,
                &named("thigh"),
                |bone| leg.iter().any(|l| l == bone),
                DVec3::new(1.0, self.legs, 1.0),
            );
            let foot = ["foot", "ball"].map(named);
            stretched(rest, weights, &named("foot"), |bone| foot.iter().any(|f| f == bone), DVec3::splat(self.feet));
            let hand = |bone: &str| {
                bone.ends_with(side)
                    && ["hand", "thumb", "index", "middle", "ring", "pinky"].iter().any(|of| bone.starts_with(of))
            };
            stretched(rest, weights, &named("hand"), hand, DVec3::splat(self.hands));
        }
        stretched(rest, weights, "head", |bone| bone == "head", DVec3::splat(self.head));
    }
}

/// Scales what bones move about the joint of the one called `about`.
fn stretched(
    (shape, skeleton): &mut (&mut [DVec3], &mut Skeleton),
    weights: &Weights,
    about: &str,
    moves: impl Fn(&str) -> bool,
    scale: DVec3,
) {
    let Some(joint) = skeleton.find(about).map(|bone| skeleton.bones[bone].head) else { return };
    let of_bone: Vec<f64> = skeleton.bones.iter().map(|bone| f64::from(u8::from(moves(&bone.name)))).collect();
    let moved = |x: DVec3, weight: f64| joint + (x - joint) * (DVec3::ONE + (scale - DVec3::ONE) * weight);
    for (x, row) in shape.iter_mut().zip(weights.rows()) {
        *x = moved(*x, row.iter().map(|&(bone, weight)| weight * of_bone[bone]).sum());
    }
    for (bone, weight) in skeleton.bones.iter_mut().zip(of_bone) {
        (bone.head, bone.tail) = (moved(bone.head, weight), moved(bone.tail, weight));
    }
}
