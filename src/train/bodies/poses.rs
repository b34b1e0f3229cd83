//! Poses drawn at random: how people stand, walk, fight, crouch, sit, kneel, bend, and anything in between.

use std::ops::Range;

use rand_chacha::ChaCha8Rng;

use super::chance::{happens, normal, pick_by, uniform};
use super::pose::{Arm, Bend, Leg, Pose, limits};

/// What legs and trunk do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stance {
    /// Feet under the hips.
    Standing,
    /// Legs spread.
    Wide,
    /// Legs together, thighs touching on most people.
    Together,
    /// One leg before the other, both stretched and crossed.
    Crossed,
    /// Walking to running.
    Stride,
    /// A long step with bent knee, hips turned: fencing, fighting.
    Lunge,
    /// One leg kicks.
    Kick,
    /// Deep knee bend.
    Crouch,
    /// As on a chair.
    Sit,
    /// On both knees.
    Kneel,
    /// On one knee.
    HalfKneel,
    /// Trunk forward over stretched legs.
    BendDown,
    /// Any angles within the limits of the joints.
    Free,
}

/// What both arms do; [`Arms::Free`] ones differ from each other.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Arms {
    Down,
    Slanting,
    Level,
    Raised,
    Swing,
    Guard,
    Free,
}

const STANCES: [(f64, Stance); 13] = [
    (14.0, Stance::Standing),
    (7.0, Stance::Wide),
    (5.0, Stance::Together),
    (3.0, Stance::Crossed),
    (13.0, Stance::Stride),
    (13.0, Stance::Lunge),
    (6.0, Stance::Kick),
    (6.0, Stance::Crouch),
    (6.0, Stance::Sit),
    (4.0, Stance::Kneel),
    (4.0, Stance::HalfKneel),
    (7.0, Stance::BendDown),
    (12.0, Stance::Free),
];

impl Pose {
    /// Any pose; limbs may pass through the body, which is for the caller to find out.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        let stance = pick_by(rng, &STANCES);
        Self::in_stance(stance, rng)
    }

    /// A pose with the legs and trunk of `stance` and any arms.
    pub fn in_stance(stance: Stance, rng: &mut ChaCha8Rng) -> Self {
        let mut pose =
            Self { neck: bend(rng, [12.0, 8.0, 22.0]), spine: bend(rng, [9.0, 6.0, 9.0]), ..Self::default() };
        pose.pelvis = bend(rng, [4.0, 3.0, 4.0]);
        pose.legs = [standing_leg(rng), standing_leg(rng)];
        let kind = match stance {
            Stance::Stride if happens(rng, 0.7) => Arms::Swing,
            Stance::Lunge if happens(rng, 0.5) => Arms::Guard,
            _ => pick_by(
                rng,
                &[
                    (2.0, Arms::Down),
                    (1.5, Arms::Slanting),
                    (1.0, Arms::Level),
                    (1.5, Arms::Raised),
                    (0.5, Arms::Swing),
                    (1.0, Arms::Guard),
                    (5.0, Arms::Free),
                ],
            ),
        };
        pose.arms = [arm(kind, rng), arm(kind, rng)];
        if kind == Arms::Swing {
            let [left, right] = &mut pose.arms;
            (left.forward, right.forward) = (uniform(rng, 40.0..90.0), uniform(rng, -95.0..-50.0));
        }
        pose.take(stance, rng);
        if happens(rng, 0.25) {
            // Trunk and head strongly bent or turned, whatever the legs do.
            pose.spine = bend(rng, [25.0, 14.0, 20.0]);
        }
        pose.spine.forward = pose.spine.forward.max(-30.0);
        let pose = pose.within_limits();
        if happens(rng, 0.5) { pose.mirrored() } else { pose }
    }

    fn take(&mut self, stance: Stance, rng: &mut ChaCha8Rng) {
        let mut u = |range: Range<f64>| uniform(rng, range);
        match stance {
            Stance::Standing => {}
            Stance::Wide => self.legs.iter_mut().for_each(|l| l.out = u(15.0..42.0)),
            Stance::Together => {
                for leg in &mut self.legs {
                    *leg = Leg { raise: u(-1.0..2.0), out: u(-3.0..1.5), twist: u(-5.0..12.0), ..Leg::default() };
                }
            }
            Stance::Crossed => {
                self.legs[0] = Leg {
                    raise: u(9.0..22.0),
                    out: u(-15.0..-6.0),
                    twist: u(0.0..25.0),
                    knee: u(0.0..12.0),
                    ankle: None,
                };
                self.legs[1] = Leg { raise: u(-7.0..0.0), out: u(-7.0..0.0), knee: u(0.0..8.0), ..self.legs[1] };
            }
            Stance::Stride => {
                let pace = u(0.4..1.4);
                let (front, back) = (u(18.0..40.0) * pace, u(-24.0..-10.0) * pace);
                self.legs[0] = Leg {
                    raise: front,
                    out: u(0.0..8.0),
                    twist: u(-5.0..15.0),
                    knee: u(0.0..70.0) * pace,
                    ankle: None,
                };
                let ankle = Some(u(-25.0..10.0));
                self.legs[1] =
                    Leg { raise: back, out: u(0.0..8.0), twist: u(-5.0..15.0), knee: u(5.0..85.0) * pace, ankle };
                self.pelvis.turn = u(-16.0..4.0) * pace;
                self.spine.turn = -1.5 * self.pelvis.turn;
                self.spine.forward = u(0.0..15.0) * pace;
            }
            Stance::Lunge => {
                self.legs[0] = Leg {
                    raise: u(25.0..90.0),
                    out: u(0.0..40.0),
                    twist: u(-15.0..45.0),
                    knee: u(25.0..105.0),
                    ankle: None,
                };
                self.legs[1] = Leg {
                    raise: u(-28.0..10.0),
                    out: u(3.0..45.0),
                    twist: u(-10.0..50.0),
                    knee: u(0.0..50.0),
                    ankle: Some(u(-25.0..25.0)),
                };
                self.pelvis = Bend { forward: u(-10.0..22.0), left: u(-10.0..10.0), turn: u(-50.0..50.0) };
                self.spine = Bend { forward: u(-10.0..30.0), left: u(-15.0..15.0), turn: u(-45.0..45.0) };
            }
            Stance::Kick => {
                self.legs[0] = Leg {
                    raise: u(40.0..95.0),
                    out: u(0.0..45.0),
                    twist: u(-10.0..40.0),
                    knee: u(0.0..90.0),
                    ankle: Some(u(-35.0..15.0)),
                };
                self.pelvis = Bend { forward: u(-25.0..8.0), left: u(-15.0..20.0), turn: u(-25.0..25.0) };
            }
            Stance::Crouch => {
                let (raise, knee) = (u(60.0..95.0), u(80.0..130.0));
                self.legs = [0, 1].map(|_| Leg {
                    raise: raise + u(-8.0..8.0),
                    out: u(4.0..40.0),
                    twist: u(-5.0..40.0),
                    knee: knee + u(-8.0..8.0),
                    ankle: None,
                });
                self.spine.forward = u(5.0..50.0);
                self.pelvis.forward = u(-10.0..15.0);
            }
            Stance::Sit => {
                self.legs = [0, 1].map(|_| Leg {
                    raise: u(70.0..95.0),
                    out: u(-2.0..30.0),
                    twist: u(-25.0..35.0),
                    knee: u(20.0..115.0),
                    ankle: Some(u(-20.0..15.0)),
                });
                self.spine.forward = u(-10.0..30.0);
            }
            Stance::Kneel => {
                self.legs = [0, 1].map(|_| Leg {
                    raise: u(-15.0..45.0),
                    out: u(2.0..20.0),
                    twist: u(-25.0..15.0),
                    knee: u(85.0..130.0),
                    ankle: Some(u(-50.0..-10.0)),
                });
                self.spine.forward = u(-10.0..30.0);
            }
            Stance::HalfKneel => {
                self.legs[0] = Leg {
                    raise: u(70.0..95.0),
                    out: u(2.0..25.0),
                    twist: u(-10.0..25.0),
                    knee: u(75.0..110.0),
                    ankle: None,
                };
                self.legs[1] = Leg {
                    raise: u(-15.0..15.0),
                    out: u(2.0..15.0),
                    twist: u(-15.0..15.0),
                    knee: u(75.0..115.0),
                    ankle: Some(u(-45.0..0.0)),
                };
            }
            Stance::BendDown => {
                self.pelvis.forward = u(10.0..60.0);
                self.spine.forward = u(25.0..80.0);
                self.legs.iter_mut().for_each(|l| (l.out, l.knee) = (u(3.0..25.0), u(0.0..45.0)));
            }
            Stance::Free => {
                self.legs = [0, 1].map(|_| Leg {
                    raise: u(-25.0..92.0),
                    out: u(-3.0..48.0),
                    twist: u(-30.0..50.0),
                    knee: u(0.0..128.0),
                    ankle: Some(u(-40.0..20.0)),
                });
                self.pelvis = Bend { forward: u(-20.0..40.0), left: u(-20.0..20.0), turn: u(-40.0..40.0) };
            }
        }
        if self.pelvis.forward > 0.0 && !matches!(stance, Stance::Sit | Stance::Free) {
            // The legs hang from the pelvis: they stay where they are when it tips.
            self.legs.iter_mut().for_each(|l| l.raise += self.pelvis.forward);
        }
    }

    /// Every limited angle moved to the nearest limit.
    fn within_limits(mut self) -> Self {
        let clamp = |x: &mut f64, r: std::ops::RangeInclusive<f64>| *x = x.clamp(*r.start(), *r.end());
        for bend in [&mut self.pelvis, &mut self.spine, &mut self.neck] {
            clamp(&mut bend.forward, limits::BEND);
            // Both ways alike, or the mirrored pose would be beyond them.
            let most = -*limits::BEND.start();
            (bend.left, bend.turn) = (bend.left.clamp(-most, most), bend.turn.clamp(-most, most));
        }
        for arm in &mut self.arms {
            clamp(&mut arm.raise, limits::ARM_RAISE);
            clamp(&mut arm.elbow, limits::ELBOW);
        }
        for leg in &mut self.legs {
            clamp(&mut leg.raise, limits::LEG_RAISE);
            clamp(&mut leg.out, limits::LEG_OUT);
            clamp(&mut leg.knee, limits::KNEE);
        }
        self
    }
}

/// Normal angles with these standard deviations.
fn bend(rng: &mut ChaCha8Rng, [forward, left, turn]: [f64; 3]) -> Bend {
    Bend { forward: forward * normal(rng), left: left * normal(rng), turn: turn * normal(rng) }
}

fn standing_leg(rng: &mut ChaCha8Rng) -> Leg {
    let mut u = |range| uniform(rng, range);
    Leg { raise: u(-5.0..6.0), out: u(2.0..14.0), twist: u(-10.0..25.0), knee: u(0.0..9.0), ankle: None }
}

fn arm(kind: Arms, rng: &mut ChaCha8Rng) -> Arm {
    let mut u = |range: Range<f64>| uniform(rng, range);
    let mut arm = Arm {
        twist: u(-25.0..35.0),
        elbow: u(0.0..30.0),
        pronation: u(-40.0..70.0),
        wrist: u(-15.0..25.0),
        ..Arm::default()
    };
    match kind {
        Arms::Down => (arm.raise, arm.forward) = (u(6.0..24.0), u(-30.0..50.0)),
        Arms::Slanting => (arm.raise, arm.forward) = (u(28.0..60.0), u(-25.0..40.0)),
        Arms::Level => (arm.raise, arm.forward) = (u(70.0..110.0), u(-20.0..40.0)),
        Arms::Raised => (arm.raise, arm.forward, arm.elbow) = (u(115.0..170.0), u(-10.0..70.0), u(0.0..70.0)),
        Arms::Swing => (arm.raise, arm.elbow) = (u(15.0..45.0), u(5.0..110.0)),
        Arms::Guard => (arm.raise, arm.forward, arm.elbow) = (u(25.0..85.0), u(30.0..100.0), u(50.0..132.0)),
        Arms::Free => {
            // Even over the sphere between hanging and nearly up, but for the sector behind and across the body.
            arm.raise = u(-0.95..0.99).acos().to_degrees();
            arm.forward = u(-50.0..115.0);
            arm.elbow = u(0.0..1.0).powf(0.7) * 133.0;
            arm.twist = u(-60.0..80.0);
            arm.pronation = u(-60.0..100.0);
            arm.wrist = u(-45.0..55.0);
        }
    }
    arm.curl = match u(0.0..1.0) {
        x if x < 0.15 => u(40.0..62.0),
        x if x < 0.5 => u(-12.0..5.0),
        _ => u(0.0..28.0),
    };
    arm
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn random_poses_stay_within_the_limits_and_reach_far() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let poses: Vec<Pose> = (0..2000).map(|_| Pose::random(&mut rng)).collect();
        assert!(poses.iter().all(Pose::is_within_limits));
        let some = |f: &dyn Fn(&Pose) -> bool| poses.iter().filter(|p| f(p)).count() > 20;
        assert!(some(&|p| p.arms[0].elbow > 120.0) && some(&|p| p.arms[1].raise > 150.0));
        assert!(some(&|p| p.legs[0].knee > 110.0) && some(&|p| p.legs[1].raise > 85.0));
        assert!(some(&|p| p.spine.forward > 60.0) && some(&|p| p.pelvis.turn.abs() > 35.0));
        assert!(some(&|p| p.legs.iter().all(|l| l.out < 2.0)), "legs together or crossed");
    }

    #[test]
    fn left_and_right_are_alike_on_average() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let front = |p: &Pose| p.legs[0].raise - p.legs[1].raise;
        let mean = (0..4000).map(|_| front(&Pose::random(&mut rng))).sum::<f64>() / 4000.0;
        // Standard deviation about 35 degrees: standard error 0.6.
        assert!(mean.abs() < 2.5, "{mean}");
    }
}
