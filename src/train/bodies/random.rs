//! A random person in a random pose that could be: drawn again while the body passes through itself.

use glam::{DQuat, DVec3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::anchors::random_turns;
use super::chance::{happens, uniform};
use super::data::DataError;
use super::pose::{Arm, Pose};
use super::press::press;
use super::reach::Contact;
use super::shape_mixture::Person;
use super::style::Style;
use super::touch::{Gesture, Limb, Place, Skin};
use super::{BodyModel, METRES, Rest, Template};

/// Share of bodies that touch themselves on purpose.
const IN_CONTACT: f64 = 0.3;
/// Share of the others that take their pose from a motion file.
const ANCHORED: f64 = 0.15;
/// Largest share of the spots deep inside another part: eight of two thousand, a crease or two fingertips.
const THROUGH: f64 = 0.004;
/// Smallest share of the spots in contact for a gesture to count: a palm has about 1 %.
const TOUCHING: f64 = 0.006;
/// Gap left between a hand or a sole and what it touches, in decimetres; below 0 it presses on it.
const GAP: std::ops::Range<f64> = -0.1..0.09;
/// Poses tried before the person is given up, too.
const POSES: usize = 10;

/// People tried before another gesture is taken.
const PEOPLE: usize = 4;

/// Where a pose comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseSource {
    /// Any angles within the limits of the joints.
    Free,
    /// A frame of a motion file, varied.
    Motion,
    /// A gesture with which the body touches itself.
    Gesture,
}

/// A body drawn at random.
pub struct RandomBody {
    /// Who.
    pub person: Person,
    /// Doing what: a turn for every bone.
    pub turns: Vec<DQuat>,
    /// Touching itself on purpose, and how.
    pub gesture: Option<Gesture>,
    /// Vertices of the fine skin in metres, standing on y = 0.
    pub skin: Vec<DVec3>,
    /// What the pose does to the body, before flesh gave way.
    pub contact: Contact,
    /// Poses tried, this one included.
    pub tries: usize,
}

impl BodyModel {
    /// The body of a seed: three in ten touch themselves on purpose. The same seed is always the same body.
    pub fn random_body(&self, template: &Template, seed: u64) -> Result<RandomBody, DataError> {
        self.styled_body(template, seed, Style::default())
    }

    /// The body of a seed with proportions of one's own.
    pub fn styled_body(&self, template: &Template, seed: u64, style: Style) -> Result<RandomBody, DataError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let in_contact = happens(&mut rng, IN_CONTACT);
        // Another stream than the body's and the scan's.
        let mut apart = ChaCha8Rng::seed_from_u64(seed);
        apart.set_stream(2);
        let source = match (in_contact, happens(&mut apart, ANCHORED)) {
            (true, _) => PoseSource::Gesture,
            (_, true) => PoseSource::Motion,
            _ => PoseSource::Free,
        };
        self.draw_body(template, source, style, &mut rng)
    }

    /// A body whose pose comes from `source`.
    pub fn draw_body(
        &self,
        template: &Template,
        source: PoseSource,
        style: Style,
        rng: &mut ChaCha8Rng,
    ) -> Result<RandomBody, DataError> {
        let mut tries = 0;
        let mut gesture = None;
        for people in 0.. {
            // Kept for some people, or easy gestures would crowd out the others.
            if source == PoseSource::Gesture && people % PEOPLE == 0 {
                gesture = Some(Gesture::random(rng));
            }
            let person = Person { style, ..Person::random(rng) };
            let rest = self.rest(&person)?;
            for _ in 0..POSES {
                tries += 1;
                let drawn = match (source, gesture) {
                    (_, Some(gesture)) => {
                        self.gesture(template, &rest, gesture, rng).map(|pose| pose.turns(&rest.skeleton))
                    }
                    (PoseSource::Motion, _) => Some(random_turns(&rest.skeleton, rng)),
                    _ => Some(Pose::random(rng).turns(&rest.skeleton)),
                };
                let Some(turns) = drawn else { continue };
                let mut skin = self.posed(&rest, &turns).skin;
                let picked = template.pick(&skin);
                let contact = template.reach.contact(&picked, &template.triangles);
                if contact.through <= THROUGH && (gesture.is_none() || contact.touching >= TOUCHING) {
                    let touching = template.reach.touching(&picked, &template.triangles);
                    press(&mut skin, &self.skin.triangles, &self.labels, &touching);
                    return Ok(RandomBody { person, turns, gesture, skin, contact, tries });
                }
            }
        }
        unreachable!("people are drawn until one is accepted")
    }

    /// A pose with this gesture, if the limbs get there.
    fn gesture(&self, template: &Template, rest: &Rest, gesture: Gesture, rng: &mut ChaCha8Rng) -> Option<Pose> {
        let mut pose = Pose::in_stance(gesture.stance(), rng);
        pose.spine.forward = pose.spine.forward.clamp(-10.0, 35.0);
        let palm = |side| Limb::palm(&self.data, rest, side);
        // Hands lie flat when they lie on something.
        let flat = |pose: &mut Pose, limb: &Limb, side: usize, rng: &mut ChaCha8Rng| {
            pose.arms[side].curl = limb.flat + uniform(rng, -3.0..9.0);
        };
        match gesture {
            Gesture::Legs(_) => Some(pose),
            Gesture::Tree => {
                let side = usize::from(happens(rng, 0.5));
                (pose.legs[1 - side].out, pose.legs[1 - side].raise) =
                    (uniform(rng, -3.0..5.0), uniform(rng, -3.0..4.0));
                let skin = self.skin_of(template, rest, &pose);
                let goals = skin.inner_leg(1 - side, rng);
                let sole = Limb::sole(&self.data, rest, side)?;
                sole.touch(&pose, rest, &skin, &goals, uniform(rng, GAP), rng)
            }
            Gesture::Hands(_, places) => {
                for (side, place) in places.into_iter().enumerate() {
                    let Some(place) = place else { continue };
                    let limb = palm(side)?;
                    flat(&mut pose, &limb, side, rng);
                    let skin = self.skin_of(template, rest, &pose);
                    let goals = skin.place(place, side, rng);
                    pose = limb.touch(&pose, rest, &skin, &goals, uniform(rng, GAP), rng)?;
                }
                Some(pose)
            }
            Gesture::ArmsCrossed => {
                let first = usize::from(happens(rng, 0.5));
                for arm in &mut pose.arms {
                    (arm.raise, arm.forward) = (uniform(rng, 15.0..35.0), uniform(rng, 20.0..60.0));
                    (arm.elbow, arm.twist) = (uniform(rng, 80.0..115.0), uniform(rng, 30.0..60.0));
                }
                for (side, place) in [(first, Place::UpperArm), (1 - first, Place::Forearm)] {
                    let limb = palm(side)?;
                    flat(&mut pose, &limb, side, rng);
                    let place = if happens(rng, 0.5) { place } else { Place::UpperArm };
                    let skin = self.skin_of(template, rest, &pose);
                    let goals = skin.place(place, side, rng);
                    pose = limb.touch(&pose, rest, &skin, &goals, uniform(rng, GAP), rng)?;
                }
                Some(pose)
            }
            Gesture::Palms => {
                for bend in [&mut pose.pelvis, &mut pose.spine] {
                    (bend.left, bend.turn) = (0.0, 0.0);
                }
                let limb = palm(0)?;
                flat(&mut pose, &limb, 0, rng);
                // Out of the way until it mirrors the left one.
                pose.arms[1] = Arm { raise: 60.0, forward: -30.0, ..Arm::default() };
                let mut skin = self.skin_of(template, rest, &pose);
                let goals = skin.before_chest(rng);
                let mut pose = limb.touch(&pose, rest, &skin, &goals, uniform(rng, GAP), rng)?;
                pose.arms[1] = pose.arms[0];
                Some(pose)
            }
        }
    }

    /// The spots of a posed body, in decimetres.
    fn skin_of<'a>(&self, template: &'a Template, rest: &Rest, pose: &Pose) -> Skin<'a> {
        let posed = self.posed(rest, &pose.turns(&rest.skeleton));
        let (places, normals) = template.reach.frames(&template.pick(&posed.skin), &template.triangles);
        let places = places.into_iter().map(|p| p / METRES + posed.origin).collect();
        Skin { reach: &template.reach, parts: &template.reach.parts, places, normals, walls: Vec::new() }
    }
}

impl Rest {
    /// Stature over that of an adult (1.7 m).
    pub(super) fn size(&self) -> f64 {
        let skin = &self.shape[..super::data::BODY_VERTICES.min(self.shape.len())];
        let (low, high) = skin.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.y), h.max(p.y)));
        (high - low) * METRES / 1.7
    }
}
