//! Gradients and normals against their closed forms, and what no triangle and no cloud may break.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use geose_fmap::operators::{Gradient, gradient, normals};
use geose_fmap::spectrum::spectrum;
use geose_fmap::{LaplacianKind, Progress, Shape};
use shapes::{Random, Soup, blob, body, fibonacci_sphere, icosphere, laplacian, sheet, subdivided, turn};

fn gradient_of(shape: &Shape) -> Gradient {
    gradient(shape, &mut Progress::silent()).expect("nobody stops it")
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| a[c] * b[c]).sum()
}

fn magnitudes(shape: &Shape, function: &[f64]) -> Vec<f64> {
    gradient_of(shape).of(function).iter().map(|g| g[0].hypot(g[1])).collect()
}

/// Gradients as vectors in space (n, 3).
fn in_space(gradient: &Gradient, function: &[f64]) -> Vec<[f64; 3]> {
    let frames = gradient.frames.iter().map(|f| f.tangents);
    gradient.of(function).iter().zip(frames).map(|(g, [u, v])| [0, 1, 2].map(|c| g[0] * u[c] + g[1] * v[c])).collect()
}

/// Irregular samples of a tilted plane, with and without faces.
fn plane() -> Soup {
    let mut random = Random(3);
    sheet(24, 20).moved(|[x, y, _]| turn([x + 0.35 * random.sign(), y + 0.35 * random.sign(), 0.0]))
}

/// A blob, shaken so that no two distances are equal.
fn shaken() -> Soup {
    let mut random = Random(5);
    blob(3).moved(|p| p.map(|x| x + 0.01 * random.sign()))
}

/// The soup as it is and without its faces.
fn both(soup: &Soup) -> [(&'static str, Soup); 2] {
    [("mesh", soup.clone()), ("cloud", soup.cloud())]
}

fn smooth(points: &[[f64; 3]]) -> Vec<f64> {
    points.iter().map(|&[x, y, z]| (1.3 * x).sin() + y * z - 0.4 * z).collect()
}

#[test]
fn the_gradient_of_a_linear_function_on_a_plane_is_exact() {
    let slope = [0.7, -1.1, 0.4];
    for (name, soup) in both(&plane()) {
        let normal = turn([0.0, 0.0, 1.0]);
        let expected = [0, 1, 2].map(|c| slope[c] - dot(slope, normal) * normal[c]);
        let function: Vec<f64> = soup.points.iter().map(|&p| dot(slope, p) + 5.0).collect();
        for (i, found) in in_space(&gradient_of(&soup.shape()), &function).iter().enumerate() {
            for c in 0..3 {
                // A dozen additions of values up to 30.
                assert!((found[c] - expected[c]).abs() <= 1e-11, "{name} {i}: {found:?}, should be {expected:?}");
            }
        }
    }
}

#[test]
fn the_gradient_of_height_on_a_sphere_is_its_tangential_part() {
    let mut random = Random(9);
    let scattered: Vec<[f64; 3]> = (0..4000)
        .map(|_| {
            let (z, turn) = (random.sign(), std::f64::consts::PI * random.sign());
            let r = (1.0 - z * z).sqrt();
            [r * turn.cos(), r * turn.sin(), z]
        })
        .collect();
    // Root mean square and largest error allowed, where the gradient is 0.82 in the same mean. Scattered points come as
    // near as a tenth of the spacing.
    for (name, soup, mean, largest) in [
        ("mesh", icosphere(4), 0.002, 0.01),
        ("even cloud", fibonacci_sphere(2562), 0.004, 0.02),
        ("scattered cloud", Soup { points: scattered, faces: vec![] }, 0.02, 0.1),
    ] {
        let function: Vec<f64> = soup.points.iter().map(|p| p[2]).collect();
        let found = in_space(&gradient_of(&soup.shape()), &function);
        let errors: Vec<f64> = soup
            .points
            .iter()
            .zip(&found)
            .map(|(p, g)| shapes::distance(*g, [-p[2] * p[0], -p[2] * p[1], 1.0 - p[2] * p[2]]))
            .collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let most = errors.iter().fold(0.0, |m: f64, &e| m.max(e));
        println!("{name}: {rms:.4}, at most {most:.4}");
        assert!(rms <= mean && most <= largest, "{name}: {rms}, at most {most}");
    }
}

#[test]
fn moving_a_shape_leaves_the_length_of_gradients_and_scaling_divides_it() {
    for (name, soup) in both(&shaken()) {
        let function = smooth(&soup.points);
        let found = magnitudes(&soup.shape(), &function);
        for scale in [1.0, 1e-4, 250.0] {
            let elsewhere = soup.moved(|p| turn(p).map(|x| scale * (x + 2.0)));
            for (a, b) in found.iter().zip(magnitudes(&elsewhere.shape(), &function)) {
                assert!((a - b * scale).abs() <= 1e-8 * (1.0 + a), "{name} × {scale}: {a} {b}");
            }
        }
    }
}

#[test]
fn renumbering_the_points_renumbers_the_gradient() {
    for (name, soup) in both(&shaken()) {
        let order = Random(4).permutation(soup.points.len());
        let other = soup.renumbered(&order);
        let (here, there) = (gradient_of(&soup.shape()), gradient_of(&other.shape()));
        let (f, g) = (here.of(&smooth(&soup.points)), there.of(&smooth(&other.points)));
        for (i, &j) in order.iter().enumerate() {
            let j = j as usize;
            assert!((0..2).all(|a| (f[i][a] - g[j][a]).abs() <= 1e-9), "{name} {i}: {:?} {:?}", f[i], g[j]);
            assert!(dot(here.frames[i].normal, there.frames[j].normal) > 1.0 - 1e-9, "{name} {i}");
        }
    }
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    for (name, soup) in both(&shaken()) {
        for frame in gradient_of(&soup.shape()).frames {
            let [u, v] = frame.tangents;
            let n = frame.normal;
            for (a, b, expected) in [(u, u, 1.0), (v, v, 1.0), (n, n, 1.0), (u, v, 0.0), (u, n, 0.0), (v, n, 0.0)] {
                assert!((dot(a, b) - expected).abs() <= 1e-12, "{name}: {frame:?}");
            }
            let turned = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            assert!(dot(turned, n) > 0.999, "{name}: {frame:?}");
        }
    }
}

#[test]
fn normals_are_those_of_the_sphere_outwards_on_a_mesh_and_either_way_on_a_cloud() {
    for (name, soup) in both(&icosphere(4)) {
        for (p, n) in soup.points.iter().zip(normals(&soup.shape())) {
            let cosine = dot(*p, n);
            let cosine = if soup.faces.is_empty() { cosine.abs() } else { cosine };
            // 1.1 degrees; the cloud's normals lean to the plane of 8 neighbours.
            assert!(cosine > 0.9998, "{name}: {cosine}");
        }
    }
    let inside_out = icosphere(2).mirrored().moved(|[x, y, z]| [-x, y, z]);
    assert!(inside_out.points.iter().zip(normals(&inside_out.shape())).all(|(p, n)| dot(*p, n) < -0.99));
}

#[test]
fn how_a_cube_is_cut_into_triangles_does_not_turn_its_normals() {
    let cube = |cuts: u32| {
        let corners = (0..8).map(|i| [0, 1, 2].map(|c| f64::from(i >> c & 1))).collect();
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = sides.iter().enumerate().flat_map(|(i, &[a, b, c, d])| {
            if cuts >> i & 1 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        });
        subdivided(&subdivided(&Soup { points: corners, faces: faces.collect() }))
    };
    for cuts in [0, 0b10_1101, 0b01_0110] {
        for (p, n) in cube(cuts).points.iter().zip(normals(&cube(cuts).shape())).take(8) {
            let out = p.map(|x| (2.0 * x - 1.0) / 3.0_f64.sqrt());
            assert!(dot(out, n) > 1.0 - 1e-9, "{n:?}");
        }
    }
}

#[test]
fn constants_have_no_gradient() {
    for (name, soup) in both(&shaken()).into_iter().chain(both(&plane())) {
        let found = gradient_of(&soup.shape()).of(&vec![7.0; soup.points.len()]);
        assert!(found.iter().flatten().all(|g| g.abs() <= 1e-10), "{name}");
    }
}

#[test]
fn gradients_do_not_reach_across_two_sheets_that_touch() {
    // Two layers, 0 on the lower and 1 on the upper one, looked at away from their rims. Without sheets the median is
    // 0.12 and 0.09; at half a spacing nothing tells the layers apart (0.07 either way).
    let mut random = Random(8);
    let mut layer =
        |height: f64| sheet(30, 30).moved(|[x, y, _]| [x + 0.2 * random.sign(), y + 0.2 * random.sign(), height]);
    for (gap, allowed) in [(1.0, 0.035), (1.3, 0.005)] {
        let both = layer(0.0).beside(&layer(gap)).cloud();
        let function: Vec<f64> = both.points.iter().map(|p| if p[2] > 0.1 { 1.0 } else { 0.0 }).collect();
        let found = magnitudes(&both.shape(), &function);
        let inside = both.points.iter().zip(found).filter(|(p, _)| p[0].min(p[1]) > 3.0 && p[0].max(p[1]) < 26.0);
        let mut found: Vec<f64> = inside.map(|(_, g)| g).collect();
        found.sort_by(f64::total_cmp);
        let median = found[found.len() / 2];
        println!("{gap} spacings apart: median {median:.1e}");
        assert!(median <= allowed, "{gap} spacings apart: {median}");
    }
}

#[test]
fn bad_triangles_stray_points_and_copies_give_finite_numbers() {
    let mut fins = blob(2);
    let [a, b, _] = fins.faces[0];
    fins.points.extend([[0.3, 2.0, 1.0], [-0.4, 2.1, 1.2], [9.0, 9.0, 9.0]]);
    let first = fins.points.len() as u32 - 3;
    fins.faces.extend([[a, b, first], [b, a, first + 1]]);
    let mut needles = sheet(20, 20).moved(|[x, y, z]| [x, 1e-4 * y, z]);
    needles.points[45][1] = needles.points[46][1] - 1e-11;
    let mut doubled = blob(2);
    doubled.points[7] = doubled.points[3];
    let both_windings = Soup { faces: [blob(2).faces, blob(2).mirrored().faces].concat(), ..blob(2) };
    let copies =
        Soup { points: fibonacci_sphere(60).points.into_iter().flat_map(|p| [p; 25]).collect(), faces: vec![] };
    let pairs = Soup { points: fibonacci_sphere(60).points.into_iter().flat_map(|p| [p; 2]).collect(), faces: vec![] };
    let line = Soup {
        points: (0..80).map(|i| [f64::from(i), 1e-9 * f64::from(i % 3), 1e-9 * f64::from(i * i % 7)]).collect(),
        faces: vec![],
    };
    let far = blob(2).moved(|p| p.map(|x| 1e-20 * x));
    for (name, soup) in [
        ("fins", fins.clone()),
        ("needles", needles),
        ("doubled", doubled),
        ("both windings", both_windings),
        ("25 copies", copies.clone()),
        ("pairs", pairs),
        ("line", line),
        ("tiny", far),
    ] {
        for soup in [soup.clone(), soup.cloud()] {
            let Ok(shape) = Shape::new(soup.points.clone(), soup.faces.clone(), None) else { continue };
            let found = gradient_of(&shape);
            let entries = found.along.iter().flat_map(|g| g.data());
            assert!(entries.clone().all(|v| v.is_finite()), "{name}");
            let frames = found.frames.iter().flat_map(|f| [f.tangents[0], f.tangents[1], f.normal]);
            assert!(frames.flatten().chain(normals(&shape).into_iter().flatten()).all(f64::is_finite), "{name}");
        }
    }
    let stray = fins.points.len() - 1;
    assert!(gradient_of(&fins.shape()).along.iter().all(|g| g.outer_view(stray).is_some_and(|row| row.nnz() == 0)));
    // Among 25 copies the 20 nearest are all in one place.
    assert!(gradient_of(&copies.shape()).along.iter().all(|g| g.nnz() == 0));
    // Along a line there is a gradient, across it none.
    let rail: Vec<[f64; 3]> = (0..80).map(|i| [f64::from(i), if i == 79 { 9.0 } else { 0.0 }, 0.0]).collect();
    let function: Vec<f64> = rail.iter().map(|p| 3.0 * p[0]).collect();
    let found = magnitudes(&Shape::new(rail, vec![], None).expect("not quite a line"), &function);
    assert!(found[..50].iter().all(|g| (g - 3.0).abs() < 1e-9), "{found:?}");
}

#[test]
fn faces_of_no_area_change_nothing() {
    let clean = icosphere(3);
    let mut cracked = clean.clone();
    // An edge split on one side only, with a face of no area in the crack.
    let [a, b, c] = clean.faces[100];
    let m = cracked.points.len() as u32;
    cracked.points.push([0, 1, 2].map(|k| 0.5 * (clean.points[a as usize][k] + clean.points[b as usize][k])));
    cracked.faces[100] = [a, m, c];
    cracked.faces.extend([[m, b, c], [a, b, m]]);
    let function = smooth(&cracked.points);
    let [here, there] = [&clean, &cracked].map(|s| magnitudes(&s.shape(), &function[..s.points.len()]));
    for (i, (x, y)) in here.iter().zip(&there).enumerate() {
        assert!((x - y).abs() <= 0.1 * (1.0 + x), "{i}: {x} {y}");
    }
}

#[test]
fn the_energy_of_the_first_eigenfunctions_of_a_body_is_their_eigenvalue() {
    // λ = ∫|∇φ|² for eigenfunctions of norm 1. Means over triangles and fits over neighbours smooth, so most lie below.
    for (name, kind) in [("mesh", LaplacianKind::Cotangent), ("cloud", LaplacianKind::Geodesic)] {
        for file in ["woman-standing.ply", "man-lunging.ply"] {
            let whole = body(file);
            let shape = if name == "mesh" { whole } else { whole.without_faces() };
            let operator = laplacian(&shape, kind);
            let (basis, _) =
                spectrum(&operator.matrix, &operator.mass, 11, &mut Progress::silent()).expect("a spectrum");
            let found = gradient_of(&shape);
            let off: Vec<f64> = (1..=10)
                .map(|j| {
                    let gradients = found.of(&basis.eigenvectors.column(j).to_vec());
                    let energy: f64 =
                        gradients.iter().zip(&operator.mass).map(|(g, m)| m * (g[0] * g[0] + g[1] * g[1])).sum();
                    energy / basis.eigenvalues[j] - 1.0
                })
                .collect();
            println!("{name} of {file}: {off:.3?}");
            assert!(off.iter().all(|e| e.abs() <= 0.1), "{name} of {file}: {off:?}");
        }
    }
}
