//! What was changed, set aside or only noticed on the way from an upload to a shape.

use serde::{Deserialize, Serialize};

/// One kind of thing that was changed, set aside or noticed while making a shape out of an upload.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repair {
    /// Stable name: `"zero-area-faces"`, `"polygons-triangulated"`, …
    pub code: String,
    /// How many times.
    pub count: usize,
    /// A sentence for a person.
    pub message: String,
}

impl Repair {
    /// Something that happened to `count` things at once.
    pub(crate) fn noted(code: &str, count: usize, message: String) -> Self {
        Self { code: code.to_owned(), count, message }
    }

    /// `None` when `count` is 0: nothing happened, so there is nothing to say.
    pub(crate) fn counted(code: &str, count: usize, message: impl FnOnce() -> String) -> Option<Self> {
        (count > 0).then(|| Self::noted(code, count, message()))
    }
}

/// `"1 face"`, `"3 faces"`: the count with its noun, for sentences people read.
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {many}") }
}
