//! Gradients of functions on a shape, in a tangent plane at each point.
//!
//! The operators that DiffusionNet builds its gradient features from (Sharp, Attaiki, Crane & Ovsjanikov 2022, Sec.
//! 3.4). Two departures. On meshes they average the gradients of faces instead of fitting one to the edges around a
//! vertex: no matrix is inverted, so no triangle is bad. On clouds the fit leaves out neighbours on other sheets of
//! surface.

use sprs::{CsMat, TriMat};

use super::frames::Frame;
use super::neighbourhood::Neighbourhood;
use super::normals::{mesh_normals, unit_normal};
use super::quadrics::EdgeFilter;
use crate::progress::{Cancelled, Progress, Stage};
use crate::shape::Shape;
use crate::vector::{cross, dot, minus};

/// Along an axis in which the neighbours of a point spread less than this part of what they spread in all (squares of
/// lengths), the gradient is taken to be 0: they lie on a line, or on other sheets.
const LEAST_SPREAD: f64 = 1e-3;

/// ∇ of functions on n points, as two sparse matrices.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// G₁ and G₂ (n, n each), in 1/unit: the derivatives along the first and the second tangent axis of each point are
    /// G₁f and G₂f. Rows sum to zero, and are empty where no gradient can be told (points without faces, points among
    /// copies of themselves).
    pub along: [CsMat<f64>; 2],
    /// The tangent axes (n), right-handed with the normal; of meshes the normal points to where faces are seen
    /// counter-clockwise, of clouds its sign means nothing.
    pub frames: Vec<Frame>,
}

impl Gradient {
    /// The gradient of a function (n) at each point, along its two tangent axes (n, 2).
    pub fn of(&self, function: &[f64]) -> Vec<[f64; 2]> {
        let derivative = |along: &CsMat<f64>, i: usize| -> f64 {
            along.outer_view(i).map_or(0.0, |row| row.iter().map(|(j, g)| g * function[j]).sum())
        };
        (0..self.frames.len()).map(|i| [derivative(&self.along[0], i), derivative(&self.along[1], i)]).collect()
    }
}

/// The gradient on a shape: of faces where it has them, else of neighbours on the graph of Algorithm 1. As for the
/// Laplacian, all points count, and of the corners of faces that lie at exactly one place the first has the entries.
pub fn gradient(shape: &Shape, progress: &mut Progress) -> Result<Gradient, Cancelled> {
    gradient_around(shape, &Neighbourhood::of(shape.points()), None, progress)
}

/// [`gradient`], where the neighbourhood of the points is known; on a cloud `filter` weakens edges that are known to join what does not belong
/// together.
pub(crate) fn gradient_around(
    shape: &Shape,
    neighbourhood: &Neighbourhood,
    filter: Option<EdgeFilter>,
    progress: &mut Progress,
) -> Result<Gradient, Cancelled> {
    if !shape.faces().is_empty() {
        progress.at(Stage::Laplacian, 0.0)?;
        return Ok(mesh_gradient(shape.points(), &shape.welded_faces()));
    }
    progress.at(Stage::Graph, 0.0)?;
    neighbourhood.neighbours();
    progress.at(Stage::Graph, 0.5)?;
    neighbourhood.refined_graph();
    progress.at(Stage::Laplacian, 0.0)?;
    Ok(cloud_gradient(neighbourhood, filter))
}

/// Mean of the gradients of the faces around each vertex, weighted with their areas, in the tangent plane of the
/// angle-weighted normal.
///
/// Area × gradient of a face is ½ Σ f_i n × e_i with e_i the side opposite corner i: nothing is divided by the area of
/// a single face.
fn mesh_gradient(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Gradient {
    let frames: Vec<Frame> = mesh_normals(points, faces).into_iter().map(Frame::around).collect();
    let mut areas = vec![0.0; points.len()];
    let mut entries: Vec<(u32, u32, [f64; 2])> = Vec::with_capacity(6 * faces.len());
    for face in faces {
        let corners = face.map(|i| points[i as usize]);
        let Some(normal) = unit_normal(corners) else { continue };
        let area = 0.5 * dot(normal, cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])));
        for (at, &i) in face.iter().enumerate() {
            areas[i as usize] += area;
            for of in (0..3).filter(|&of| of != at) {
                let opposite = minus(corners[(of + 2) % 3], corners[(of + 1) % 3]);
                let tilted = cross(normal, opposite).map(|x| 0.5 * x);
                entries.push((i, face[of], frames[i as usize].along(tilted)));
            }
        }
    }
    for (i, _, g) in &mut entries {
        *g = g.map(|x| x / areas[*i as usize]);
    }
    Gradient { along: matrices(points.len(), entries), frames }
}

/// The gradient that explains the differences to the neighbours best (weighted least squares). Weights are those of the
/// Laplacian, exp(−d²/σ_iσ_j), times how far two points agree that they are of one sheet. Neighbours are rolled out to
/// their full distance.
fn cloud_gradient(neighbourhood: &Neighbourhood, filter: Option<EdgeFilter>) -> Gradient {
    let (points, neighbours) = (neighbourhood.points(), neighbourhood.neighbours());
    let (graph, quadrics) = (&neighbourhood.refined_graph().edges, neighbourhood.quadrics());
    let sheets = quadrics.with_filter(filter);
    let n = graph.len();
    let frames: Vec<Frame> = quadrics.normals().into_iter().map(Frame::around).collect();
    let sigma: Vec<f64> = (0..n).map(|i| neighbours.mean_distance_from(i)).collect();
    let mut entries: Vec<(u32, u32, [f64; 2])> = Vec::with_capacity(2 * graph.edge_count());
    let mut row: Vec<(u32, f64, [f64; 2])> = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        row.clear();
        let mut all = 0.0;
        for (&j, &d) in graph.neighbours(i).iter().zip(graph.lengths(i)) {
            let flat = frame.along(minus(points[j as usize], points[i]));
            let length = flat[0].hypot(flat[1]);
            let scale = sigma[i] * sigma[j as usize];
            if length > 0.0 && scale > 0.0 {
                let weight = (-d * d / scale).exp();
                all += weight * d * d;
                row.push((j, weight * sheets.agreement(i as u32, j), flat.map(|x| x * d / length)));
            }
        }
        let moment = |p: usize, q: usize| row.iter().map(|(_, w, u)| w * u[p] * u[q]).sum::<f64>();
        let inverse = truncated_inverse(moment(0, 0), moment(0, 1), moment(1, 1), LEAST_SPREAD * all);
        entries.extend(row.iter().map(|(j, w, u)| {
            let g = [0, 1].map(|p| w * (inverse[p][0] * u[0] + inverse[p][1] * u[1]));
            (i as u32, *j, g)
        }));
    }
    Gradient { along: matrices(n, entries), frames }
}

/// Pseudo-inverse of the symmetric matrix (a b; b c), of which eigenvalues up to `least` count as zero.
fn truncated_inverse(a: f64, b: f64, c: f64, least: f64) -> [[f64; 2]; 2] {
    let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = half.hypot(b);
    // The axis of the larger eigenvalue is at half the angle of (half, b).
    let (sin, cos) = (0.5 * b.atan2(half)).sin_cos();
    let mut inverse = [[0.0; 2]; 2];
    for (eigenvalue, axis) in [(mean + radius, [cos, sin]), (mean - radius, [-sin, cos])] {
        if eigenvalue > least {
            for p in 0..2 {
                for q in 0..2 {
                    inverse[p][q] += axis[p] * axis[q] / eigenvalue;
                }
            }
        }
    }
    inverse
}

/// G₁ and G₂ from entries off the diagonal; several of one place add up, and the diagonal makes rows sum to zero.
fn matrices(n: usize, entries: Vec<(u32, u32, [f64; 2])>) -> [CsMat<f64>; 2] {
    [0, 1].map(|axis| {
        let mut triplets = TriMat::with_capacity((n, n), entries.len() + n);
        let mut diagonal = vec![None; n];
        for &(i, j, g) in entries.iter().filter(|(_, _, g)| *g != [0.0; 2]) {
            triplets.add_triplet(i as usize, j as usize, g[axis]);
            *diagonal[i as usize].get_or_insert(0.0) -= g[axis];
        }
        for (i, value) in diagonal.into_iter().enumerate().filter_map(|(i, value)| Some((i, value?))) {
            triplets.add_triplet(i, i, value);
        }
        triplets.to_csr()
    })
}
