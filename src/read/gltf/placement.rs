//! Where each mesh stands: the nodes of all scenes, walked from their roots, with their transforms multiplied in f64.

use gltf::scene::Transform;
use gltf::{Document, Mesh, Node};

use super::container::GLTF;
use crate::read::error::{Place, ReadError};

/// An affine map: columns of the linear part, and the offset.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    columns: [[f64; 3]; 3],
    offset: [f64; 3],
}

impl Placement {
    const IDENTITY: Self = Self { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], offset: [0.0; 3] };

    /// A node's own transform, `T · R · S` or a matrix.
    fn of(node: &Node) -> Self {
        match node.transform() {
            Transform::Matrix { matrix } => {
                let [a, b, c, d] = matrix.map(|[x, y, z, _]| [x, y, z].map(f64::from));
                Self { columns: [a, b, c], offset: d }
            }
            Transform::Decomposed { translation, rotation, scale } => {
                let [x, y, z, w] = rotation.map(f64::from);
                let turned = [
                    [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
                    [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
                    [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
                ];
                let mut columns = turned;
                for (column, factor) in columns.iter_mut().zip(scale) {
                    *column = column.map(|c| c * f64::from(factor));
                }
                Self { columns, offset: translation.map(f64::from) }
            }
        }
    }

    /// `child` first, then `self`.
    fn after(&self, child: &Self) -> Self {
        let linear = Self { offset: [0.0; 3], ..*self };
        Self { columns: child.columns.map(|c| linear.apply(c)), offset: self.apply(child.offset) }
    }

    /// The point's place in the scene.
    pub fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.columns;
        [0, 1, 2].map(|i| a[i] * x + b[i] * y + c[i] * z + self.offset[i])
    }

    /// Whether triangles turn inside out.
    pub fn mirrors(&self) -> bool {
        let [a, b, c] = self.columns;
        let volume = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        volume < 0.0
    }
}

/// Every mesh of every scene with its placement: parents before children, children in their order, each node once. A file
/// without scenes shows all its root nodes, one without nodes its meshes.
pub(super) fn placed_meshes(document: &Document) -> Result<Vec<(Mesh<'_>, Placement)>, ReadError> {
    if document.nodes().len() == 0 {
        return Ok(document.meshes().map(|mesh| (mesh, Placement::IDENTITY)).collect());
    }
    let mut scenes: Vec<Vec<Node>> = document.scenes().map(|scene| scene.nodes().collect()).collect();
    if scenes.is_empty() {
        let mut is_child = vec![false; document.nodes().len()];
        document.nodes().flat_map(|node| node.children()).for_each(|child| is_child[child.index()] = true);
        scenes.push(document.nodes().filter(|node| !is_child[node.index()]).collect());
    }

    let mut meshes = Vec::new();
    let mut seen_in = vec![None; document.nodes().len()];
    for (scene, roots) in scenes.into_iter().enumerate() {
        let mut waiting: Vec<(Node, Placement)> = roots.into_iter().rev().map(|n| (n, Placement::IDENTITY)).collect();
        while let Some((node, parent)) = waiting.pop() {
            match seen_in[node.index()].replace(scene) {
                None => {}
                Some(earlier) if earlier != scene => continue,
                Some(_) => {
                    let problem = "the node is reached twice; nodes must form a tree".to_owned();
                    return Err(ReadError::Malformed {
                        format: GLTF,
                        problem,
                        at: Place::Object(format!("nodes[{}]", node.index())),
                    });
                }
            }
            let placement = parent.after(&Placement::of(&node));
            meshes.extend(node.mesh().map(|mesh| (mesh, placement)));
            let children: Vec<Node> = node.children().collect();
            waiting.extend(children.into_iter().rev().map(|child| (child, placement)));
        }
    }
    Ok(meshes)
}
