//! Every program in `examples/` runs and says what it promises. Cargo builds them before the tests; `cargo test --test examples` alone does not.
#![cfg(not(target_arch = "wasm32"))]

mod shapes;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::{env, fs};

use shapes::body;

/// A folder with two clouds of body points with part labels.
static CLOUDS: LazyLock<[PathBuf; 2]> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("examples");
    fs::create_dir_all(&folder).expect("a folder");
    ["woman-standing", "man-lunging"].map(|name| {
        let shape = body(&format!("{name}.ply"));
        let labels = shape.labels().expect("sample bodies have labels");
        let rows: Vec<String> = (0..shape.points().len())
            .step_by(4)
            .map(|i| {
                let [x, y, z] = shape.points()[i];
                format!("{x} {y} {z} {}", labels[i])
            })
            .collect();
        let head = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar label\nend_header\n",
            rows.len()
        );
        let path = folder.join(format!("{name}.ply"));
        fs::write(&path, head + &rows.join("\n") + "\n").expect("written");
        path
    })
});

/// What the example prints.
fn run(name: &str, arguments: &[&Path]) -> String {
    let own = env::current_exe().expect("a path");
    let folder = own.parent().and_then(Path::parent).expect("target/…/deps/").join("examples");
    let program = folder.join(format!("{name}{}", env::consts::EXE_SUFFIX));
    let ran = Command::new(&program).args(arguments).output();
    let ran = ran.unwrap_or_else(|e| panic!("{}: {e}; `cargo test` without --test builds it", program.display()));
    assert!(ran.status.success(), "{name}: {}", String::from_utf8_lossy(&ran.stderr));
    String::from_utf8(ran.stdout).expect("text")
}

#[test]
fn two_files_become_a_map() {
    let [a, b] = &*CLOUDS;
    let map = run("two_files", &[a, b]);
    assert_eq!(map.lines().next(), Some("source,target,confidence"));
    assert_eq!(map.lines().count(), 1 + 1250);
}

#[test]
fn landmarks_go_where_they_are_said_to() {
    let [a, b] = &*CLOUDS;
    let said = run("landmarks", &[a, b, Path::new("10:10"), Path::new("700:700")]);
    assert!(said.contains("10 -> 10 (wanted 10)") && said.contains("700 -> 700 (wanted 700)"), "{said}");
}

#[test]
fn points_with_labels_stay_in_their_part() {
    let [a, b] = &*CLOUDS;
    let said = run("given_parts", &[a, b]);
    let kept: usize = said.split(' ').next().and_then(|word| word.parse().ok()).expect("a count");
    assert!(kept > 1240 && said.contains("of 1250 points"), "{said}");
}

#[test]
fn a_spectrum_alone_begins_with_zero() {
    let said = run("spectrum", &[&CLOUDS[0]]);
    assert!(said.contains("geodesic Laplacian of 1250 points") && said.contains("  0 "), "{said}");
    let first: f64 = said.lines().nth(2).and_then(|line| line.split_whitespace().nth(1)?.parse().ok()).expect("λ₀");
    assert!(first.abs() < 1e-6, "{said}");
}

#[test]
fn weights_of_ones_own_are_named_with_what_they_know() {
    let [a, b] = &*CLOUDS;
    let weights = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/weights/people.safetensors");
    let said = run("own_weights", &[&weights, a, b]);
    assert!(said.contains("which knows people: head, torso") && said.contains("taken for: people"), "{said}");
}

#[test]
fn a_stored_scan_comes_back() {
    let stored = CLOUDS[0].with_extension("gsf");
    let said = run("save_and_load", &[&CLOUDS[0], &stored]);
    let own: usize = said.split(' ').next().and_then(|word| word.parse().ok()).expect("a count");
    assert!(own > 1200 && said.contains("of 1250 points"), "{said}");
}

#[test]
fn no_example_is_left_out() {
    let tested = ["given_parts", "landmarks", "own_weights", "save_and_load", "spectrum", "two_files"];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut found: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path().file_stem().expect("a name").to_string_lossy().into_owned())
        .collect();
    found.sort();
    assert_eq!(found, tested);
}
