//! Synthetic bodies from CC0 data: a person's shape, a pose, and one mesh topology shared by all.
//!
//! ```text
//! BodyData ─Person─▶ rest shape ─Skeleton─▶ joints ─Pose─▶ motions ─skin─▶ posed ─Refined─▶ fine skin (49 thousand vertices)
//!    └─outer_skin─▶ closed surface ─Refined─▶ fine skin ─simplify (once, neutral body)─▶ Template: vertices of every body
//!
//! seed ─random─▶ person, pose (drawn again while it passes through itself) ─▶ fine skin ─scan─▶ Scan (and, apart from it, its Truth)
//! ```

pub mod anchors;
pub mod avatar;
pub mod avatars;
pub mod bvh;
pub mod camera;
pub mod chance;
pub mod cloud;
pub mod data;
pub mod held_out;
pub mod joints;
pub mod layout;
pub mod manifold;
pub mod parts;
pub mod people;
pub mod pieces;
pub mod pose;
pub mod poses;
pub mod press;
pub mod quadric;
pub mod random;
pub mod reach;
pub mod refine;
pub mod samples;
pub mod sampling;
pub mod scan;
pub mod scene;
pub mod scenes;
pub mod shape_mixture;
pub mod sheet;
pub mod shell;
pub mod simplify;
pub mod skeleton;
pub mod skinning;
pub mod skirt;
pub mod style;
pub mod surface;
pub mod things;
pub mod touch;
pub mod trinkets;
pub mod wardrobe;
pub mod write;

use std::path::Path;

use glam::{DQuat, DVec3};

use data::{BodyData, DataError};
use pose::Pose;
use reach::Reach;
use refine::Refined;
use shape_mixture::Person;
use skeleton::Skeleton;

use crate::shape::nearest_samples;

/// Metres per decimetre.
const METRES: f64 = 0.1;

/// Everything needed to make a body.
pub struct BodyModel {
    data: BodyData,
    /// Closed outer skin, refined once.
    pub skin: Refined,
    /// Part label of each vertex of `skin`, an index into [`parts::PARTS`].
    pub labels: Vec<u32>,
    /// For each vertex of `skin` the one at its mirror image on the symmetric base mesh.
    pub mirror: Vec<u32>,
}

/// The mesh all bodies share: index `i` is the same body point in each of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// Vertex of the fine skin behind each template vertex.
    pub vertices: Vec<u32>,
    /// Triangles over template vertices, wound outwards.
    pub triangles: Vec<[u32; 3]>,
    /// Part label of each template vertex.
    pub labels: Vec<u32>,
    /// Spots of the template that tell whether a pose touches or passes through itself.
    pub reach: Reach,
}

/// A person before any pose.
pub struct Rest {
    /// Vertices of the base mesh in decimetres.
    pub shape: Vec<DVec3>,
    /// The bones inside.
    pub skeleton: Skeleton,
}

/// A posed person.
pub struct Posed {
    /// Vertices of the fine skin in metres, standing on y = 0 with the hips over the origin.
    pub skin: Vec<DVec3>,
    /// Where that origin lies, in decimetres and the axes of [`Skeleton::motions`].
    pub origin: DVec3,
}

impl Template {
    /// The template's vertices out of all `fine` ones.
    pub fn pick(&self, fine: &[DVec3]) -> Vec<DVec3> {
        self.vertices.iter().map(|&v| fine[v as usize]).collect()
    }
}

impl BodyModel {
    /// Reads the data folder and finds the outer skin.
    pub fn load(root: &Path) -> Result<Self, DataError> {
        let data = BodyData::load(root)?;
        let skin = Refined::of_mesh(&surface::outer_skin(&data));
        if !manifold::is_closed_manifold(skin.stencils.len(), &skin.triangles) {
            let message = "the outer skin of the base mesh is not one closed surface".to_owned();
            return Err(DataError::Content { path: root.to_owned(), message });
        }
        let labels = parts::labels(&data.bones, &data.weights.refined(&skin.stencils));
        let mirror = mirror_images(&skin.positions(&data.base));
        Ok(Self { data, skin, labels, mirror })
    }

    /// Simplifies the neutral body to `count` vertices, finer on the head and finest on hands and feet, which need it.
    pub fn template(&self, count: usize) -> Result<Template, DataError> {
        let neutral = self.skin.positions(&Person::default().shape(&self.data)?);
        let wanted = |label: &u32| match parts::PARTS[*label as usize] {
            "head" => 0.75,
            "left hand" | "right hand" => 0.55,
            "left foot" | "right foot" => 0.8,
            _ => 1.0,
        };
        let size: Vec<f64> = self.labels.iter().map(wanted).collect();
        let (vertices, triangles) = simplify::simplify(&neutral, &self.skin.triangles, &size, count);
        let labels = vertices.iter().map(|&v| self.labels[v as usize]).collect::<Vec<_>>();
        let metres = placed(&neutral, DVec3::new(0.0, lowest(&neutral), 0.0));
        let metres: Vec<DVec3> = vertices.iter().map(|&v| metres[v as usize]).collect();
        let reach = Reach::new(&metres, &triangles, &labels);
        Ok(Template { vertices, triangles, labels, reach })
    }

    /// A posed person: the vertices of the fine skin in metres, standing on y = 0 with the hips over the origin.
    pub fn body(&self, person: &Person, pose: &Pose) -> Result<Vec<DVec3>, DataError> {
        let rest = self.rest(person)?;
        Ok(self.posed(&rest, &pose.turns(&rest.skeleton)).skin)
    }

    /// A person before any pose.
    pub fn rest(&self, person: &Person) -> Result<Rest, DataError> {
        let shape = person.shape(&self.data)?;
        let mut rest = Rest { skeleton: Skeleton::of_shape(&self.data.bones, &shape), shape };
        person.style.applied(&mut rest.shape, &mut rest.skeleton, &self.data.weights);
        Ok(rest)
    }

    /// A person with every bone turned as [`Skeleton::motions`] says.
    pub fn posed(&self, rest: &Rest, turns: &[DQuat]) -> Posed {
        let motions = rest.skeleton.motions(turns);
        let skin = self.skin.positions(&skinning::skin(&rest.shape, &self.data.weights, &motions));
        let hips = rest.skeleton.find("pelvis").map_or(DVec3::ZERO, |b| motions[b].apply(rest.skeleton.bones[b].head));
        let origin = DVec3::new(hips.x, lowest(&skin), hips.z);
        Posed { skin: placed(&skin, origin), origin }
    }
}

fn lowest(points: &[DVec3]) -> f64 {
    points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min)
}

/// Decimetres from `origin` to metres.
fn placed(points: &[DVec3], origin: DVec3) -> Vec<DVec3> {
    points.iter().map(|&p| METRES * (p - origin)).collect()
}

/// For each of the points of a symmetric body the one nearest to its image in the plane x = 0.
fn mirror_images(points: &[DVec3]) -> Vec<u32> {
    let all: Vec<[f64; 3]> = points.iter().map(DVec3::to_array).collect();
    let images: Vec<[f64; 3]> = all.iter().map(|&[x, y, z]| [-x, y, z]).collect();
    let rows: Vec<u32> = (0..all.len() as u32).collect();
    nearest_samples(&[&all[..], &images[..]].concat(), &rows).split_off(all.len())
}
