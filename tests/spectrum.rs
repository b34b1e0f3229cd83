//! Eigenpairs are all there, each as often as it should be, orthonormal and accurate: where the spectrum is known in closed
//! form, and by their residual where it is not.
#![cfg(not(target_arch = "wasm32"))]

#[path = "spectrum/refused.rs"]
mod refused;
mod shapes;

use std::f64::consts::{PI, TAU};

use geose_fmap::spectrum::{SpectralBasis, SpectrumError, SpectrumReport, spectrum};
use geose_fmap::{LaplacianKind, Progress, Stage};
use shapes::{Random, blob, body, dense, fibonacci_sphere, icosphere, laplacian, sheet};
use sprs::{CsMat, TriMat};

/// L and M with every eigenvalue known.
struct Known {
    matrix: CsMat<f64>,
    mass: Vec<f64>,
    /// All n eigenvalues, ascending.
    eigenvalues: Vec<f64>,
}

/// L = D − W from directed weights.
fn from_weights(n: usize, weights: impl IntoIterator<Item = (usize, usize, f64)>) -> CsMat<f64> {
    let mut entries = TriMat::new((n, n));
    for (i, j, w) in weights {
        entries.add_triplet(i, j, -w);
        entries.add_triplet(i, i, w);
    }
    entries.to_csr()
}

/// A periodic n × m grid with weight `axis` to the 4 and `diagonal` to the 8 neighbours and mass `m` everywhere. Its eigenfunctions are
/// plane waves.
fn flat_torus(n: usize, m: usize, axis: f64, diagonal: f64, mass: f64) -> Known {
    let at = |i: usize, j: usize| (i % n) * m + j % m;
    let mut weights = vec![];
    for i in n..2 * n {
        for j in m..2 * m {
            for (x, y) in [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)] {
                weights.push((at(i, j), at(x, y), axis));
            }
            for (x, y) in [(i + 1, j + 1), (i - 1, j - 1), (i - 1, j + 1), (i + 1, j - 1)] {
                weights.push((at(i, j), at(x, y), diagonal));
            }
        }
    }
    weights.retain(|&(_, _, w)| w != 0.0);
    let mut eigenvalues = vec![];
    for p in 0..n {
        for q in 0..m {
            let (a, b) = (TAU * p as f64 / n as f64, TAU * q as f64 / m as f64);
            let axes = 4.0 - 2.0 * a.cos() - 2.0 * b.cos();
            let diagonals = 4.0 - 2.0 * (a + b).cos() - 2.0 * (a - b).cos();
            eigenvalues.push((axis * axes + diagonal * diagonals) / mass);
        }
    }
    eigenvalues.sort_by(f64::total_cmp);
    Known { matrix: from_weights(n * m, weights), mass: vec![mass; n * m], eigenvalues }
}

/// An n × m grid with free ends, a quarter of whose eigenvalues are never equal: products of cosines.
fn plate(n: usize, m: usize) -> Known {
    let mut weights = vec![];
    for i in 0..n {
        for j in 0..m {
            for (x, y) in [(i + 1, j), (i, j + 1)] {
                if x < n && y < m {
                    weights.extend([(i * m + j, x * m + y, 1.0), (x * m + y, i * m + j, 1.0)]);
                }
            }
        }
    }
    let wave = |p: usize, n: usize| 2.0 - 2.0 * (PI * p as f64 / n as f64).cos();
    let mut eigenvalues: Vec<f64> = (0..n * m).map(|i| wave(i / m, n) + wave(i % m, m)).collect();
    eigenvalues.sort_by(f64::total_cmp);
    Known { matrix: from_weights(n * m, weights), mass: vec![1.0; n * m], eigenvalues }
}

/// Pieces side by side without a link. Their points are interleaved, so that no piece is a block of rows.
fn apart(pieces: &[&Known]) -> Known {
    let total: usize = pieces.iter().map(|p| p.mass.len()).sum();
    let place = Random(3).permutation(total);
    let mut entries = TriMat::new((total, total));
    let (mut mass, mut eigenvalues) = (vec![0.0; total], vec![]);
    let mut first = 0;
    for piece in pieces {
        for (&value, (i, j)) in piece.matrix.iter() {
            entries.add_triplet(place[first + i] as usize, place[first + j] as usize, value);
        }
        piece.mass.iter().enumerate().for_each(|(i, &m)| mass[place[first + i] as usize] = m);
        eigenvalues.extend(&piece.eigenvalues);
        first += piece.mass.len();
    }
    eigenvalues.sort_by(f64::total_cmp);
    Known { matrix: entries.to_csr(), mass, eigenvalues }
}

fn solved(matrix: &CsMat<f64>, mass: &[f64], k: usize) -> (SpectralBasis, SpectrumReport) {
    let (basis, report) = spectrum(matrix, mass, k, &mut Progress::silent()).expect("a spectrum");
    assert_pairs(matrix, mass, &basis);
    assert!(report.complete, "not proved complete: {report:?}");
    assert!(report.residual <= 1e-6);
    (basis, report)
}

/// ΦᵀMΦ = I to 1e-8, ‖Lφ − λMφ‖ in the M⁻¹ norm ≤ 1e-6·λ_k, ascending: what the eigensolver promises, computed anew.
fn assert_pairs(matrix: &CsMat<f64>, mass: &[f64], basis: &SpectralBasis) {
    let (lambda, phi) = (&basis.eigenvalues, &basis.eigenvectors);
    assert!(lambda[0] >= 0.0 && lambda.windows(2).into_iter().all(|w| w[0] <= w[1]), "not ascending: {lambda}");
    assert!(phi.iter().all(|v| v.is_finite()));
    let weighted = phi * &ndarray::Array1::from(mass.to_vec()).insert_axis(ndarray::Axis(1));
    let gram = phi.t().dot(&weighted);
    for ((i, j), &value) in gram.indexed_iter() {
        let expected = if i == j { 1.0 } else { 0.0 };
        assert!((value - expected).abs() <= 1e-8, "ΦᵀMΦ at ({i}, {j}) is {value}");
    }
    // Where only zeros are asked for, against the size of the operator.
    let mean = matrix.diag_iter().zip(mass).map(|(d, m)| d.map_or(0.0, |d| d / m.max(f64::MIN_POSITIVE))).sum::<f64>();
    let largest = lambda[lambda.len() - 1].max(1e-8 * mean / mass.len() as f64);
    for c in 0..basis.k() {
        let mut residual = vec![0.0; mass.len()];
        matrix.iter().for_each(|(&value, (i, j))| residual[i] += value * phi[(j, c)]);
        let squares = (0..mass.len()).filter(|&i| mass[i] > 0.0).map(|i| {
            let r = residual[i] - lambda[c] * mass[i] * phi[(i, c)];
            r * r / mass[i]
        });
        let norm = squares.sum::<f64>().sqrt();
        assert!(norm <= 1e-6 * largest, "pair {c} (λ = {}): residual {norm:e} of λ_k = {largest}", lambda[c]);
    }
}

/// Eigenvalue errors are about the square of the residuals, 1e-12, over the distance to the next eigenvalue: 1e-9 of the largest has room.
fn assert_is_start_of(found: &SpectralBasis, exact: &[f64]) {
    let k = found.k();
    let tolerance = 1e-9 * exact[k - 1];
    for (c, (found, exact)) in found.eigenvalues.iter().zip(exact).enumerate() {
        assert!((found - exact).abs() <= tolerance, "k = {k}: λ_{c} is {found}, should be {exact}");
    }
}

#[test]
fn a_square_flat_torus_has_its_clusters_of_four_and_eight_wherever_k_cuts_them() {
    let torus = flat_torus(26, 26, 1.0, 0.0, 1.0);
    let multiplicity = |c: usize| {
        let value = torus.eigenvalues[c];
        torus.eigenvalues.iter().filter(|&other| (other - value).abs() < 1e-12).count()
    };
    assert_eq!([1, 5, 13].map(multiplicity), [4, 4, 8], "the truth itself");
    for k in 1..=62 {
        assert_is_start_of(&solved(&torus.matrix, &torus.mass, k).0, &torus.eigenvalues);
    }
}

#[test]
fn a_flat_torus_of_nine_point_stencils_has_its_spectrum_at_any_scale_of_mass_and_weight() {
    for (axis, diagonal, mass) in [(2.0 / 3.0, 1.0 / 6.0, 1.0), (2e7, 5e6, 3e-9), (4e-12, 1e-12, 5e8)] {
        let torus = flat_torus(40, 36, axis, diagonal, mass);
        assert_is_start_of(&solved(&torus.matrix, &torus.mass, 120).0, &torus.eigenvalues);
    }
}

#[test]
fn a_fine_flat_torus_has_its_first_120_eigenvalues() {
    let torus = flat_torus(70, 70, 1.0, 0.0, 1.0);
    let (basis, report) = solved(&torus.matrix, &torus.mass, 120);
    assert_is_start_of(&basis, &torus.eigenvalues);
    assert_eq!(report.pieces, 1);
}

#[test]
fn a_spectrum_is_right_just_below_and_just_above_the_size_that_is_solved_densely() {
    for (n, m) in [(17, 17), (20, 15), (43, 7), (61, 5)] {
        let torus = flat_torus(n, m, 1.0, 0.0, 1.0);
        for k in [10, 60, n * m - 2] {
            assert_is_start_of(&solved(&torus.matrix, &torus.mass, k).0, &torus.eigenvalues);
        }
    }
}

#[test]
fn the_sphere_has_l_times_l_plus_one_two_l_plus_one_times() {
    let sphere = laplacian(&icosphere(4).shape(), LaplacianKind::Cotangent);
    // 64 ends with the degree l = 7, 60 cuts it.
    for k in [64, 60] {
        let (basis, _) = solved(&sphere.matrix, &sphere.mass, k);
        for (c, &lambda) in basis.eigenvalues.iter().enumerate() {
            let degree = (c as f64).sqrt().floor();
            let exact = degree * (degree + 1.0);
            // The triangles' own error grows like λh²: h = 0.07 here. Degrees are 1/l apart, far more.
            let tolerance = exact * (0.002 + 0.0005 * exact) + 1e-12;
            assert!((lambda - exact).abs() <= tolerance, "λ_{c} is {lambda}, should be {exact}");
        }
    }
}

#[test]
fn a_sphere_of_points_has_nearly_the_spectrum_of_the_sphere() {
    let sphere = laplacian(&fibonacci_sphere(2000).shape(), LaplacianKind::Geodesic);
    let (basis, _) = solved(&sphere.matrix, &sphere.mass, 36);
    for (c, &lambda) in basis.eigenvalues.iter().enumerate() {
        let degree = (c as f64).sqrt().floor();
        let exact = degree * (degree + 1.0);
        // A kernel as wide as 20 neighbours blurs: the error grows with λ. 8 % still keeps degrees up to 5 apart.
        assert!((lambda - exact).abs() <= 0.08 * exact + 1e-9, "λ_{c} is {lambda}, should be {exact}");
    }
}

#[test]
fn two_pieces_have_two_zeros_and_both_their_spectra() {
    let (torus, plate) = (flat_torus(20, 20, 1.0, 0.0, 1.0), plate(31, 23));
    let both = apart(&[&torus, &plate]);
    let (basis, report) = solved(&both.matrix, &both.mass, 80);
    assert_is_start_of(&basis, &both.eigenvalues);
    assert_eq!(report.pieces, 2);
    assert_eq!(basis.eigenvalues.iter().filter(|&&lambda| lambda < 1e-12).count(), 2);
}

#[test]
fn seven_different_pieces_have_seven_zeros_and_every_eigenvalue() {
    let pieces: Vec<Known> = (0..7).map(|i| plate(11 + i, 13 + 2 * i)).collect();
    let all = apart(&pieces.iter().collect::<Vec<_>>());
    for k in [5, 7, 8, 120] {
        let (basis, report) = solved(&all.matrix, &all.mass, k);
        assert_is_start_of(&basis, &all.eigenvalues);
        assert_eq!(report.pieces, 7);
    }
}

#[test]
fn thirty_equal_pieces_have_every_eigenvalue_thirty_or_a_hundred_and_twenty_times() {
    let simple = plate(9, 12);
    let all = apart(&vec![&simple; 30]);
    for k in [29, 30, 45, 100] {
        assert_is_start_of(&solved(&all.matrix, &all.mass, k).0, &all.eigenvalues);
    }
    let fourfold = flat_torus(10, 10, 1.0, 0.0, 1.0);
    let all = apart(&vec![&fourfold; 30]);
    for k in [31, 120, 160] {
        let (basis, report) = solved(&all.matrix, &all.mass, k);
        assert_is_start_of(&basis, &all.eigenvalues);
        assert_eq!(report.pieces, 30);
    }
}

#[test]
fn sample_bodies_have_120_orthonormal_eigenpairs_of_every_kind() {
    let body = body("man-lunging.ply");
    for kind in LaplacianKind::ALL {
        let operator = laplacian(&body, kind);
        let (basis, report) = solved(&operator.matrix, &operator.mass, 120);
        assert_eq!((basis.k(), report.pieces), (120, 1), "{kind}");
        assert!(basis.eigenvalues[0] < 1e-9 * basis.eigenvalues[1] && basis.eigenvalues[1] > 0.0, "{kind}");
    }
}

#[test]
fn the_same_matrix_gives_the_same_bytes_again() {
    let operator = laplacian(&blob(3).shape(), LaplacianKind::Geodesic);
    let bytes = || {
        let (basis, _) = solved(&operator.matrix, &operator.mass, 60);
        let bits: Vec<u64> = basis.eigenvalues.iter().chain(&basis.eigenvectors).map(|v| v.to_bits()).collect();
        bits
    };
    assert!(bytes() == bytes());
}

#[test]
fn signs_do_not_depend_on_the_order_of_the_points() {
    let blob = blob(3);
    let order = Random(11).permutation(blob.points.len());
    let renumbered = blob.renumbered(&order);
    for kind in [LaplacianKind::Cotangent, LaplacianKind::Geodesic] {
        let [one, other] = [&blob, &renumbered].map(|soup| {
            let operator = laplacian(&soup.shape(), kind);
            solved(&operator.matrix, &operator.mass, 50).0
        });
        for c in 0..50 {
            let worst = (0..order.len())
                .map(|i| (one.eigenvectors[(i, c)] - other.eigenvectors[(order[i] as usize, c)]).abs())
                .fold(0.0, f64::max);
            let size = one.eigenvectors.column(c).iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            // Eigenvectors are as accurate as residual over gap; the blob has no multiple eigenvalues.
            assert!(worst <= 1e-4 * size, "{kind}: column {c} differs by {worst} of {size}");
        }
    }
}

#[test]
fn more_pairs_than_points_become_two_less_than_points() {
    let operator = laplacian(&fibonacci_sphere(50).shape(), LaplacianKind::Geodesic);
    assert_eq!(solved(&operator.matrix, &operator.mass, 120).0.k(), 48);
    let torus = flat_torus(20, 20, 1.0, 0.0, 1.0);
    let (basis, _) = solved(&torus.matrix, &torus.mass, 1000);
    assert_eq!(basis.k(), 398);
    assert_is_start_of(&basis, &torus.eigenvalues);
}

#[test]
fn points_without_mass_and_entries_get_zero_rows_and_change_nothing_else() {
    let torus = flat_torus(22, 22, 1.0, 0.0, 1.0);
    let n = torus.mass.len();
    let mut mass = vec![0.0; n + 3];
    let mut entries = TriMat::new((n + 3, n + 3));
    // Idle points at both ends and in the middle; one of them has an explicit zero on its diagonal.
    let place = |i: usize| i + 1 + usize::from(i >= n / 2);
    torus.matrix.iter().for_each(|(&value, (i, j))| entries.add_triplet(place(i), place(j), value));
    entries.add_triplet(0, 0, 0.0);
    torus.mass.iter().enumerate().for_each(|(i, &m)| mass[place(i)] = m);
    let (basis, report) = solved(&entries.to_csr(), &mass, 40);
    assert_is_start_of(&basis, &torus.eigenvalues);
    assert_eq!((report.pieces, basis.len()), (1, n + 3));
    for i in [0, n / 2 + 1, n + 2] {
        assert!(basis.eigenvectors.row(i).iter().all(|&v| v == 0.0), "row {i}");
    }
}

#[test]
fn a_rod_a_thousand_times_as_long_as_thick_vibrates_like_a_string() {
    // 1000 long, a ring of 8 points every 2.5.
    let mut rod = shapes::Soup { points: vec![], faces: vec![] };
    let (rings, around) = (401_u32, 8_u32);
    for i in 0..rings {
        for j in 0..around {
            let (s, c) = (TAU * f64::from(j) / f64::from(around)).sin_cos();
            rod.points.push([2.5 * f64::from(i), 0.5 * c, 0.5 * s]);
            let at = |i: u32, j: u32| i * around + j % around;
            if i + 1 < rings {
                rod.faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                rod.faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let operator = laplacian(&rod.shape(), LaplacianKind::Cotangent);
    let (basis, _) = solved(&operator.matrix, &operator.mass, 60);
    for (c, &lambda) in basis.eigenvalues.iter().enumerate() {
        // Right triangles on a prism are exactly the string of 400 links; π²c²/1000² within 2 % here.
        let exact = (2.0 - 2.0 * (PI * c as f64 / 400.0).cos()) / 2.5_f64.powi(2);
        // 1e-6: how far the middle of an arc is from where the octagon has its mass is no matter along the rod.
        assert!((lambda - exact).abs() <= 1e-6 * exact + 1e-12, "λ_{c} is {lambda}, should be {exact}");
    }
}

#[test]
fn a_long_rod_of_points_has_its_spectrum() {
    let mut rod = shapes::Soup { points: vec![], faces: vec![] };
    let (rings, around) = (1700, 6);
    for i in 0..rings {
        for j in 0..around {
            let (s, c) = (TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(around)).sin_cos();
            rod.points.push([f64::from(i) * 1000.0 / f64::from(rings - 1), 0.5 * c, 0.5 * s]);
        }
    }
    let operator = laplacian(&rod.shape(), LaplacianKind::Geodesic);
    let (basis, report) = solved(&operator.matrix, &operator.mass, 30);
    assert_eq!(report.pieces, 1);
    for (c, &lambda) in basis.eigenvalues.iter().enumerate().skip(2) {
        // 20 neighbours reach round so thin a rod, which spoils the scale but not the shape of the spectrum.
        let ratio = lambda / basis.eigenvalues[1] / (c * c) as f64;
        assert!((ratio - 1.0).abs() <= 0.02, "λ_{c} is {ratio} times c² λ_1");
    }
}

#[test]
fn triangles_that_differ_in_size_by_four_orders_of_magnitude_cost_no_accuracy() {
    for tiny in [1e-2, 1e-3, 1e-4] {
        let strip = sheet(40, 30).moved(|[x, y, z]| [x, if y < 4.0 { tiny * y } else { y }, z]);
        let corner = sheet(40, 30).moved(|[x, y, z]| if x.max(y) < 6.0 { [tiny * x, tiny * y, z] } else { [x, y, z] });
        let needles = sheet(40, 30).moved(|[x, y, z]| [x, tiny * y, z]);
        for (name, soup) in [("strip", strip), ("corner", corner), ("needles", needles)] {
            let operator = laplacian(&soup.shape(), LaplacianKind::Cotangent);
            let (_, report) = solved(&operator.matrix, &operator.mass, 60);
            assert!(report.restarts <= 3, "{name} of {tiny:e}: {report:?}");
        }
    }
}

#[test]
fn the_unit_of_the_scan_does_not_matter() {
    for kind in LaplacianKind::ALL {
        let at = |scale: f64| {
            let operator = laplacian(&blob(3).moved(|p| p.map(|x| scale * x)).shape(), kind);
            let (basis, _) = solved(&operator.matrix, &operator.mass, 60);
            basis.eigenvalues * operator.area()
        };
        let one = at(1.0);
        let last = one[59];
        for scale in [1e-6, 1e6, 1e-12, 1e12] {
            for (c, (one, other)) in one.iter().zip(at(scale)).enumerate() {
                // 1e-9 of the 60th, as everywhere.
                assert!((one - other).abs() <= 1e-9 * last, "{kind} × {scale:e}: λ_{c} {one} {other}");
            }
        }
    }
}

#[test]
fn a_matrix_of_zeros_has_only_zeros() {
    for n in [60, 500] {
        let (basis, report) = solved(&CsMat::zero((n, n)), &vec![2.0; n], 20);
        assert!(basis.eigenvalues.iter().all(|&lambda| lambda == 0.0));
        assert_eq!(report.pieces, n);
    }
}

#[test]
fn a_positive_definite_matrix_has_no_zero_but_all_else() {
    // L + M/10: nothing the solver knows about null vectors applies.
    let mut known = flat_torus(26, 26, 1.0, 0.0, 1.0);
    for i in 0..known.matrix.rows() {
        *known.matrix.get_mut(i, i).expect("a diagonal") += 0.1;
    }
    known.eigenvalues.iter_mut().for_each(|lambda| *lambda += 0.1);
    assert_is_start_of(&solved(&known.matrix, &known.mass, 50).0, &known.eigenvalues);
}

#[test]
fn uneven_mass_has_the_spectrum_of_the_dense_problem() {
    let mut random = Random(5);
    let mut known = plate(21, 20);
    known.mass.iter_mut().for_each(|m| *m = (6.0 * random.sign()).exp());
    let (basis, _) = solved(&known.matrix, &known.mass, 60);
    let rows = dense(&known.matrix);
    let scaled = faer::Mat::from_fn(420, 420, |i, j| rows[i][j] / (known.mass[i] * known.mass[j]).sqrt());
    let exact = scaled.self_adjoint_eigenvalues(faer::Side::Lower).expect("finite");
    assert_is_start_of(&basis, &exact);
}

#[test]
fn solving_stops_when_asked() {
    let torus = flat_torus(40, 40, 1.0, 0.0, 1.0);
    for limit in [0.0, 0.1, 0.3, 0.9, 1.0] {
        let mut heard = 0;
        let error = spectrum(
            &torus.matrix,
            &torus.mass,
            40,
            &mut Progress::new(|stage, fraction| {
                heard += 1;
                assert_eq!(stage, Stage::Spectrum);
                fraction < limit
            }),
        );
        assert_eq!(error.map(|_| ()).expect_err("stopped").code(), "cancelled", "at {limit}");
        assert!(heard > 0);
    }
}
