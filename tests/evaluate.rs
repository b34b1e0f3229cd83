//! The command line measures what the protocol says, and refuses what it cannot measure in a sentence.
#![cfg(not(target_arch = "wasm32"))]

#[path = "evaluate/command_line.rs"]
mod command_line;
#[path = "evaluate/measures.rs"]
mod measures;
mod shapes;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use geose_fmap::uses::part_scores;
use serde_json::Value;
use shapes::{Soup, blob, sheet, turn};

/// A data set in a folder of its own.
struct Set {
    folder: PathBuf,
}

/// How a run of the program ended.
struct Run {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Set {
    /// An empty one. `name` may hold a folder, for sets that know each other.
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("evaluate").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        for inner in ["shapes", "corres", "labels"] {
            std::fs::create_dir_all(folder.join(inner)).expect("a folder");
        }
        Self { folder }
    }

    fn write(&self, file: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.folder.join(file), text).expect("a file");
    }

    fn shape(&self, name: &str, soup: &Soup) {
        let mut text = format!("OFF\n{} {} 0\n", soup.points.len(), soup.faces.len());
        soup.points.iter().for_each(|[x, y, z]| writeln!(text, "{x} {y} {z}").expect("text"));
        soup.faces.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").expect("text"));
        self.write(&format!("shapes/{name}.off"), text);
    }

    /// A file with one whole number a line.
    fn column(&self, file: &str, values: impl IntoIterator<Item = usize>) {
        self.write(file, values.into_iter().map(|v| format!("{v}\n")).collect::<String>());
    }

    fn run(&self, options: &[&str]) -> Run {
        run(&[&["evaluate", "--dataset", self.folder.to_str().expect("text")], options].concat())
    }

    /// The JSON of a run that must succeed.
    fn measured(&self, options: &[&str]) -> Value {
        let file = self.folder.join("measured.json");
        let run = self.run(&[options, &["--json", file.to_str().expect("text")]].concat());
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert!(!run.out.is_empty(), "people read too");
        serde_json::from_slice(&std::fs::read(file).expect("a file")).expect("JSON")
    }

    /// What a run that must fail says.
    fn refusal(&self, options: &[&str]) -> String {
        let run = self.run(options);
        assert_eq!(run.code, Some(1), "{}{}", run.out, run.err);
        let sentence = run.err.lines().last().expect("a sentence").to_owned();
        assert!(sentence.starts_with("geose-fmap: "), "{}", run.err);
        sentence
    }
}

fn run(arguments: &[&str]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_geose-fmap")).args(arguments).output().expect("a program");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    Run { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is a number"))
}

fn assert_near(value: &Value, wanted: f64) {
    assert!((number(value) - wanted).abs() < 1e-9 * wanted.abs().max(1.0), "{value}, not {wanted}");
}

/// A plane of 61 by 31 points, half a unit apart one way and one the other: √area = 30, so one step is 0.0167 or
/// 0.0333.
fn plane() -> Soup {
    sheet(61, 31).moved(|[x, y, z]| [0.5 * x, y, z])
}

const COLUMNS: usize = 31;

const POINTS: usize = 61 * COLUMNS;

/// 1-based number of a point of the plane.
fn at(i: usize, j: usize) -> usize {
    i * COLUMNS + j + 1
}

/// Two planes, one of them turned. The truth is each point itself, but for three points, and two more that no line
/// names.
fn planes(name: &str) -> Set {
    let set = Set::new(name);
    set.shape("flat", &plane());
    set.shape("turned", &plane().moved(turn));
    set.write("pairs.txt", "flat turned\n");
    let named: Vec<usize> = (1..=POINTS).filter(|&v| v != at(5, 5) && v != at(9, 9)).collect();
    // One step of ½, one of 1, three of 1: beyond 0.01, beyond 0.02 and beyond 0.05.
    let truth = |v: usize| match v {
        v if v == at(20, 10) => at(21, 10),
        v if v == at(30, 20) => at(30, 21),
        v if v == at(40, 15) => at(40, 18),
        v => v,
    };
    set.column("corres/flat.vts", named.iter().copied());
    set.column("corres/turned.vts", named.iter().map(|&v| truth(v)));
    set
}

const ORACLE: [&str; 5] = ["--mode", "mesh", "--oracle", "--eigenpairs", "60"];

/// Two copies of a blob without symmetry, one turned and renumbered by `order`.
fn blobs(set: &Set, names: [&str; 2], order: &[u32]) {
    set.shape(names[0], &blob(3));
    set.shape(names[1], &blob(3).moved(turn).renumbered(order));
    set.write("pairs.txt", names.join(" "));
}

const MATCH: [&str; 2] = ["--eigenpairs", "60"];
