//! `geose-fmap info A [--json]`

use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;

use serde_json::Value;

use super::arguments::{Failure, Preparing, Running};
use super::scan_file::{Reading, prepare_scan};

#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The scan.
    a: PathBuf,
    /// As JSON: { info, repairs }.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    preparing: Preparing,
    #[command(flatten)]
    running: Running,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut on = arguments.running.processor()?;
    let prepared = prepare_scan(&arguments.a, arguments.reading, &arguments.preparing, &mut on)?;
    let info = serde_json::to_value(&prepared.info)?;
    if arguments.json {
        let both = serde_json::json!({ "info": info, "repairs": prepared.repairs });
        return say(&serde_json::to_string_pretty(&both)?);
    }
    let mut lines = Vec::new();
    for (name, value) in info.as_object().into_iter().flatten() {
        match value {
            Value::Null if name == "fallback" => {}
            Value::Null => lines.push(format!("{name:<12} not clear")),
            Value::String(text) => lines.push(format!("{name:<12} {text}")),
            Value::Object(parts) => {
                let parts =
                    parts.iter().map(|(part, value)| format!("{part} {:.3}", value.as_f64().unwrap_or(f64::NAN)));
                lines.push(format!("{name:<12} {}", parts.collect::<Vec<_>>().join(", ")));
            }
            value => lines.push(format!("{name:<12} {value}")),
        }
    }
    lines.extend(prepared.repairs.iter().map(|repair| format!("note: {}", repair.message)));
    say(&lines.join("\n"))
}

/// Prints; a reader that has heard enough (`| head`) is no failure.
fn say(text: &str) -> Result<(), Failure> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        outcome => Ok(outcome?),
    }
}
