//! Biovision hierarchy files (BVH): a skeleton at rest and how its joints turn in each frame.
//!
//! Read here because the crate for it (`bvh_anim`) has not been touched since 2020; places in frames are not needed and skipped.

use glam::{DQuat, DVec3};

/// A file's joints, every parent before its children.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// The joints.
    pub joints: Vec<Joint>,
    /// For each frame the numbers of all channels.
    frames: Vec<Vec<f64>>,
}

/// A joint of the hierarchy.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// As the file calls it.
    pub name: String,
    /// Index of the parent.
    pub parent: Option<usize>,
    /// Where it is at rest, in the file's unit; y up, z towards where the body looks.
    pub place: DVec3,
    /// For each of its channels the axis it turns about; `None` for one that shifts.
    axes: Vec<Option<DVec3>>,
}

/// The file's axes (z up, looking along −y) to ours (y up, looking along +z).
fn upright(v: DVec3) -> DVec3 {
    DVec3::new(v.x, v.z, -v.y)
}

impl Bvh {
    /// Reads a file's text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut words = text.split_ascii_whitespace();
        let mut next = || words.next().ok_or("ends early");
        let number = |word: &str| word.parse::<f64>().map_err(|_| format!("{word:?} is not a number"));
        let mut joints: Vec<Joint> = Vec::new();
        // Joints whose braces are open; `None` for the end of a limb.
        let mut open: Vec<Option<usize>> = Vec::new();
        loop {
            match next()? {
                "HIERARCHY" | "{" => {}
                "MOTION" => break,
                "ROOT" | "JOINT" => {
                    let parent = open.last().copied().flatten();
                    let joint = Joint { name: next()?.to_owned(), parent, place: DVec3::ZERO, axes: Vec::new() };
                    open.push(Some(joints.len()));
                    joints.push(joint);
                }
                "End" => {
                    next()?;
                    open.push(None);
                }
                "}" => drop(open.pop()),
                "OFFSET" => {
                    let offset = upright(DVec3::new(number(next()?)?, number(next()?)?, number(next()?)?));
                    if let Some(joint) = open.last().copied().flatten() {
                        joints[joint].place = offset + joints[joint].parent.map_or(DVec3::ZERO, |p| joints[p].place);
                    }
                }
                "CHANNELS" => {
                    let joint = open.last().copied().flatten().ok_or("channels without a joint")?;
                    for _ in 0..number(next()?)? as usize {
                        joints[joint].axes.push(match next()? {
                            "Xrotation" => Some(upright(DVec3::X)),
                            "Yrotation" => Some(upright(DVec3::Y)),
                            "Zrotation" => Some(upright(DVec3::Z)),
                            _ => None,
                        });
                    }
                }
                word => return Err(format!("{word:?} is not expected in the hierarchy")),
            }
        }
        let mut values = Vec::new();
        let mut frames = 0;
        while let Ok(word) = next() {
            match word {
                "Frames:" => frames = number(next()?)? as usize,
                // Their spacing in time: `Frame Time: 0.04`.
                "Frame" | "Time:" => {
                    if word == "Time:" {
                        next()?;
                    }
                }
                _ => values.push(number(word)?),
            }
        }
        let channels: usize = joints.iter().map(|j| j.axes.len()).sum();
        if frames == 0 || values.len() != frames * channels {
            return Err(format!("{} numbers for {frames} frames of {channels} channels", values.len()));
        }
        Ok(Self { joints, frames: values.chunks(channels).map(<[f64]>::to_vec).collect() })
    }

    /// Frames in the file, at least one.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// The joint called `name`, if there is one.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// For each joint how far it is turned from rest in a frame, parents included.
    pub fn turned(&self, frame: usize) -> Vec<DQuat> {
        let mut values = self.frames[frame].iter();
        let mut turned: Vec<DQuat> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let mut turn = joint.parent.map_or(DQuat::IDENTITY, |p| turned[p]);
            for (axis, degrees) in joint.axes.iter().zip(values.by_ref()) {
                if let Some(axis) = axis {
                    turn *= DQuat::from_axis_angle(*axis, degrees.to_radians());
                }
            }
            turned.push(turn.normalize());
        }
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELBOW: &str =
        "HIERARCHY ROOT hip { OFFSET 0 0 10 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
        JOINT arm { OFFSET 2 0 3 CHANNELS 3 Xrotation Yrotation Zrotation End Site { OFFSET 1 0 0 } } }
        MOTION Frames: 2 Frame Time: 0.04 0 0 0 0 0 0 0 0 0  1 2 3 90 0 0 0 0 -90";

    #[test]
    fn joints_turn_with_their_parents_in_the_order_of_the_channels() {
        let bvh = Bvh::parse(ELBOW).expect("valid");
        assert_eq!((bvh.frames(), bvh.find("arm"), bvh.find("End")), (2, Some(1), None));
        assert_eq!(bvh.joints[1].place, DVec3::new(2.0, 13.0, 0.0));
        assert!(bvh.turned(0).iter().all(|q| q.is_near_identity()));
        // The hip turns left about the vertical, the arm turns back.
        let [hip, arm] = bvh.turned(1)[..] else { panic!("two joints") };
        assert!((hip * DVec3::X).distance(DVec3::NEG_Z) < 1e-12, "{}", hip * DVec3::X);
        assert!(arm.is_near_identity());
    }

    #[test]
    fn what_is_not_a_motion_is_refused() {
        for (text, why) in [
            ("", "ends early"),
            ("HIERARCHY ROOT hip { OFFSET 0 x 0", "not a number"),
            ("HIERARCHY CHANNELS 3 a b c", "without a joint"),
            ("HIERARCHY ROOT hip { BOX", "not expected"),
            (&ELBOW[..ELBOW.len() - 4], "17 numbers for 2 frames of 9 channels"),
        ] {
            let error = Bvh::parse(text).expect_err(text);
            assert!(error.contains(why), "{error}");
        }
    }
}
