//! `geose-fmap info A [--json]`

use super::{Failure, PathBuf, Preparing, Running, prepare_scan};

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scan.
    a: PathBuf,
    /// As JSON: { info, repairs }.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    preparing: Preparing,
    #[command(flatten)]
    running: Running,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.running.check()?;
    let prepared = prepare_scan(&arguments.a, &arguments.preparing)?;
    let info = serde_json::to_value(&prepared.info)?;
    if arguments.json {
        println!(
            "{}",
            serde_json::to_string_pretty(&serde_json::json!({ "info": info, "repairs": prepared.repairs }))?
        );
        return Ok(());
    }
    for (name, value) in info.as_object().into_iter().flatten() {
        println!("{name}: {value}");
    }
    for repair in &prepared.repairs {
        println!("note: {}", repair.message);
    }
    Ok(())
}
