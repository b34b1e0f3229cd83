//! The targets of `tests/fuzzing` as libFuzzer calls them.

#[path = "../../tests/readers/body_on_joints.rs"]
mod body_on_joints;
#[path = "../../tests/readers/compressed_torus.rs"]
mod compressed_torus;
#[path = "../../tests/fuzzing/mod.rs"]
mod fuzzing;
#[path = "../../tests/readers/sample.rs"]
mod sample;

pub use libfuzzer_sys;

use std::fs;
use std::path::Path;

/// The target of this name as a program.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(init: $crate::write_seeds($name), |bytes: &[u8]| $crate::run($name, bytes));
    };
}

/// Throws bytes at a target.
pub fn run(name: &str, bytes: &[u8]) {
    (fuzzing::target(name).run)(bytes);
}

/// Writes what a target starts from into the folder that GEOSE_FUZZ_SEEDS names.
pub fn write_seeds(name: &str) {
    let Some(folder) = std::env::var_os("GEOSE_FUZZ_SEEDS") else { return };
    fs::create_dir_all(&folder).expect("a folder for seeds");
    for (index, seed) in (fuzzing::target(name).seeds)().iter().enumerate() {
        fs::write(Path::new(&folder).join(format!("seed-{index:03}")), seed).expect("a seed is written");
    }
}
