//! Which side of a mesh is outside, told where windings are crossed, where there are several pieces, and where there is none.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use geose_fmap::{PrepareOptions, PreparedShape};
use shapes::{Soup, blob, icosphere, prepared};

fn quick() -> PrepareOptions {
    PrepareOptions { points: 3000, eigenpairs: 30, ..Default::default() }
}

fn inside_out(soup: &Soup) -> Soup {
    Soup { faces: soup.faces.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..soup.clone() }
}

fn count(shape: &PreparedShape, code: &str) -> Option<usize> {
    shape.repairs.iter().find(|repair| repair.code == code).map(|repair| repair.count)
}

/// How many of these vertices have a normal that points away from `centre`.
fn outward(shape: &PreparedShape, vertices: std::ops::Range<usize>, centre: [f64; 3]) -> usize {
    let points = shape.shape.points();
    vertices
        .filter(|&i| (0..3).map(|c| shape.surface.normals[i][c] * (points[i][c] - centre[c])).sum::<f64>() > 0.0)
        .count()
}

#[test]
fn normals_of_a_mesh_point_out_however_it_is_wound() {
    let ball = blob(3);
    for soup in [inside_out(&ball), ball] {
        let shape = prepared(soup.shape(), &quick());
        assert!(shape.surface.oriented);
        assert_eq!(outward(&shape, 0..642, [0.0; 3]), 642);
        assert_eq!(count(&shape, "faces-reoriented"), None);
    }
    assert!(!prepared(blob(3).cloud().shape(), &quick()).surface.oriented, "a cloud says nothing");
}

#[test]
fn a_few_faces_wound_the_wrong_way_are_turned_for_the_operators_and_said() {
    let ball = blob(3);
    let mut crossed = ball.clone();
    [7, 300, 301, 900].into_iter().for_each(|face| crossed.faces[face].swap(0, 1));
    let shape = prepared(crossed.shape(), &quick());
    assert!(shape.surface.oriented, "a mesh stays a mesh");
    assert_eq!((count(&shape, "faces-reoriented"), count(&shape, "no-outside")), (Some(4), None));
    assert_eq!(outward(&shape, 0..642, [0.0; 3]), 642);
    assert_eq!(shape.shape.faces(), &crossed.faces[..], "the upload stays as it is");
    let whole = prepared(ball.shape(), &quick());
    for (one, other) in shape.surface.normals.iter().zip(&whole.surface.normals) {
        assert!((0..3).all(|c| (one[c] - other[c]).abs() < 1e-9), "{one:?} {other:?}");
    }
}

#[test]
fn every_piece_has_its_own_outside() {
    let big = icosphere(3);
    let small = icosphere(2).moved(|p| p.map(|x| 0.5 * x));
    let (n, m) = (big.points.len(), small.points.len());
    let beside = [3.0, 0.0, 0.0];
    // Beside the larger one and wound the other way; inside it, as the wall of a cavity is.
    for centre in [beside, [0.0; 3]] {
        let other = inside_out(&small).moved(|p| std::array::from_fn(|c| p[c] + centre[c]));
        let shape = prepared(big.beside(&other).shape(), &quick());
        assert!(shape.surface.oriented && count(&shape, "faces-reoriented").is_none());
        assert_eq!(outward(&shape, 0..n, [0.0; 3]), n);
        assert_eq!(outward(&shape, n..n + m, centre), m, "at {centre:?}");
    }
    // Open ones too: caps of two balls, the smaller one inside out.
    let cap = |soup: &Soup| {
        let above = |face: &[u32; 3]| face.iter().all(|&i| soup.points[i as usize][2] > -0.3);
        Soup { faces: soup.faces.iter().copied().filter(above).collect(), ..soup.clone() }
    };
    let other = inside_out(&cap(&small)).moved(|p| std::array::from_fn(|c| p[c] + beside[c]));
    let soup = cap(&big).beside(&other);
    let used: Vec<u32> = soup.faces.as_flattened().to_vec();
    let shape = prepared(soup.shape(), &quick());
    let row = |i: u32| shape.support.row_of(i as usize);
    for &i in &used {
        let centre = if (i as usize) < n { [0.0; 3] } else { beside };
        let (normal, point) = (shape.surface.normals[row(i)], soup.points[i as usize]);
        assert!((0..3).map(|c| normal[c] * (point[c] - centre[c])).sum::<f64>() > 0.0, "vertex {i}");
    }
}

#[test]
fn a_surface_of_one_side_is_taken_as_a_cloud_is_and_that_is_said() {
    // A Möbius strip, 60 around and 6 across.
    const AROUND: u32 = 60;
    const ACROSS: u32 = 6;
    let mut strip = Soup { points: vec![], faces: vec![] };
    for i in 0..AROUND {
        let turn = f64::from(i) / f64::from(AROUND) * std::f64::consts::TAU;
        for j in 0..ACROSS {
            let off = 0.12 * (f64::from(j) - 0.5 * f64::from(ACROSS - 1));
            let r = 1.0 + off * (0.5 * turn).cos();
            strip.points.push([r * turn.cos(), r * turn.sin(), off * (0.5 * turn).sin()]);
        }
    }
    let at = |i: u32, j: u32| if i == AROUND { ACROSS - 1 - j } else { i * ACROSS + j };
    for i in 0..AROUND {
        for j in 0..ACROSS - 1 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            strip.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let shape = prepared(strip.shape(), &quick());
    assert!(!shape.surface.oriented);
    assert_eq!((count(&shape, "faces-reoriented"), count(&shape, "no-outside")), (None, Some(5)));
    let said = shape.repairs.iter().find(|repair| repair.code == "no-outside").expect("said");
    assert!(said.message.contains("as those of a cloud"), "{}", said.message);
}
