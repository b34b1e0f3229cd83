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
    pub const IDENTITY: Self = Self { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], offset: [0.0; 3] };

    /// A node's own transform, `T · R · S` or a matrix.
    fn of(node: &Node) -> Self {
        match node.transform() {
            Transform::Matrix { matrix } => Self::from_matrix(matrix),
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

    /// From a matrix by columns, whose last row is taken for 0, 0, 0, 1.
    pub fn from_matrix(matrix: [[f32; 4]; 4]) -> Self {
        let [a, b, c, d] = matrix.map(|[x, y, z, _]| [x, y, z].map(f64::from));
        Self { columns: [a, b, c], offset: d }
    }

    /// The weighted sum of maps.
    pub fn blend(parts: impl Iterator<Item = (f64, Self)>) -> Self {
        let mut sum = Self { columns: [[0.0; 3]; 3], offset: [0.0; 3] };
        for (weight, part) in parts {
            let numbers = part.columns.as_flattened().iter().chain(&part.offset);
            let sums = sum.columns.as_flattened_mut().iter_mut().chain(&mut sum.offset);
            sums.zip(numbers).for_each(|(sum, number)| *sum += weight * number);
        }
        sum
    }

    /// `child` first, then `self`.
    pub fn after(&self, child: &Self) -> Self {
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

/// A mesh in the scene.
pub(super) struct Placed<'a> {
    pub mesh: Mesh<'a>,
    /// The node that shows it; none in a file without nodes.
    pub node: Option<Node<'a>>,
    /// Where that node stands.
    pub placement: Placement,
}

/// Every mesh of every scene with its placement: parents before children, children in their order, each node once. A file
/// without scenes shows all its root nodes, one without nodes its meshes.
pub(super) fn placed_meshes(document: &Document) -> Result<Vec<Placed<'_>>, ReadError> {
    if document.nodes().len() == 0 {
        let placed = |mesh| Placed { mesh, node: None, placement: Placement::IDENTITY };
        return Ok(document.meshes().map(placed).collect());
    }
    let count = document.nodes().filter(|node| node.mesh().is_some()).count();
    let (reached_in, waiting) = (vec![None; document.nodes().len()], Vec::new());
    let mut walk = Walk { reached_in, waiting, meshes: Vec::with_capacity(count) };
    for scene in document.scenes() {
        walk.through(scene.index(), scene.nodes())?;
    }
    if document.scenes().len() == 0 {
        walk.through(0, roots(document).into_iter())?;
    }
    Ok(walk.meshes)
}

/// A walk through the nodes of scenes.
struct Walk<'a> {
    /// The last scene in which each node was reached. None waits twice, however often it is listed.
    reached_in: Vec<Option<usize>>,
    /// Nodes with the placements of their parents, the next one last.
    waiting: Vec<(Node<'a>, Placement)>,
    meshes: Vec<Placed<'a>>,
}

impl<'a> Walk<'a> {
    fn through(&mut self, scene: usize, roots: impl Iterator<Item = Node<'a>>) -> Result<(), ReadError> {
        self.reach(scene, roots, Placement::IDENTITY)?;
        while let Some((node, parent)) = self.waiting.pop() {
            let placement = parent.after(&Placement::of(&node));
            self.reach(scene, node.children(), placement)?;
            self.meshes.extend(node.mesh().map(|mesh| Placed { mesh, node: Some(node), placement }));
        }
        Ok(())
    }

    fn reach(
        &mut self,
        scene: usize,
        nodes: impl Iterator<Item = Node<'a>>,
        parent: Placement,
    ) -> Result<(), ReadError> {
        let from = self.waiting.len();
        for node in nodes {
            match self.reached_in[node.index()].replace(scene) {
                None => self.waiting.push((node, parent)),
                Some(earlier) if earlier != scene => {}
                Some(_) => {
                    let problem = "the node is reached twice; nodes must form a tree".to_owned();
                    let at = Place::Object(format!("nodes[{}]", node.index()));
                    return Err(ReadError::Malformed { format: GLTF, problem, at });
                }
            }
        }
        self.waiting[from..].reverse();
        Ok(())
    }
}

/// Where every node stands, in a scene or not; none for nodes that go round in a circle.
pub(super) fn placements(document: &Document) -> Vec<Option<Placement>> {
    let mut placements = vec![None; document.nodes().len()];
    let mut reached = vec![false; document.nodes().len()];
    let mut waiting: Vec<(Node, Placement)> =
        roots(document).into_iter().map(|node| (node, Placement::IDENTITY)).collect();
    while let Some((node, parent)) = waiting.pop() {
        let placement = parent.after(&Placement::of(&node));
        placements[node.index()] = Some(placement);
        let children = node.children().filter(|child| !std::mem::replace(&mut reached[child.index()], true));
        waiting.extend(children.map(|child| (child, placement)));
    }
    placements
}

/// Nodes that are no child of another.
fn roots(document: &Document) -> Vec<Node<'_>> {
    let mut is_child = vec![false; document.nodes().len()];
    document.nodes().flat_map(|node| node.children()).for_each(|child| is_child[child.index()] = true);
    document.nodes().filter(|node| !is_child[node.index()]).collect()
}
