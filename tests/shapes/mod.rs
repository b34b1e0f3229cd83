//! Shapes whose truth is known, and the committed sample bodies.
#![allow(dead_code, reason = "each test file uses its own part of these")]

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

use geose_fmap::pipeline::prepare;
use geose_fmap::{LaplacianKind, PrepareOptions, PreparedShape, Progress, Shape, read};

/// Points and triangles; no triangles for a cloud.
#[derive(Clone, Debug)]
pub struct Soup {
    pub points: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
}

impl Soup {
    pub fn shape(&self) -> Shape {
        Shape::new(self.points.clone(), self.faces.clone(), None).expect("a valid shape")
    }

    pub fn cloud(&self) -> Self {
        Self { points: self.points.clone(), faces: vec![] }
    }

    pub fn moved(&self, mut motion: impl FnMut([f64; 3]) -> [f64; 3]) -> Self {
        Self { points: self.points.iter().map(|&p| motion(p)).collect(), faces: self.faces.clone() }
    }

    /// Point `i` becomes point `new_index[i]`.
    pub fn renumbered(&self, new_index: &[u32]) -> Self {
        let mut points = self.points.clone();
        new_index.iter().zip(&self.points).for_each(|(&new, &p)| points[new as usize] = p);
        Self { points, faces: self.faces.iter().map(|f| f.map(|i| new_index[i as usize])).collect() }
    }

    /// The same surface seen in a mirror, with the outside outside.
    pub fn mirrored(&self) -> Self {
        let mirror = self.moved(|[x, y, z]| [-x, y, z]);
        Self { faces: mirror.faces.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..mirror }
    }

    /// Both, sharing nothing.
    pub fn beside(&self, other: &Self) -> Self {
        let first = self.points.len() as u32;
        let points = self.points.iter().chain(&other.points).copied().collect();
        let faces = self.faces.iter().copied().chain(other.faces.iter().map(|f| f.map(|i| i + first))).collect();
        Self { points, faces }
    }
}

/// SplitMix64: the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In [−1, 1).
    pub fn sign(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// 0..n in some order.
    pub fn permutation(&mut self, n: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n as u32).collect();
        (1..n).rev().for_each(|i| order.swap(i, self.below(i + 1)));
        order
    }
}

/// A rotation about a general axis.
pub fn turn([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (s, c) = 0.7_f64.sin_cos();
    let [x, y, z] = [c * x - s * y, s * x + c * y, z];
    let (s, c) = 1.9_f64.sin_cos();
    let [x, y, z] = [x, c * y - s * z, s * y + c * z];
    let (s, c) = 2.6_f64.sin_cos();
    [c * x + s * z, y, c * z - s * x]
}

pub fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt()
}

/// The unit sphere as an icosahedron whose triangles are split into four `level` times: 10·4^level + 2 points.
pub fn icosphere(level: usize) -> Soup {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points = vec![
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    #[rustfmt::skip]
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    for _ in 0..level {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (points[a as usize], points[b as usize]);
                points.push([0, 1, 2].map(|c| 0.5 * (p[c] + q[c])));
                points.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let unit = |p: [f64; 3]| p.map(|x| x / distance(p, [0.0; 3]));
    Soup { points: points.into_iter().map(unit).collect(), faces }
}

/// `n` points spread evenly over the unit sphere, without faces.
pub fn fibonacci_sphere(n: usize) -> Soup {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / n as f64;
        let (s, c) = (golden * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * c, r * s, z]
    };
    Soup { points: (0..n).map(point).collect(), faces: vec![] }
}

/// A closed smooth blob without any symmetry: a stretched icosphere with a large, a middle and a small bump.
pub fn blob(level: usize) -> Soup {
    const BUMPS: [([f64; 3], f64, f64); 3] =
        [([0.9, 0.3, 0.3], 0.9, 6.0), ([-0.5, 0.8, 0.1], 0.6, 8.0), ([0.1, -0.4, 0.9], 0.45, 10.0)];
    icosphere(level).moved(|p| {
        let bump = BUMPS.iter().map(|&(axis, height, sharpness)| {
            let norm = distance(axis, [0.0; 3]);
            let cosine = (0..3).map(|c| p[c] * axis[c] / norm).sum::<f64>();
            height * (sharpness * (cosine - 1.0)).exp()
        });
        let r = 1.0 + bump.sum::<f64>();
        [1.3 * r * p[0], r * p[1], 0.8 * r * p[2]]
    })
}

/// Every triangle in four, new vertices in the middle of edges, after the old ones.
pub fn subdivided(soup: &Soup) -> Soup {
    let mut points = soup.points.clone();
    let mut middles = std::collections::HashMap::new();
    let mut middle = |i: u32, j: u32| {
        *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
            let (p, q) = (soup.points[i as usize], soup.points[j as usize]);
            points.push(std::array::from_fn(|c| 0.5 * (p[c] + q[c])));
            points.len() as u32 - 1
        })
    };
    let faces = soup.faces.iter().flat_map(|&[a, b, c]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    });
    let faces = faces.collect();
    Soup { points, faces }
}

/// A torus of radii `big` and `small`, `n` by `m` points.
pub fn torus(big: f64, small: f64, n: u32, m: u32) -> Soup {
    let mut soup = Soup { points: vec![], faces: vec![] };
    for i in 0..n {
        for j in 0..m {
            let (su, cu) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
            let (sv, cv) = (TAU * f64::from(j) / f64::from(m)).sin_cos();
            soup.points.push([(big + small * cv) * cu, (big + small * cv) * su, small * sv]);
            let at = |i: u32, j: u32| (i % n) * m + j % m;
            soup.faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            soup.faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    soup
}

/// A rectangle in the plane, `n` by `m` points, one unit apart, with a boundary.
pub fn sheet(n: u32, m: u32) -> Soup {
    let mut soup = Soup { points: vec![], faces: vec![] };
    for i in 0..n {
        for j in 0..m {
            soup.points.push([f64::from(i), f64::from(j), 0.0]);
            let at = |i: u32, j: u32| i * m + j;
            if i + 1 < n && j + 1 < m {
                soup.faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                soup.faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    soup
}

/// A strip one spacing fine, folded over itself: two layers `gap` apart, joined by a half circle at one end. Slightly
/// uneven, so that no two distances are equal. Points (n·m) in rows along the strip.
pub fn folded_strip(n: u32, m: u32, gap: f64) -> Soup {
    let mut random = Random(7);
    let radius = 0.5 * gap;
    let straight = 0.5 * (f64::from(n) - PI * radius);
    let mut points = vec![];
    for i in 0..n {
        for j in 0..m {
            let along = f64::from(i) + 0.1 * random.sign();
            let across = f64::from(j) + 0.1 * random.sign();
            let bend = ((along - straight) / radius).clamp(0.0, PI);
            let back = (along - straight - PI * radius).max(0.0);
            let x = along.min(straight) + radius * bend.sin() - back;
            points.push([x, across, radius * (1.0 - bend.cos())]);
        }
    }
    Soup { points, faces: vec![] }
}

/// The matrix as rows of a dense table.
pub fn dense(matrix: &sprs::CsMat<f64>) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; matrix.cols()]; matrix.rows()];
    matrix.iter().for_each(|(&value, (i, j))| rows[i][j] += value);
    rows
}

/// Names of the sample meshes, whose points correspond by index.
pub const BODIES: [&str; 4] = ["woman-standing.ply", "woman-striding.ply", "man-standing.ply", "man-lunging.ply"];

/// A committed sample body.
pub fn body(file: &str) -> Shape {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("www/public/samples").join(file);
    scan(&path)
}

/// A scan from a file.
pub fn scan(path: &Path) -> Shape {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    read(&bytes, path.to_str(), None).expect("a readable scan")
}

/// Points and faces of a shape.
pub fn soup(shape: &Shape) -> Soup {
    Soup { points: shape.points().to_vec(), faces: shape.faces().to_vec() }
}

pub fn laplacian(shape: &Shape, kind: LaplacianKind) -> geose_fmap::operators::Laplacian {
    geose_fmap::operators::laplacian(shape, kind, &mut Progress::silent()).expect("a Laplacian")
}

pub fn prepared(shape: Shape, options: &PrepareOptions) -> PreparedShape {
    prepare(shape, None, options, &mut Progress::silent()).expect("a prepared shape")
}

/// A cloud of `count` points of a shape, each as far as possible from those before it.
pub fn farthest(shape: &Shape, count: usize) -> Shape {
    let points = shape.points();
    let mut nearest = vec![f64::INFINITY; points.len()];
    let mut next = 0;
    let chosen = (0..count).map(|_| {
        let point = points[next];
        for (d, &p) in nearest.iter_mut().zip(points) {
            *d = d.min(distance(p, point));
        }
        next = (0..points.len()).fold(0, |best, i| if nearest[i] > nearest[best] { i } else { best });
        point
    });
    Shape::new(chosen.collect(), vec![], None).expect("a part of a good shape")
}
