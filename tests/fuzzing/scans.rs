//! Arbitrary points and faces: a form that could be a scan, and any number of changes to it, all read off the bytes.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use arbitrary::{Result, Unstructured};
use geose_fmap::pipeline::{match_shapes, prepare};
use geose_fmap::{
    FaceUse, LaplacianKind, Match, MatchOptions, Parts, PrepareOptions, PreparedShape, Progress, Shape, UNMATCHED,
};

use crate::sample::torus;

/// Coordinates that arithmetic may stumble over.
pub const SPECIAL: [f64; 24] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    f64::MAX,
    f64::MIN,
    1e30,
    -1e30,
    1e29,
    1e-30,
    1e-160,
    1e-20,
    1e15,
    1e6,
    1e-6,
    f64::EPSILON,
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    3.0,
];

/// What a scan is made of.
#[derive(Clone, Debug)]
pub struct Scan {
    pub points: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
    pub labels: Option<Vec<u32>>,
}

/// A coordinate: a special one, a small whole one, or any.
fn coordinate(u: &mut Unstructured) -> Result<f64> {
    Ok(match u.int_in_range(0..=3)? {
        0 | 1 => *u.choose(&SPECIAL)?,
        2 => f64::from(u.arbitrary::<i8>()?),
        _ => u.arbitrary()?,
    })
}

/// Rows of points with the triangles between them, in one of several forms; `across` of them in a row.
fn form(u: &mut Unstructured) -> Result<Scan> {
    let (across, along) = (u.int_in_range(5..=14_u32)?, u.int_in_range(10..=14_u32)?);
    let kind = u.int_in_range(0..=6)?;
    let bulge = f64::from(u.int_in_range(0..=8_u8)?) / 8.0;
    let point = |i: u32, j: u32| {
        let (s, t) = (f64::from(i) / f64::from(across), f64::from(j) / f64::from(along));
        let ((sin_s, cos_s), (sin_t, cos_t)) = ((TAU * s).sin_cos(), (TAU * t).sin_cos());
        match kind {
            0 => [f64::from(i), f64::from(j), bulge * f64::from((i + j) % 3)],
            1 => [cos_s * (2.0 + bulge * cos_t), sin_s * (2.0 + bulge * cos_t), bulge * sin_t],
            2 => [cos_s * (0.5 * TAU * t).sin(), sin_s * (0.5 * TAU * t).sin(), (0.5 * TAU * t).cos()],
            3 => [f64::from(i % 4), f64::from(i / 4), f64::from(j)],
            4 => [s, bulge * s, t * 1e-9],
            5 => [(s * 97.0).fract(), (t * 89.0 + s * 53.0).fract(), (s * 31.0 + t * 71.0).fract()],
            _ => [0.0, f64::from(j) * bulge, f64::from(i % 2)],
        }
    };
    let points = (0..along).flat_map(|j| (0..across).map(move |i| point(i, j))).collect();
    let squares = (0..along - 1).flat_map(|j| (0..across - 1).map(move |i| j * across + i));
    let faces = match u.arbitrary()? {
        true => squares.flat_map(|i| [[i, i + 1, i + across + 1], [i, i + across + 1, i + across]]).collect(),
        false => Vec::new(),
    };
    Ok(Scan { points, faces, labels: None })
}

/// One change of points, faces or labels.
fn change(u: &mut Unstructured, scan: &mut Scan) -> Result<()> {
    let n = scan.points.len();
    let index = |u: &mut Unstructured| u.int_in_range(0..=n - 1);
    match u.int_in_range(0..=11)? {
        0 => {
            let (at, axis) = (index(u)?, u.int_in_range(0..=2)?);
            scan.points[at][axis] = coordinate(u)?;
        }
        1 => {
            let (from, to) = (index(u)?, index(u)?);
            scan.points[to] = scan.points[from];
        }
        2 => {
            // All of a stretch in one place, or on one line, or flat.
            let (from, to) = (index(u)?, index(u)?);
            let (axes, value) = (u.int_in_range(1..=7_u8)?, coordinate(u)?);
            let stretch = &mut scan.points[from.min(to)..=from.max(to)];
            stretch.iter_mut().for_each(|p| (0..3).filter(|c| axes >> c & 1 == 1).for_each(|c| p[c] = value));
        }
        3 => {
            let (axis, by) = (u.int_in_range(0..=2)?, coordinate(u)?);
            scan.points.iter_mut().for_each(|p| p[axis] *= by);
        }
        4 => {
            let by = coordinate(u)?;
            scan.points.iter_mut().flatten().for_each(|c| *c *= by);
        }
        5 => {
            let (axis, by) = (u.int_in_range(0..=2)?, coordinate(u)?);
            scan.points.iter_mut().for_each(|p| p[axis] += by);
        }
        6 => {
            // Another piece, far or near.
            let (half, by) = (index(u)?, coordinate(u)?);
            scan.points[half..].iter_mut().for_each(|p| p[0] += by);
        }
        7 => scan.faces.push([index(u)? as u32, index(u)? as u32, index(u)? as u32]),
        8 => {
            if let Some(face) = scan.faces.len().checked_sub(1) {
                let at = u.int_in_range(0..=face)?;
                let [a, b, c] = scan.faces[at];
                let other = index(u)? as u32;
                let changed = [[a, c, b], [a, b, c], [a, a, b], [other, b, c], [a, b, other]][u.int_in_range(0..=4)?];
                if u.arbitrary()? { scan.faces.push(changed) } else { scan.faces[at] = changed }
            }
        }
        9 => {
            let keep = u.int_in_range(0..=scan.faces.len())?;
            scan.faces.truncate(keep);
        }
        10 => scan.faces.push(u.arbitrary()?),
        _ => {
            let parts = u.int_in_range(1..=200_u32)?;
            scan.labels = Some((0..n as u32).map(|i| i % parts).collect());
        }
    }
    Ok(())
}

/// The scan that bytes stand for, and how it is to be prepared and matched.
pub fn scan(u: &mut Unstructured) -> Result<(Scan, PrepareOptions, MatchOptions)> {
    let options = PrepareOptions {
        points: *u.choose(&[200, 50, 60, 120])?,
        faces: if u.ratio(1, 4)? { FaceUse::Ignore } else { FaceUse::Use },
        laplacian: if u.arbitrary()? { None } else { Some(*u.choose(&LaplacianKind::ALL)?) },
        eigenpairs: u.int_in_range(10..=20)?,
        whole_scan: u.arbitrary()?,
        share: if u.ratio(1, 4)? { Some(*u.choose(&[0.05, 0.5, 1.0])?) } else { None },
        ..PrepareOptions::default()
    };
    let parts = *u.choose(&[Parts::Predicted, Parts::Given, Parts::None])?;
    let landmarks = if u.ratio(1, 4)? { vec![[u.int_in_range(0..=70)?, u.int_in_range(0..=63)?]] } else { Vec::new() };
    let mut scan = form(u)?;
    for _ in 0..24 {
        if u.is_empty() {
            break;
        }
        change(u, &mut scan)?;
    }
    Ok((scan, options, MatchOptions { parts, landmarks, ..MatchOptions::default() }))
}

/// A torus, as a mesh and as a cloud, ready to be matched with anything.
pub static TORI: LazyLock<[PreparedShape; 2]> = LazyLock::new(|| {
    let torus = torus();
    [torus.faces, Vec::new()].map(|faces| {
        let labels = (0..64).map(|i| i / 8).collect();
        let shape = Shape::new(torus.points.clone(), faces, Some(labels)).expect("a torus");
        let options = PrepareOptions { eigenpairs: 12, ..PrepareOptions::default() };
        prepare(shape, None, &options, &mut Progress::silent()).expect("a torus is prepared")
    })
});

/// Every point has a target that is there or none, with a confidence that is a probability.
pub fn is_sound(found: &Match, [a, b]: [usize; 2]) -> bool {
    [(&found.a_to_b, a, b), (&found.b_to_a, b, a)].into_iter().all(|(map, from, to)| {
        map.target.len() == from
            && map.confidence.len() == from
            && map.target.iter().all(|&target| target == UNMATCHED || (target as usize) < to)
            && map.confidence.iter().all(|confidence| (0.0..=1.0).contains(confidence))
    })
}

/// Matches with a torus.
pub fn matches(shape: &PreparedShape, options: &MatchOptions) {
    let other = &TORI[usize::from(shape.shape.faces().is_empty())];
    let sizes = [shape, other].map(|shape| shape.shape.points().len());
    match match_shapes(shape, other, options, &mut Progress::silent()) {
        Ok(found) => assert!(is_sound(&found, sizes), "a match that is none: {:?} {:?}", found.a_to_b, found.b_to_a),
        Err(error) => assert!(!error.code().is_empty() && error.to_string().contains(' ')),
    }
}

/// Nothing that a scan holds leaves numbers behind that are none.
pub fn survives(bytes: &[u8]) {
    let Ok((Scan { points, faces, labels }, options, matching)) = scan(&mut Unstructured::new(bytes)) else { return };
    let Ok(shape) = Shape::new(points, faces, labels) else { return };
    match prepare(shape, None, &options, &mut Progress::silent()) {
        Ok(prepared) => {
            let basis = &prepared.basis;
            let numbers = basis.eigenvalues.iter().chain(&basis.eigenvectors).chain(&basis.mass);
            assert!(
                numbers.chain(prepared.surface.normals.iter().flatten()).all(|c| c.is_finite()),
                "a basis without numbers"
            );
            assert!(basis.mass.iter().all(|&mass| mass >= 0.0), "a mass below 0");
            assert!(prepared.features.iter().all(|c| c.is_finite()), "features without numbers");
            assert!(prepared.info.scale.is_finite() && prepared.info.scale > 0.0, "a scale of {}", prepared.info.scale);
            let stored = prepared.to_bytes().expect("what is prepared can be stored");
            let again = PreparedShape::from_bytes(&stored).expect("what is stored can be unpacked");
            assert!(
                again.shape.points() == prepared.shape.points()
                    && again.basis == prepared.basis
                    && again.embeddings == prepared.embeddings
            );
            matches(&prepared, &matching);
        }
        Err(error) => assert!(!error.code().is_empty() && error.to_string().contains(' ')),
    }
}

/// Bytes that stand for scans of every form, with some changes.
pub fn seeds() -> Vec<Vec<u8>> {
    (0..96_u8)
        .map(|i| (0..i % 48 + 12).map(|k| i.wrapping_mul(37).wrapping_add(k.wrapping_mul(k ^ i))).collect())
        .collect()
}
