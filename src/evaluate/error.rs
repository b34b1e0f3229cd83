//! Why a data set could not be measured.

use std::path::{Path, PathBuf};

use crate::pipeline::Error;

/// Why a data set could not be measured, in a sentence that names the file and, where there is one, the line.
#[derive(Debug, thiserror::Error)]
pub enum EvaluationError {
    /// A file or folder that cannot be read.
    #[error("{}: {reason}", path.display())]
    Unreadable {
        /// Which.
        path: PathBuf,
        /// What the system or the reader says.
        reason: String,
    },
    /// A line that is not what the layout asks for.
    #[error("{}, line {line}: {problem}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// 1-based.
        line: usize,
        /// What stands there, and what should.
        problem: String,
    },
    /// A file whose length does not fit another one's.
    #[error("{}: {problem}", path.display())]
    Misfit {
        /// The file.
        path: PathBuf,
        /// Both lengths.
        problem: String,
    },
    /// A mode or option that the set has no data for.
    #[error("{0}")]
    NotMeasurable(String),
    /// Constants of confidence that were not found.
    #[cfg(feature = "train")]
    #[error("the fit of {to} did not converge: step {iterations} still changed a coefficient by {last_step:.1e}")]
    NotFitted {
        /// What they were fitted to.
        to: String,
        /// Newton steps.
        iterations: usize,
        /// The most that the last of them changed one by.
        last_step: f64,
    },
    /// The method itself fails on a shape or pair.
    #[error("{on}: {error}")]
    Method {
        /// `A`, or `A B`.
        on: String,
        /// Why.
        error: Error,
    },
}

impl EvaluationError {
    pub(super) fn unreadable(path: &Path, reason: impl ToString) -> Self {
        Self::Unreadable { path: path.to_owned(), reason: reason.to_string() }
    }

    pub(crate) fn malformed(path: &Path, line: usize, problem: String) -> Self {
        Self::Malformed { path: path.to_owned(), line, problem }
    }

    pub(crate) fn misfit(path: &Path, problem: String) -> Self {
        Self::Misfit { path: path.to_owned(), problem }
    }

    pub(crate) fn method(on: impl Into<String>, error: impl Into<Error>) -> Self {
        Self::Method { on: on.into(), error: error.into() }
    }
}
