//! Every op and every loss of training has the gradient that finite differences find.
#![cfg(feature = "train")]

use candle_core::{Tensor, Var};
use geose_fmap::device::{Cpu, Device, Mask};
use geose_fmap::network::Solver;
use geose_fmap::train::device::{Autodiff, cross_entropy_rows, matrix, tensor};
use geose_fmap::train::losses::{LossWeights, Side, losses, one_hot};
use ndarray::Array2;

/// Smooth, without symmetry, of size about 1.
fn values(rows: usize, cols: usize, seed: usize) -> Array2<f32> {
    Array2::from_shape_fn((rows, cols), |(i, j)| {
        let x = (seed * 131 + i * 17 + j * 7) as f64;
        ((x * 0.7391).sin() + 0.6 * (x * 1.913).cos()) as f32
    })
}

/// Compares the gradient of Σ w ⊙ f(inputs), w fixed, in every input with central differences along a direction that touches every entry.
fn check(name: &str, inputs: &[Array2<f32>], function: impl Fn(&[Tensor]) -> Tensor) {
    let loss = |inputs: &[Tensor]| {
        let out = function(inputs);
        let (rows, cols) = out.dims2().unwrap_or((1, 1));
        let out = out.reshape((rows, cols)).unwrap();
        (out * tensor(values(rows, cols, 99).view())).unwrap().sum_all().unwrap()
    };
    let at = |inputs: &[Array2<f32>]| {
        let tensors: Vec<Tensor> = inputs.iter().map(|x| tensor(x.view())).collect();
        f64::from(loss(&tensors).to_scalar::<f32>().unwrap())
    };
    let vars: Vec<Var> = inputs.iter().map(|x| Var::from_tensor(&tensor(x.view())).unwrap()).collect();
    let tensors: Vec<Tensor> = vars.iter().map(|v| v.as_tensor().clone()).collect();
    let grads = loss(&tensors).backward().unwrap();
    for (which, var) in vars.iter().enumerate() {
        let grad = matrix(grads.get(var.as_tensor()).unwrap_or_else(|| panic!("{name}: no gradient for {which}")));
        for direction in 0..3 {
            let (rows, cols) = grad.dim();
            let along = values(rows, cols, 7 + direction);
            let step = 4e-3;
            let moved = |by: f32| {
                let mut inputs = inputs.to_vec();
                inputs[which].scaled_add(by, &along);
                at(&inputs)
            };
            let numeric = (moved(step) - moved(-step)) / (2.0 * f64::from(step));
            let analytic: f64 = grad.iter().zip(&along).map(|(g, a)| f64::from(*g) * f64::from(*a)).sum();
            let size = grad.iter().map(|g| f64::from(*g).abs()).sum::<f64>() * 0.3 + 0.05;
            assert!(
                (numeric - analytic).abs() < 0.02 * size,
                "{name}, input {which}: differences say {numeric}, the backward pass {analytic} (size {size})"
            );
        }
    }
}

#[test]
fn ops_have_the_gradients_that_differences_find() {
    let d = Autodiff;
    check("matmul", &[values(5, 4, 1), values(4, 3, 2)], |x| d.matmul(&x[0], &x[1]));
    check("matmul_tn", &[values(5, 4, 1), values(5, 3, 2)], |x| d.matmul_tn(&x[0], &x[1]));
    check("matmul_nt", &[values(5, 4, 1), values(3, 4, 2)], |x| d.matmul_nt(&x[0], &x[1]));
    check("linear", &[values(5, 4, 1), values(4, 3, 2), values(1, 3, 3)], |x| d.linear(&x[0], &x[1], &x[2]));
    check("layer_norm", &[values(5, 6, 1), values(1, 6, 2), values(1, 6, 3)], |x| d.layer_norm(&x[0], &x[1], &x[2]));
    check("multiply", &[values(5, 4, 1), values(5, 4, 2)], |x| d.multiply(&x[0], &x[1]));
    check("tanh", &[values(5, 4, 1)], |x| d.tanh(&x[0]));
    check("diffuse", &[values(4, 3, 1), values(1, 3, 2)], |x| {
        d.diffuse(&x[0], &tensor(values(4, 1, 3).mapv(f32::abs).view()), &x[1])
    });
    check("cross_pairs", &[values(5, 3, 1)], |x| d.cross_pairs(&x[0]));
    check("normalize_rows", &[values(5, 4, 1)], |x| d.normalize_rows(&x[0]));
    check("softmax_rows", &[values(5, 4, 1)], |x| d.softmax_rows(&x[0]));
    // Rows of shares, and one of nothing.
    let mut shares = matrix(&d.softmax_rows(&tensor(values(5, 4, 6).view())));
    shares.row_mut(3).fill(0.0);
    check("cross_entropy_rows", &[values(5, 4, 1)], |x| cross_entropy_rows(&x[0], &tensor(shares.view())).unwrap());
    check("concat and add", &[values(5, 4, 1), values(5, 4, 2)], |x| {
        d.concat(&[(&d.add(&x[0], &x[1], 0.3), 2.0), (&x[1], 1.0)])
    });
    check("gather", &[values(5, 4, 1)], |x| d.gather(&x[0], &vec![3, 3, 0]));
    let parts = |n, seed| d.softmax_rows(&tensor(values(n, 3, seed).view()));
    check("attend", &[values(6, 4, 1), values(5, 4, 2), values(5, 3, 3)], |x| {
        d.attend((&x[0], &parts(6, 4)), (&x[1], &parts(5, 5)), &x[2], Mask::Soft)
    });
    // The last query is of a part that no key has.
    let one_part = |n: usize, last| {
        tensor(one_hot(&(0..n).map(|i| if i == 5 { last } else { i as u32 % 2 }).collect::<Vec<_>>(), 3).view())
    };
    check("attend within parts", &[values(6, 4, 1), values(5, 4, 2), values(5, 3, 3)], |x| {
        d.attend((&x[0], &one_part(6, 2)), (&x[1], &one_part(5, 0)), &x[2], Mask::Hard)
    });
    let statistics = [values(1, 4, 4), values(1, 4, 5).mapv(|v| v * v + 0.3)];
    check(
        "batch_norm",
        &[values(5, 4, 1), values(1, 4, 2), values(1, 4, 3), statistics[0].clone(), statistics[1].clone()],
        |x| d.batch_norm(&x[0], (&x[3], &x[4]), &x[1], &x[2]),
    );
    check("solve_rows", &[values(4, 7, 1), values(5, 4, 2)], |x| {
        let mask = values(5, 4, 3).mapv(f32::abs);
        d.solve_rows(&d.matmul_nt(&x[0], &x[0]), &x[1], &tensor(mask.view()))
    });
}

#[test]
fn relu_passes_gradients_where_it_passes_values() {
    let var = Var::from_tensor(&tensor(ndarray::array![[-1.0, 2.0, -0.5, 0.25]].view())).unwrap();
    let grads = Autodiff.relu(var.as_tensor()).sum_all().unwrap().backward().unwrap();
    assert_eq!(matrix(grads.get(var.as_tensor()).unwrap()), ndarray::array![[0.0, 1.0, 0.0, 1.0]]);
}

/// Each of the losses by itself, so that none can hide behind another.
#[test]
fn losses_have_the_gradients_that_differences_find() {
    let none = LossWeights {
        parts: 0.0,
        bijectivity: 0.0,
        orthogonality: 0.0,
        coupling: 0.0,
        places: 0.0,
        near_weight: 0.0,
        extent: 0.0,
        semantic: 0.0,
        eigen: 0.0,
        features_orthogonal: 0.0,
        temperature: 0.5,
        semantic_temperature: 0.5,
    };
    let single = [
        ("parts", LossWeights { parts: 1.0, ..none.clone() }),
        ("bijectivity", LossWeights { bijectivity: 1.0, ..none.clone() }),
        ("orthogonality", LossWeights { orthogonality: 1.0, ..none.clone() }),
        ("coupling", LossWeights { coupling: 1.0, ..none.clone() }),
        ("places", LossWeights { places: 1.0, ..none.clone() }),
        ("places by distance", LossWeights { places: 1.0, near_weight: 0.5, ..none.clone() }),
        ("semantic", LossWeights { semantic: 1.0, ..none.clone() }),
        ("eigen", LossWeights { eigen: 1.0, ..none.clone() }),
        ("features_orthogonal", LossWeights { features_orthogonal: 1.0, ..none }),
    ];
    let (n, m, k, f) = (9, 8, 4, 5);
    let lambda = [0.0, 0.4, 0.9, 1.3];
    let phi = [tensor(values(n, k, 31).view()), tensor(values(m, k, 32).view())];
    let projector = [0, 1].map(|i: usize| phi[i].affine(0.1, 0.0).unwrap());
    let labels = |n: usize| (0..n).map(|i| (i % 3) as u32).collect::<Vec<u32>>();
    let labels = [n, m].map(|n| tensor(one_hot(&labels(n), 3).view()));
    // On a path of the atlas, a hundredth of √area apart; the last of A is far from all of B.
    let places = [n, m].map(|n| Array2::from_shape_fn((n, 3), |(i, _)| if i == 8 { 9.0 } else { 0.01 * i as f32 }));
    for (name, weights) in single {
        let of_features = weights.parts == 0.0;
        let inputs =
            if of_features { [values(n, f, 41), values(m, f, 42)] } else { [values(n, 3, 41), values(m, 3, 42)] };
        check(name, &inputs, |x| {
            let still = [tensor(values(n, 3, 51).view()), tensor(values(m, 3, 52).view())];
            let unit = [Autodiff.normalize_rows(&x[0]), Autodiff.normalize_rows(&x[1])];
            let [a, b] = [0, 1].map(|i: usize| Side {
                features: &unit[i],
                logits: if of_features { &still[i] } else { &x[i] },
                labels: &labels[i],
                phi: &phi[i],
                projector: &projector[i],
                lambda: &lambda,
                places: Some(&places[i]),
            });
            let terms = losses(&weights, Solver::Masked, &a, &b, true).unwrap();
            assert_eq!(terms.len(), 1, "{name} alone");
            terms[0].2.clone()
        });
    }
}

/// The training device is the shipped one plus gradients: same values for every op.
#[test]
fn training_computes_what_the_cpu_computes() {
    let (d, x, y) = (Autodiff, values(70, 6, 1), values(33, 6, 2));
    let (gain, bias) = (values(1, 6, 3), values(1, 6, 4));
    let (tx, ty, tg, tb) = (tensor(x.view()), tensor(y.view()), tensor(gain.view()), tensor(bias.view()));
    let same = |name: &str, ours: Array2<f32>, theirs: Tensor| {
        let theirs = matrix(&theirs);
        assert_eq!(ours.dim(), theirs.dim(), "{name}");
        let apart = (&ours - &theirs).iter().fold(0.0f32, |m, v| m.max(v.abs()));
        assert!(apart < 2e-5, "{name}: {apart}");
    };
    let (square, ts) = (values(6, 6, 5), tensor(values(6, 6, 5).view()));
    same("matmul", Cpu.matmul(&x, &square), d.matmul(&tx, &ts));
    same("matmul_tn", Cpu.matmul_tn(&x, &x), d.matmul_tn(&tx, &tx));
    same("linear", Cpu.linear(&x, &square, &bias), d.linear(&tx, &ts, &tb));
    same("multiply", Cpu.multiply(&x, &x), d.multiply(&tx, &tx));
    same("add", Cpu.add(&x, &x, -0.3), d.add(&tx, &tx, -0.3));
    same("concat", Cpu.concat(&[(&x, 0.5), (&x, 1.0)]), d.concat(&[(&tx, 0.5), (&tx, 1.0)]));
    same("gather", Cpu.gather(&x, &vec![69, 0, 3]), d.gather(&tx, &vec![69, 0, 3]));
    same("leading_columns", Cpu.leading_columns(&x, 2), d.leading_columns(&tx, 2));
    same("matmul_nt", Cpu.matmul_nt(&x, &y), d.matmul_nt(&tx, &ty));
    same("layer_norm", Cpu.layer_norm(&x, &gain, &bias), d.layer_norm(&tx, &tg, &tb));
    same("tanh", Cpu.tanh(&x), d.tanh(&tx));
    same("relu", Cpu.relu(&x), d.relu(&tx));
    same("normalize_rows", Cpu.normalize_rows(&x), d.normalize_rows(&tx));
    same("softmax_rows", Cpu.softmax_rows(&x), d.softmax_rows(&tx));
    let lambda = x.column(0).mapv(f32::abs).insert_axis(ndarray::Axis(1));
    same("diffuse", Cpu.diffuse(&x, &lambda, &bias), d.diffuse(&tx, &tensor(lambda.view()), &tb));
    let three = x.slice(ndarray::s![..9, ..3]).to_owned();
    same("cross_pairs", Cpu.cross_pairs(&three), d.cross_pairs(&tensor(three.view())));
    let (p, q) = (Cpu.softmax_rows(&x), Cpu.softmax_rows(&y));
    let (tp, tq) = (tensor(p.view()), tensor(q.view()));
    for mask in [Mask::Soft, Mask::Hard] {
        same("attend", Cpu.attend((&x, &p), (&y, &q), &y, mask), d.attend((&tx, &tp), (&ty, &tq), &ty, mask));
    }
    let variance = bias.mapv(|v| v * v + 0.1);
    let tv = tensor(variance.view());
    same("batch_norm", Cpu.batch_norm(&x, (&gain, &variance), &bias, &gain), d.batch_norm(&tx, (&tg, &tv), &tb, &tg));
    let gram = Cpu.matmul_tn(&x, &x);
    let mask = y.mapv(f32::abs);
    same("solve_rows", Cpu.solve_rows(&gram, &y, &mask), d.solve_rows(&tensor(gram.view()), &ty, &tensor(mask.view())));
}
