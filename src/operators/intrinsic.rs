//! The tufted intrinsic triangulation: any triangle soup made into a manifold and flipped until Delaunay.
//!
//! Each triangle gets a front and a back; around every edge the front of one sheet is glued to the back of the next, so
//! that the result is a closed, oriented manifold whatever the input (Sharp & Crane, "A Laplacian for Nonmanifold
//! Triangle Meshes", 2020, Sec. 3). Only edge lengths live on it. Intrinsic Delaunay flips then make all cotangent
//! weights non-negative.

use crate::vector::{cross, dot, minus, norm, squared_distance};

/// One of the three sides of a triangle: side s of face f runs from its vertex s to vertex s + 1 (mod 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Side {
    face: u32,
    side: u8,
}

/// A closed oriented triangulation with lengths instead of positions; every surface point is covered twice.
pub(super) struct TuftedCover {
    vertices: Vec<[u32; 3]>,
    lengths: Vec<[f64; 3]>,
    twin: Vec<[Side; 3]>,
}

/// Lengthening of all edges, relative to the mean, that guarantees triangle inequalities (Sharp & Crane 2020, Sec.
/// 4.5).
const MOLLIFICATION: f64 = 1e-5;
/// An edge is flipped when its cotangent weight is below this: far under any weight that matters, and over the rounding
/// of f32 coordinates, so that the two diagonals of a symmetric quadrilateral are not a toss-up. The value of
/// geometry-central, and so of robust_laplacian.
const DELAUNAY_TOLERANCE: f64 = -1e-6;

impl TuftedCover {
    pub(super) fn new(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Self {
        let mut lengths: Vec<[f64; 3]> = faces
            .iter()
            .map(|f| {
                std::array::from_fn(|s| squared_distance(points[f[s] as usize], points[f[(s + 1) % 3] as usize]).sqrt())
            })
            .collect();
        let m = faces.len();
        let mut sides: Vec<((u32, u32), Side)> = Vec::with_capacity(3 * m);
        for (f, face) in faces.iter().enumerate() {
            for s in 0..3 {
                let (a, b) = (face[s], face[(s + 1) % 3]);
                sides.push(((a.min(b), a.max(b)), Side { face: f as u32, side: s as u8 }));
            }
        }
        sides.sort_unstable_by_key(|&(edge, side)| (edge, side.face, side.side));
        let (sum, edges) = sides.chunk_by(|x, y| x.0 == y.0).fold((0.0, 0_usize), |(sum, edges), of| {
            (sum + lengths[of[0].1.face as usize][of[0].1.side as usize], edges + 1)
        });
        mollify(&mut lengths, sum / edges.max(1) as f64);

        // Fronts are faces 0..m; backs are m..2m with the vertices reversed.
        let mut vertices = faces.to_vec();
        vertices.extend(faces.iter().map(|f| [f[0], f[2], f[1]]));
        let mut all_lengths = lengths.clone();
        all_lengths.extend(lengths.iter().map(|l| [l[2], l[1], l[0]]));
        let nowhere = Side { face: u32::MAX, side: 0 };
        let mut cover = Self { vertices, lengths: all_lengths, twin: vec![[nowhere; 3]; 2 * m] };

        let mut around = Vec::new();
        for of_edge in sides.chunk_by(|x, y| x.0 == y.0) {
            let (a, b) = of_edge[0].0;
            around.clear();
            around.extend(of_edge.iter().map(|&(_, side)| side));
            if around.len() > 2 {
                sort_by_angle(points, faces, a, b, &mut around);
            }
            // Seen along a → b, each sheet has one copy that runs a → b and one that runs b → a.
            for (i, &sheet) in around.iter().enumerate() {
                let next = around[(i + 1) % around.len()];
                let along = cover.copy_running(sheet, a, m);
                let against = cover.copy_running(next, b, m);
                cover.glue(along, against);
            }
        }
        cover
    }

    /// The copy (front or back) of a front side that starts at vertex `from`.
    fn copy_running(&self, front: Side, from: u32, m: usize) -> Side {
        if self.tail(front) == from {
            front
        } else {
            // Reversing [0, 1, 2] to [0, 2, 1] turns side s into side 2 − s.
            Side { face: front.face + m as u32, side: 2 - front.side }
        }
    }

    fn glue(&mut self, a: Side, b: Side) {
        self.twin[a.face as usize][a.side as usize] = b;
        self.twin[b.face as usize][b.side as usize] = a;
    }

    fn tail(&self, s: Side) -> u32 {
        self.vertices[s.face as usize][s.side as usize]
    }

    /// Lengths of a side and of the next two sides of its face.
    fn lengths_from(&self, s: Side) -> [f64; 3] {
        let l = &self.lengths[s.face as usize];
        std::array::from_fn(|i| l[(s.side as usize + i) % 3])
    }

    /// Cotangent of the angle opposite a side.
    fn cotangent(&self, s: Side) -> f64 {
        let [a, b, c] = self.lengths_from(s);
        (b * b + c * c - a * a) / (4.0 * area(a, b, c))
    }

    /// Flips edges until all weights are non-negative. Returns the number of flips.
    pub(super) fn flip_to_delaunay(&mut self) -> usize {
        let mut queue: std::collections::VecDeque<Side> =
            (0..self.vertices.len() as u32).flat_map(|face| (0..3).map(move |side| Side { face, side })).collect();
        // Every flip shortens the harmonic index, so the loop ends by itself; the bound guards against rounding.
        let bound = 200 * queue.len();
        let mut flips = 0;
        while let Some(side) = queue.pop_front() {
            let twin = self.twin[side.face as usize][side.side as usize];
            if twin.face == side.face || flips >= bound {
                continue;
            }
            let weight = 0.5 * (self.cotangent(side) + self.cotangent(twin));
            if weight < DELAUNAY_TOLERANCE && self.flip(side, twin) {
                flips += 1;
                for face in [side.face, twin.face] {
                    queue.extend((0..3).map(|side| Side { face, side }));
                }
            }
        }
        flips
    }

    /// Replaces the edge shared by two faces by the other diagonal of their quadrilateral.
    fn flip(&mut self, s: Side, t: Side) -> bool {
        // Face of s: a → b → c; face of t: b → a → d. The new edge joins c and d.
        let [ab, bc, ca] = self.lengths_from(s);
        let [_, ad, db] = self.lengths_from(t);
        let next = |s: Side, i: u8| Side { face: s.face, side: (s.side + i) % 3 };
        let (a, b) = (self.tail(s), self.tail(t));
        let (c, d) = (self.tail(next(s, 2)), self.tail(next(t, 2)));
        // Laid out in the plane with a at 0 and b at (ab, 0).
        let cx = (ab * ab + ca * ca - bc * bc) / (2.0 * ab);
        let dx = (ab * ab + ad * ad - db * db) / (2.0 * ab);
        let cy = 2.0 * area(ab, bc, ca) / ab;
        let dy = -2.0 * area(ab, ad, db) / ab;
        let cd = (cx - dx).hypot(cy - dy);
        if !cd.is_finite() || cd <= 0.0 {
            return false;
        }
        let old = |cover: &Self, s: Side| cover.twin[s.face as usize][s.side as usize];
        let (twin_bc, twin_ca) = (old(self, next(s, 1)), old(self, next(s, 2)));
        let (twin_ad, twin_db) = (old(self, next(t, 1)), old(self, next(t, 2)));
        let (f, g) = (s.face as usize, t.face as usize);
        // New faces: f = (c, d, b): c→d, d→b, b→c; g = (d, c, a): d→c, c→a, a→d.
        let new = |face: u32, side: u8| Side { face, side };
        // Where a neighbour is one of the two faces themselves, its side has moved too.
        let moved = |old: Side| -> Side {
            if old == next(s, 1) {
                new(s.face, 2)
            } else if old == next(s, 2) {
                new(t.face, 1)
            } else if old == next(t, 1) {
                new(t.face, 2)
            } else if old == next(t, 2) {
                new(s.face, 1)
            } else {
                old
            }
        };
        let glued = [
            (new(s.face, 1), moved(twin_db)),
            (new(s.face, 2), moved(twin_bc)),
            (new(t.face, 1), moved(twin_ca)),
            (new(t.face, 2), moved(twin_ad)),
        ];
        self.vertices[f] = [c, d, b];
        self.lengths[f] = [cd, db, bc];
        self.vertices[g] = [d, c, a];
        self.lengths[g] = [cd, ca, ad];
        self.glue(new(s.face, 0), new(t.face, 0));
        for (x, y) in glued {
            self.glue(x, y);
        }
        true
    }

    /// Every triangle: its vertices, and the cotangent opposite side s (vertex s to s + 1), and its area.
    pub(super) fn triangles(&self) -> impl Iterator<Item = ([u32; 3], [f64; 3], f64)> + '_ {
        (0..self.vertices.len()).map(move |f| {
            let [a, b, c] = self.lengths[f];
            let cotangents = std::array::from_fn(|s| self.cotangent(Side { face: f as u32, side: s as u8 }));
            (self.vertices[f], cotangents, area(a, b, c))
        })
    }
}

/// Lengthens every edge by the least amount that gives every corner a triangle inequality with slack, relative to the
/// mean length of edges.
fn mollify(lengths: &mut [[f64; 3]], mean: f64) {
    let slack = MOLLIFICATION * mean;
    let mut delta: f64 = 0.0;
    for l in lengths.iter() {
        for s in 0..3 {
            delta = delta.max(slack - (l[(s + 1) % 3] + l[(s + 2) % 3] - l[s]));
        }
    }
    for l in lengths.iter_mut().flatten() {
        *l += delta;
    }
}

/// Orders the sheets around edge a–b by the angle of their third vertex about the edge.
fn sort_by_angle(points: &[[f64; 3]], faces: &[[u32; 3]], a: u32, b: u32, around: &mut [Side]) {
    let origin = points[a as usize];
    let axis = normalise(minus(points[b as usize], origin));
    let helper = if axis[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let u = normalise(cross(axis, helper));
    let v = cross(axis, u);
    let angle = |side: &Side| {
        let third = faces[side.face as usize][(side.side as usize + 2) % 3];
        let w = minus(points[third as usize], origin);
        dot(w, v).atan2(dot(w, u))
    };
    around.sort_by(|x, y| angle(x).total_cmp(&angle(y)).then(x.face.cmp(&y.face)));
}

/// Area by Heron's formula in Kahan's ordering, which stays accurate for needles.
fn area(a: f64, b: f64, c: f64) -> f64 {
    let mut l = [a, b, c];
    l.sort_by(|x, y| y.total_cmp(x));
    let [a, b, c] = l;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * product.max(0.0).sqrt()
}

fn normalise(p: [f64; 3]) -> [f64; 3] {
    let length = norm(p);
    if length > 0.0 { p.map(|x| x / length) } else { p }
}
