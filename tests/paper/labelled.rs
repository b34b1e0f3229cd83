//! A folder of labelled scans of one's own is trained on, and what was kept is measured.

use super::*;

/// The label sets and meshes of the samples as a folder in the layout of `evaluate`: bodies cut down to clouds, all in the order of one template.
fn labelled_folder(name: &str, parts: u32) -> PathBuf {
    let folder = folder(name);
    for part in ["shapes", "labels", "corres"] {
        fs::create_dir_all(folder.join(part)).expect("a folder");
    }
    let names = ["woman-standing.ply", "woman-striding.ply", "man-standing.ply", "man-lunging.ply"];
    for (i, name) in (0..6).map(|i| (i, names[i % 4])) {
        let (points, faces, labels) = simplified(name, 300 + 20 * i);
        let lines = |rows: &[u32]| rows.iter().map(|row| format!("{row}\n")).collect::<String>();
        let off = format!(
            "OFF\n{} {} 0\n{}{}",
            points.len(),
            faces.len(),
            points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect::<String>(),
            faces.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect::<String>()
        );
        fs::write(folder.join(format!("shapes/scan_{i}.off")), off).expect("written");
        let labels: Vec<u32> = labels.iter().map(|label| label % parts).collect();
        fs::write(folder.join(format!("labels/scan_{i}.txt")), lines(&labels)).expect("written");
        // A truth is needed to measure, not to learn: any vertices do.
        let truth: Vec<u32> = (1..=50).collect();
        fs::write(folder.join(format!("corres/scan_{i}.vts")), lines(&truth)).expect("written");
    }
    let names: Vec<String> = (0..parts).map(|part| format!("piece {part}")).collect();
    fs::write(folder.join("labels.json"), serde_json::to_string(&names).expect("JSON")).expect("written");
    folder
}

/// A ring of squares around the axis of a sample body is enough of a mesh: a tube through its points, with the labels of the nearest ones.
fn simplified(name: &str, count: usize) -> (Vec<[f64; 3]>, Vec<[u32; 3]>, Vec<u32>) {
    let whole = body(name);
    let labels = whole.labels().expect("labels");
    let (around, along) = (12, count / 12);
    let mut points = Vec::new();
    for i in 0..along {
        let height = 0.05 + 1.5 * i as f64 / along as f64;
        for j in 0..around {
            let angle = std::f64::consts::TAU * j as f64 / around as f64;
            points.push([0.2 * angle.cos(), height, (0.1 + 0.05 * height) * angle.sin()]);
        }
    }
    let at = |i: usize, j: usize| (i * around + j % around) as u32;
    let mut faces = Vec::new();
    for (i, j) in (0..along - 1).flat_map(|i| (0..around).map(move |j| (i, j))) {
        faces.extend([[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]]);
    }
    let square = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>();
    let nearest = |p: &[f64; 3]| {
        let best = (0..whole.points().len())
            .min_by(|&i, &j| square(&whole.points()[i], p).total_cmp(&square(&whole.points()[j], p)));
        labels[best.expect("points")]
    };
    let of_points = points.iter().map(nearest).collect();
    (points, faces, of_points)
}

/// From a folder of labelled scans to measured weights, with three parts of one's own and the paper's network cut down.
#[test]
fn labelled_scans_are_trained_on_and_what_was_kept_is_measured() {
    let (data, out) = (labelled_folder("labelled", 3), folder("labelled-out"));
    let small = r#"{"width": 8, "blocks": 1, "features": 8, "attention": 4, "eigenpairs": 30, "map": 30}"#;
    let trained = Command::new(env!("CARGO_BIN_EXE_train"))
        .args(["--paper", "--points", "200", "--network", small, "--run", r#"{"steps": 3, "batch": 2}"#])
        .arg("--data")
        .arg(&data)
        .arg("--out")
        .arg(&out)
        .output()
        .expect("run");
    assert!(trained.status.success(), "{}", String::from_utf8_lossy(&trained.stderr));
    let said = String::from_utf8_lossy(&trained.stdout);
    assert!(said.contains("4 scans to train on, 2 to test with"), "{said}");
    let weights = Weights::from_bytes(&fs::read(out.join("weights.safetensors")).expect("written")).expect("weights");
    assert_eq!((weights.category.parts.len(), weights.config.norm), (3, Norm::Batch));
    assert!(named(&weights, "block0.norm.variance").iter().any(|&v| v != 1.0), "statistics were followed");
    let pairs = fs::read_to_string(out.join("test-pairs.txt")).expect("written");
    assert_eq!(pairs.lines().count(), 2);
    // Each of those trained on as a mesh and as a cloud, and none of the others.
    let samples = fs::read_dir(out.join("samples")).expect("there").filter(|entry| {
        entry.as_ref().is_ok_and(|entry| entry.path().extension().is_some_and(|extension| extension == "sample"))
    });
    assert_eq!(samples.count(), 8);

    for parts in ["given", "predicted"] {
        let measured = Command::new(env!("CARGO_BIN_EXE_geose-fmap"))
            .args([
                "evaluate",
                "--mode",
                "cloud",
                "--network-only",
                "--refine",
                "none",
                "--json",
                "-",
                "--eigenpairs",
                "60",
            ])
            .args(["--parts", parts])
            .arg("--dataset")
            .arg(&data)
            .arg("--pairs")
            .arg(out.join("test-pairs.txt"))
            .arg("--weights")
            .arg(out.join("weights.safetensors"))
            .output()
            .expect("run");
        assert!(measured.status.success(), "{}", String::from_utf8_lossy(&measured.stderr));
        let found: serde_json::Value = serde_json::from_slice(&measured.stdout).expect("JSON");
        assert_eq!(found["pairs"], 2);
        assert!(found["age"].as_f64().is_some_and(f64::is_finite), "{found}");
    }
}

#[test]
fn folds_of_labelled_scans_keep_both_samples_of_a_scan_together() {
    let data = labelled_folder("labelled-folds", 14);
    let scans = LabelledScans::open(&data).expect("labelled scans");
    let config = ModelConfig { width: 6, blocks: 1, features: 6, eigenpairs: 20, map: 20, ..network() };
    let samples = SampleConfig { scans: Some(scans.scans()), ..SampleConfig::of(&config, 200) };
    let pool = Pool::open(&folder("labelled-fold-samples"), scans.samples(), &samples).expect("opened");
    let pool = pool.per_body(scans.per_scan());
    pool.fill(&scans.maker(&samples), &AtomicUsize::new(0), &AtomicBool::new(false));
    pool.check().expect("made");
    assert_eq!((pool.count, pool.bodies(), pool.body(0), pool.body(1), pool.body(2)), (8, 4, 0, 0, 1));
    let (mesh, cloud) = (pool.get(0).expect("a mesh"), pool.get(1).expect("a cloud"));
    assert_eq!((mesh.labels.len(), mesh.labels == cloud.labels), (cloud.labels.len(), true));
    assert_ne!(mesh.inputs.lambda, cloud.inputs.lambda, "another operator");
    let run = RunConfig { steps: 2, maps_from: 0, ..RunConfig::default() };
    let best = cross_validate(&config, &[run], 2, &pool, &folder("labelled-folds-out")).expect("trained");
    assert_eq!(best, Some(0));
}

#[test]
fn a_folder_that_is_neither_is_refused_by_what_it_lacks() {
    let (empty, out) = (folder("neither"), folder("neither-out"));
    let tried = Command::new(env!("CARGO_BIN_EXE_train"))
        .arg("--data")
        .arg(&empty)
        .arg("--out")
        .arg(&out)
        .output()
        .expect("run");
    let said = String::from_utf8_lossy(&tried.stderr);
    assert!(!tried.status.success() && said.contains("there is no shapes/") && said.contains("generator"), "{said}");
}
