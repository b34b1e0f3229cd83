//! The numbers that the native tests prove, and the bindings as JavaScript sees them.

use std::f64::consts::PI;

use crate::shapes::{Random, blob, distance, fibonacci_sphere, icosphere, laplacian, prepared, turn};
use geose_fmap::device::{Cpu, Device};
use geose_fmap::pipeline::match_shapes;
use geose_fmap::spectrum::spectrum;
use geose_fmap::wasm::{self, RawShape};
use geose_fmap::{LaplacianKind, MatchOptions, PrepareOptions, Progress, read};
use js_sys::{Array, Float32Array, Float64Array, Function, JSON, Reflect, Uint32Array};
use ndarray::Array2;
use wasm_bindgen::{JsCast, JsValue, closure::Closure};
use wasm_bindgen_test::wasm_bindgen_test;

const WOMAN: &[u8] = include_bytes!("../../www/public/samples/woman-standing.ply");
const MAN: &[u8] = include_bytes!("../../www/public/samples/man-standing.ply");

#[wasm_bindgen_test]
fn the_spectrum_of_the_sphere_is_l_times_l_plus_one_and_orthonormal() {
    for (soup, kind, tolerance) in [
        // 2562 points on 4π: neighbours are 0.07 apart, and the error of a mesh goes with the square of that times λ.
        (icosphere(4), LaplacianKind::Cotangent, 0.02),
        // Clouds estimate their area too.
        (fibonacci_sphere(2500), LaplacianKind::Geodesic, 0.1),
    ] {
        let operator = laplacian(&soup.shape(), kind);
        let area = operator.area() / (4.0 * PI);
        assert!((area - 1.0).abs() < tolerance, "{kind}: {area} of the area");
        let (basis, report) =
            spectrum(&operator.matrix, &operator.mass, 36, &mut Progress::silent()).expect("a spectrum");
        assert!(report.complete && report.residual < 1e-6, "{kind}: {report:?}");
        let exact = (0..6).flat_map(|l| vec![(l * (l + 1)) as f64; 2 * l + 1]);
        for (i, (found, exact)) in basis.eigenvalues.iter().zip(exact).enumerate() {
            assert!(
                (found - exact).abs() <= tolerance * exact + 1e-8,
                "{kind}: eigenvalue {i} is {found}, not {exact}"
            );
        }
        let weighted =
            Array2::from_shape_fn(basis.eigenvectors.dim(), |(i, j)| basis.mass[i] * basis.eigenvectors[(i, j)]);
        let off =
            (basis.eigenvectors.t().dot(&weighted) - Array2::<f64>::eye(36)).fold(0.0, |m: f64, x| m.max(x.abs()));
        assert!(off < 1e-8, "{kind}: ΦᵀMΦ is {off} away from I");
    }
}

#[wasm_bindgen_test]
fn matrix_products_and_nearest_rows_are_right_at_any_size() {
    let mut random = Random(7);
    for (n, k, m) in [(1, 1, 1), (5, 3, 7), (64, 17, 33), (130, 120, 65), (301, 61, 90)] {
        let mut matrix = |rows, cols| Array2::from_shape_simple_fn((rows, cols), || random.unit() as f32 - 0.5);
        let (a, b, t, y) = (matrix(n, k), matrix(k, m), matrix(n, m), matrix(m, k));
        let plain = |a: &Array2<f32>, b: &Array2<f32>| a.mapv(f64::from).dot(&b.mapv(f64::from));
        let far =
            |x: &Array2<f32>, exact: &Array2<f64>| (x.mapv(f64::from) - exact).fold(0.0, |m: f64, d| m.max(d.abs()));
        assert!(far(&Cpu.matmul(&a, &b), &plain(&a, &b)) < 1e-4, "a b at {n} {k} {m}");
        assert!(far(&Cpu.matmul_tn(&a, &t), &plain(&a.t().to_owned(), &t)) < 1e-4, "aᵀ b at {n} {k} {m}");
        let (nearest, _) = Cpu.nearest_rows(&a, &y, None);
        let squared = |i: usize, j: usize| (&a.row(i) - &y.row(j)).mapv(|d| f64::from(d).powi(2)).sum();
        for (i, &j) in nearest.iter().enumerate() {
            let least = (0..m).map(|j| squared(i, j)).fold(f64::INFINITY, f64::min);
            assert!(squared(i, j as usize) < least + 1e-4, "row {i} at {n} {k} {m}");
        }
    }
}

#[wasm_bindgen_test]
fn a_body_matches_its_turned_copy_point_for_point_and_twice_the_same() {
    let original = blob(3);
    let turned = original.moved(|p| turn(p).map(|x| 3.0 * x + 10.0));
    let options = PrepareOptions { eigenpairs: 40, ..PrepareOptions::default() };
    let (a, b) = (prepared(original.shape(), &options), prepared(turned.shape(), &options));
    let run = || {
        let (options, mut progress) = (MatchOptions::default(), Progress::silent());
        match_shapes(&a, &b, &options, &mut progress).expect("a match").a_to_b
    };
    let map = run();
    let right = map.target.iter().enumerate().filter(|&(i, &j)| i == j as usize).count();
    assert!(right as f64 >= 0.995 * map.target.len() as f64, "{right} of {} points", map.target.len());
    let again = run();
    assert_eq!((map.target, map.confidence), (again.target, again.confidence));
}

/// The network on the CPU.
async fn on_cpu() -> wasm::Device {
    wasm::open_device("cpu".into(), false, None).await.expect("the CPU")
}

#[wasm_bindgen_test]
async fn two_sample_bodies_match_through_the_bindings_with_every_stage_told() {
    let mut device = on_cpu().await;
    let told = Array::new();
    let listener = {
        let told = told.clone();
        Closure::<dyn FnMut(JsValue, f64)>::new(move |stage, fraction: f64| {
            assert!((0.0..=1.0).contains(&fraction));
            if told.at(-1) != stage {
                told.push(&stage);
            }
        })
    };
    let listener: &Function = listener.as_ref().unchecked_ref();
    let options = JSON::parse(r#"{ "points": 1000, "eigenpairs": 60 }"#).expect("JSON");
    let mut block = |bytes: &[u8]| {
        let scan = wasm::read_file(bytes, Some("body.ply".into()), None, None, &JsValue::UNDEFINED).expect("a scan");
        device.prepare(scan, options.clone(), listener).expect("a block")
    };
    let (woman, man) = (block(WOMAN), block(MAN));
    assert_eq!(String::from(told.join(" ")), ["sample laplacian spectrum features"; 2].join(" "));
    told.set_length(0);
    let matched = device.match_pair(woman, man, JsValue::UNDEFINED, listener).expect("a match");
    assert_eq!(String::from(told.join(" ")), "functional-map refine correspondence");

    let target: Uint32Array = get(&matched, "targetOf");
    let confidence: Float32Array = get(&matched, "confidence");
    assert_eq!((target.length(), confidence.length()), (5000, 5000));
    let map: JsValue = get(&matched, "functionalMap");
    assert_eq!(get::<Float64Array>(&map, "data").length(), 60 * 60);
    let weights: JsValue = get(&get::<JsValue>(&matched, "report"), "weights");
    assert!(["name", "version"].iter().all(|key| get::<JsValue>(&weights, key).is_string()), "{weights:?}");
    // Point i of one sample is point i of the other.
    let man = read(MAN, None, None).expect("a scan");
    let far = |(i, j): (usize, u32)| distance(man.points()[i], man.points()[j as usize]);
    let mean = target.to_vec().into_iter().enumerate().map(far).sum::<f64>() / 5000.0;
    assert!(mean < 0.05, "points land {mean} m from where they belong");
}

#[wasm_bindgen_test]
async fn an_error_is_a_plain_object_with_a_code_a_sentence_and_numbers() {
    let (mut device, silent) = (on_cpu().await, Function::new_no_args(""));
    let unread = device.match_pair(vec![1, 2, 3], Vec::new(), JsValue::UNDEFINED, &silent).err();
    let small = || wasm::read_arrays(icosphere(2).points.as_flattened(), None, None, None);
    let mut ready = |options: &str| small().and_then(|scan| device.prepare(scan, JSON::parse(options)?, &silent));
    let failures = [
        ("too-few-points", wasm::read_arrays(&[0.0; 30], None, None, None).err()),
        ("ragged-array", wasm::read_arrays(&[0.0; 301], None, None, None).err()),
        ("truncated-file", wasm::read_file(&WOMAN[..WOMAN.len() / 2], None, None, None, &JsValue::UNDEFINED).err()),
        ("invalid-option", ready(r#"{ "eigenparis": 20 }"#).err()),
        ("invalid-option", ready(r#"{ "eigenpairs": 3 }"#).err()),
        ("invalid-block", unread),
    ];
    for (code, failure) in failures {
        let failure = failure.unwrap_or_else(|| panic!("{code}: no error"));
        assert_eq!(get::<JsValue>(&failure, "code").as_string().as_deref(), Some(code), "{failure:?}");
        assert!(get::<JsValue>(&failure, "message").as_string().is_some_and(|message| message.len() > 10));
        assert!(get::<JsValue>(&failure, "details").is_object());
    }
    let details: JsValue = get(&wasm::read_arrays(&[0.0; 30], None, None, None).err().expect("an error"), "details");
    assert_eq!(get::<JsValue>(&details, "found").as_f64(), Some(10.0));
}

#[wasm_bindgen_test]
fn a_healthy_instance_has_refused_nothing_and_a_laplacian_goes_there_and_back() {
    let silent = Function::new_no_args("");
    let soup = icosphere(2);
    let scan: RawShape =
        wasm::read_arrays(soup.points.as_flattened(), Some(soup.faces.as_flattened().to_vec()), None, None)
            .expect("a scan");
    let operator = wasm::laplacian(scan, JsValue::UNDEFINED, &silent).expect("a laplacian");
    assert_eq!(get::<JsValue>(&operator, "kind").as_string().as_deref(), Some("cotangent"));
    let (indptr, indices): (Uint32Array, Uint32Array) = (get(&operator, "indptr"), get(&operator, "indices"));
    let (values, mass): (Float64Array, Float64Array) = (get(&operator, "values"), get(&operator, "mass"));
    let options = JSON::parse(r#"{ "eigenpairs": 9 }"#).expect("JSON");
    let found = wasm::spectrum(&indptr.to_vec(), &indices.to_vec(), values.to_vec(), &mass.to_vec(), options, &silent);
    let eigenvalues: Float64Array = get(&found.expect("a spectrum"), "eigenvalues");
    assert_eq!(eigenvalues.length(), 9);
    assert!((eigenvalues.get_index(1) - 2.0).abs() < 0.1);
    assert_eq!(wasm::refused_bytes(), 0.0);
    assert!(wasm::memory_bytes() > 0.0);
    assert_eq!(wasm::version(), env!("CARGO_PKG_VERSION"));
}

/// A property that has to be there, as its type.
fn get<T: JsCast>(object: &JsValue, name: &str) -> T {
    let value = Reflect::get(object, &name.into()).expect("an object");
    value.dyn_into().unwrap_or_else(|value| panic!("{name} is {value:?}"))
}
