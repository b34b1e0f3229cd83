//! Text files with one row of numbers a line, as the ground truth comes in.

use std::ops::RangeInclusive;
use std::path::Path;

use super::EvaluationError;

/// A file's text.
pub(crate) fn text(path: &Path) -> Result<String, EvaluationError> {
    std::fs::read_to_string(path).map_err(|e| EvaluationError::unreadable(path, e))
}

/// The words of every line, the empty ones at the end left out. `shape` says what a line must hold, for the complaint.
pub(crate) fn rows<'t, const N: usize>(
    path: &Path,
    text: &'t str,
    shape: &str,
) -> Result<Vec<[&'t str; N]>, EvaluationError> {
    let row = |(line, text): (usize, &'t str)| {
        let words: Vec<&str> = text.split_whitespace().collect();
        words.try_into().map_err(|words: Vec<&str>| {
            EvaluationError::malformed(
                path,
                line + 1,
                format!("a line must hold {shape}, and here are {}", words.len()),
            )
        })
    };
    text.trim_end().lines().enumerate().map(row).collect()
}

/// One whole number a line within `allowed`, counted from the first that is allowed. `what` names one, for the
/// complaint.
pub(super) fn indices(path: &Path, allowed: RangeInclusive<usize>, what: &str) -> Result<Vec<u32>, EvaluationError> {
    let text = text(path)?;
    let rows = rows::<1>(path, &text, "one whole number")?;
    rows.iter().enumerate().map(|(line, [word])| index(path, line + 1, word, &allowed, what)).collect()
}

/// A whole number within `allowed`, counted from the first that is allowed; `1.4700000e+02` is one too.
pub(super) fn index(
    path: &Path,
    line: usize,
    word: &str,
    allowed: &RangeInclusive<usize>,
    what: &str,
) -> Result<u32, EvaluationError> {
    let whole = word.parse::<f64>().ok().filter(|v| v.fract() == 0.0 && *v >= 0.0).map(|v| v as usize);
    match whole.filter(|v| allowed.contains(v)) {
        Some(value) => Ok((value - allowed.start()) as u32),
        None => {
            let (first, last) = (allowed.start(), allowed.end());
            let problem = format!("“{word}” where {what} must stand, a whole number from {first} to {last}");
            Err(EvaluationError::malformed(path, line, problem))
        }
    }
}

/// A finite number.
pub(super) fn number(path: &Path, line: usize, word: &str) -> Result<f64, EvaluationError> {
    let value = word.parse::<f64>().ok().filter(|v| v.is_finite());
    value.ok_or_else(|| EvaluationError::malformed(path, line, format!("“{word}” where a number must stand")))
}
