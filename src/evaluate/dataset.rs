//! A folder in the layout of the evaluation sets: `shapes/NAME.off`, `pairs.txt`, `corres/`, `labels/`, `labels.json`.

use std::path::{Path, PathBuf};

use super::EvaluationError;
use super::table::{indices, rows, text};
use crate::read::read;
use crate::shape::Shape;

/// An evaluation set, by its folder.
#[derive(Clone)]
pub(crate) struct DataSet {
    folder: PathBuf,
}

/// Parts that came with a set.
pub(super) struct Labelled {
    /// Their names.
    pub(super) names: Vec<String>,
    /// One per point, an index into `names`.
    pub(super) labels: Vec<u32>,
}

impl DataSet {
    /// The set in `folder`, which must have shapes.
    pub(crate) fn open(folder: &Path) -> Result<Self, EvaluationError> {
        let unreadable = |path: &Path, e: std::io::Error| EvaluationError::unreadable(path, e);
        let folder = folder.canonicalize().map_err(|e| unreadable(folder, e))?;
        let set = Self { folder };
        std::fs::read_dir(set.folder.join("shapes")).map_err(|e| unreadable(&set.folder.join("shapes"), e))?;
        Ok(set)
    }

    /// The folder, as an absolute path.
    #[cfg(feature = "train")]
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The folder's own name.
    pub(crate) fn name(&self) -> String {
        self.folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    /// The set in a folder beside this one.
    pub(super) fn sibling(&self, name: &str) -> Result<Self, EvaluationError> {
        Self::open(&self.folder.with_file_name(name))
    }

    /// Pairs `A B` of `file`, or of the set's own list; a set without a list has none.
    pub(crate) fn pairs(&self, file: Option<&Path>) -> Result<Vec<[String; 2]>, EvaluationError> {
        let own = self.folder.join("pairs.txt");
        if file.is_none() && !own.exists() {
            return Ok(Vec::new());
        }
        let path = file.unwrap_or(&own);
        let text = text(path)?;
        let pairs = rows::<2>(path, &text, "two names of shapes")?;
        for (line, name) in pairs.iter().enumerate().flat_map(|(i, pair)| pair.map(|name| (i + 1, name))) {
            if !self.shape_file(name).exists() {
                let problem = format!("“{name}” is no shape of this set: there is no {name}.off");
                return Err(EvaluationError::malformed(path, line, problem));
            }
        }
        if file.is_some() && pairs.is_empty() {
            return Err(EvaluationError::misfit(path, "there is no pair in it".to_owned()));
        }
        Ok(pairs.into_iter().map(|pair| pair.map(str::to_owned)).collect())
    }

    /// All shapes, by name.
    pub(crate) fn shapes(&self) -> Result<Vec<String>, EvaluationError> {
        let names = names(&self.folder.join("shapes"))?;
        Ok(names.iter().filter_map(|name| Some(name.strip_suffix(".off")?.to_owned())).collect())
    }

    /// A shape as its file has it.
    pub(crate) fn shape(&self, name: &str) -> Result<Shape, EvaluationError> {
        let path = self.shape_file(name);
        read(&self.shape_bytes(name)?, Some("shape.off"), None).map_err(|e| EvaluationError::unreadable(&path, e))
    }

    /// The bytes of a shape's file.
    pub(super) fn shape_bytes(&self, name: &str) -> Result<Vec<u8>, EvaluationError> {
        let path = self.shape_file(name);
        std::fs::read(&path).map_err(|e| EvaluationError::unreadable(&path, e))
    }

    /// Where a shape lies.
    pub(super) fn shape_file(&self, name: &str) -> PathBuf {
        self.folder.join("shapes").join(format!("{name}.off"))
    }

    /// Where a file of the ground truth lies.
    pub(super) fn truth_file(&self, name: &str) -> PathBuf {
        self.folder.join("corres").join(name)
    }

    /// Names of the files of the ground truth, in order.
    pub(super) fn truth_files(&self) -> Result<Vec<String>, EvaluationError> {
        names(&self.folder.join("corres"))
    }

    /// The part of each of a shape's `points`.
    pub(crate) fn labels(&self, name: &str, points: usize) -> Result<Vec<u32>, EvaluationError> {
        let path = self.folder.join("labels").join(format!("{name}.txt"));
        if !path.exists() {
            let sentence = format!("parts are to be as given, but {} has no labels for {name}", self.name());
            return Err(EvaluationError::NotMeasurable(sentence));
        }
        let parts = self.part_names()?;
        let labels = indices(&path, 0..=parts.len().saturating_sub(1), "the number of a part")?;
        if labels.len() != points {
            let problem = format!("{} labels for {name}, which has {points} points", labels.len());
            return Err(EvaluationError::misfit(&path, problem));
        }
        Ok(labels)
    }

    /// The names of the parts and the part of each of a shape's `points`; nothing where the set has no labels for it.
    pub(super) fn labels_if_any(&self, name: &str, points: usize) -> Result<Option<Labelled>, EvaluationError> {
        if !self.folder.join("labels").join(format!("{name}.txt")).exists() {
            return Ok(None);
        }
        Ok(Some(Labelled { names: self.part_names()?, labels: self.labels(name, points)? }))
    }

    /// Names of the parts; a label is an index here.
    pub(crate) fn part_names(&self) -> Result<Vec<String>, EvaluationError> {
        let path = self.folder.join("labels.json");
        let problem =
            |e| EvaluationError::unreadable(&path, format!("a list of the parts' names must stand here: {e}"));
        serde_json::from_str(&text(&path)?).map_err(problem)
    }
}

fn names(folder: &Path) -> Result<Vec<String>, EvaluationError> {
    let unreadable = |e| EvaluationError::unreadable(folder, e);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        names.push(entry.map_err(unreadable)?.file_name().to_string_lossy().into_owned());
    }
    names.sort_unstable();
    Ok(names)
}
