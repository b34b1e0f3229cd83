//! Synthetic bodies from CC0 data: a person's shape, a pose, and one mesh topology shared by all.
//!
//! ```text
//! BodyData ─Person─▶ rest shape ─Skeleton─▶ joints ─Pose─▶ motions ─skin─▶ posed ─Refined─▶ fine skin (49 thousand vertices)
//!    └─outer_skin─▶ closed surface ─Refined─▶ fine skin ─simplify (once, neutral body)─▶ Template: vertices of every body
//! ```

pub mod cloud;
pub mod data;
pub mod joints;
pub mod manifold;
pub mod parts;
pub mod pose;
pub mod quadric;
pub mod refine;
pub mod samples;
pub mod shape_mixture;
pub mod simplify;
pub mod skeleton;
pub mod skinning;
pub mod surface;
pub mod write;

use std::path::Path;

use glam::DVec3;

use data::{BodyData, DataError};
use pose::Pose;
use refine::Refined;
use shape_mixture::Person;
use skeleton::Skeleton;

/// Metres per decimetre.
const METRES: f64 = 0.1;

/// Everything needed to make a body.
pub struct BodyModel {
    data: BodyData,
    /// Closed outer skin, refined once.
    pub skin: Refined,
    /// Part label of each vertex of `skin`, an index into [`parts::PARTS`].
    pub labels: Vec<u32>,
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
        Ok(Self { data, skin, labels })
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
        let labels = vertices.iter().map(|&v| self.labels[v as usize]).collect();
        Ok(Template { vertices, triangles, labels })
    }

    /// A posed person: the vertices of the fine skin in metres, standing on y = 0 with the hips over the origin.
    pub fn body(&self, person: &Person, pose: &Pose) -> Result<Vec<DVec3>, DataError> {
        let rest = person.shape(&self.data)?;
        let skeleton = Skeleton::of_shape(&self.data.bones, &rest);
        let motions = skeleton.motions(&pose.turns(&skeleton));
        let skin = self.skin.positions(&skinning::skin(&rest, &self.data.weights, &motions));
        let hips = skeleton.find("pelvis").map_or(DVec3::ZERO, |b| motions[b].apply(skeleton.bones[b].head));
        let floor = skin.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        Ok(skin.into_iter().map(|p| METRES * (p - DVec3::new(hips.x, floor, hips.z))).collect())
    }
}
