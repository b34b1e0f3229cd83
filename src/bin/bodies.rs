//! Makes bodies from CC0 data.
fn main() {}
