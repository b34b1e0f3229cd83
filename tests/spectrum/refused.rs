//! What has no spectrum is refused, with what is wrong about it.

use super::*;

fn refused(matrix: &CsMat<f64>, mass: &[f64], k: usize) -> SpectrumError {
    spectrum(matrix, mass, k, &mut Progress::silent()).map(|(_, report)| report).expect_err("must be refused")
}

#[test]
fn masses_that_are_no_masses_are_refused_with_their_index() {
    let torus = flat_torus(20, 20, 1.0, 0.0, 1.0);
    for poison in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut mass = torus.mass.clone();
        mass[17] = poison;
        let error = refused(&torus.matrix, &mass, 10);
        assert_eq!(error.code(), "invalid-mass", "{poison}");
        assert!(matches!(error, SpectrumError::InvalidMass { index: 17, .. }), "{poison}: {error}");
    }
}

#[test]
fn matrices_that_do_not_fit_or_are_not_by_rows_are_refused() {
    let torus = flat_torus(20, 20, 1.0, 0.0, 1.0);
    assert_eq!(refused(&torus.matrix, &torus.mass[1..], 10).code(), "invalid-matrix");
    assert_eq!(refused(&torus.matrix.to_csc(), &torus.mass, 10).code(), "invalid-matrix");
    let wide = from_weights(401, [(0, 400, 1.0)]).slice_outer(0..400).to_owned();
    assert_eq!(refused(&wide, &torus.mass, 10).code(), "invalid-matrix");
    assert_eq!(refused(&CsMat::zero((0, 0)), &[], 10), SpectrumError::TooFewPoints { found: 0 });
    assert_eq!(refused(&CsMat::zero((60, 60)), &[0.0; 60], 10), SpectrumError::TooFewPoints { found: 0 });
}

/// A small one is solved densely, a large one by iteration: both must refuse.
fn small_and_large() -> [Known; 2] {
    [flat_torus(9, 9, 1.0, 0.0, 1.0), flat_torus(30, 30, 1.0, 0.0, 1.0)]
}

#[test]
fn poisoned_matrices_are_refused() {
    for known in small_and_large() {
        for poison in [f64::NAN, f64::INFINITY] {
            for slot in [0, 7, known.matrix.nnz() - 1] {
                let mut matrix = known.matrix.clone();
                matrix.data_mut()[slot] = poison;
                let error = refused(&matrix, &known.mass, 20);
                assert!(error.code() == "invalid-matrix", "{poison} at {slot}: {error}");
            }
        }
    }
}

#[test]
fn indefinite_matrices_are_refused() {
    for known in small_and_large() {
        let negated = known.matrix.map(|v| -v);
        assert_eq!(refused(&negated, &known.mass, 20).code(), "not-factorised", "−L");
        for sink in [0.01, 0.5, 10.0] {
            let mut sunk = known.matrix.clone();
            for i in 0..sunk.rows() {
                *sunk.get_mut(i, i).expect("a diagonal") -= sink;
            }
            assert_eq!(refused(&sunk, &known.mass, 20).code(), "not-factorised", "L − {sink} M");
        }
        let mut dented = known.matrix.clone();
        *dented.get_mut(40, 40).expect("a diagonal") -= 3.0;
        assert_eq!(refused(&dented, &known.mass, 20).code(), "not-factorised", "one bad entry");
    }
}

#[test]
fn matrices_that_are_not_symmetric_are_refused() {
    for known in small_and_large() {
        let mut matrix = known.matrix.clone();
        *matrix.get_mut(3, 4).expect("an edge") -= 0.3;
        *matrix.get_mut(3, 3).expect("a diagonal") += 0.3;
        assert_eq!(refused(&matrix, &known.mass, 20).code(), "invalid-matrix");
        let mut one_sided = TriMat::new(known.matrix.shape());
        known.matrix.iter().for_each(|(&v, (i, j))| {
            if i <= j {
                one_sided.add_triplet(i, j, v)
            }
        });
        assert_eq!(refused(&one_sided.to_csr(), &known.mass, 20).code(), "invalid-matrix", "upper triangle");
    }
}
