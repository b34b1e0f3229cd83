//! The command line, for batches and measurements. Exit codes: 0 good, 1 could not, 2 wrong use.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    geose_fmap::cli::run()
}

#[cfg(target_arch = "wasm32")]
fn main() {}
