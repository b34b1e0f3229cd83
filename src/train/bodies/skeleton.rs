//! Joints of one person, and how turning them moves the bones.

use glam::{DQuat, DVec3};

/// One bone of the rig; its ends are means of base-mesh vertices, so they follow the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// `upperarm_l`, `calf_r`, …
    pub name: String,
    /// Index of the parent, always smaller than the bone's own; `None` for the root.
    pub parent: Option<usize>,
    /// Vertices whose mean is the joint the bone turns about.
    pub head: Vec<u32>,
    /// Vertices whose mean is the bone's far end.
    pub tail: Vec<u32>,
}

/// The bones of one rest shape, every parent before its children.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Names, parents, and the two ends of each bone in the unit of the shape.
    pub bones: Vec<RestBone>,
}

/// A bone at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RestBone {
    /// `upperarm_l`, `calf_r`, …
    pub name: String,
    /// Index of the parent.
    pub parent: Option<usize>,
    /// The joint the bone turns about.
    pub head: DVec3,
    /// The far end.
    pub tail: DVec3,
}

/// A rigid motion `x ↦ rotation·x + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Unit quaternion.
    pub rotation: DQuat,
    /// Added after the rotation.
    pub translation: DVec3,
}

impl Motion {
    /// The motion that moves nothing.
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// The image of a point.
    pub fn apply(&self, x: DVec3) -> DVec3 {
        self.rotation * x + self.translation
    }
}

impl Skeleton {
    /// Bone ends as means of `shape`'s vertices.
    pub fn of_shape(bones: &[Bone], shape: &[DVec3]) -> Self {
        let mean = |vertices: &[u32]| {
            vertices.iter().map(|&v| shape[v as usize]).sum::<DVec3>() / vertices.len().max(1) as f64
        };
        let rest =
            |b: &Bone| RestBone { name: b.name.clone(), parent: b.parent, head: mean(&b.head), tail: mean(&b.tail) };
        Self { bones: bones.iter().map(rest).collect() }
    }

    /// The bone called `name`, if there is one.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.bones.iter().position(|b| b.name == name)
    }

    /// Unit vector from head to tail of the bone called `name`.
    pub fn direction(&self, name: &str) -> Option<DVec3> {
        let bone = &self.bones[self.find(name)?];
        (bone.tail - bone.head).try_normalize()
    }

    /// Motions from rest to posed. `turns[b]` turns bone `b` and all below it about its head, in the axes of the rest
    /// pose carried along by the parent; so no bone has axes of its own, and the identity everywhere is the rest pose.
    pub fn motions(&self, turns: &[DQuat]) -> Vec<Motion> {
        let mut motions: Vec<Motion> = Vec::with_capacity(self.bones.len());
        for (bone, &turn) in self.bones.iter().zip(turns) {
            let parent = bone.parent.map_or(Motion::IDENTITY, |p| motions[p]);
            let rotation = (parent.rotation * turn).normalize();
            motions.push(Motion { rotation, translation: parent.apply(bone.head) - rotation * bone.head });
        }
        motions
    }
}
