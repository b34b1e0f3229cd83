//! Labelled scans of one's own to train on, in the layout that `evaluate` reads: `shapes/NAME.off`, `labels/NAME.txt`, `labels.json`.
//!
//! What is trained on and what is kept to test with say `train.txt` and `test.txt`, names one a line; with one of them the other scans are the rest. Without both, a
//! fifth is kept to test with (the paper's 80 % and 20 %, Sec. 4.3), chosen by a hash of the names.

use std::collections::BTreeSet;
use std::path::Path;

use super::category_of_labels::category_of_labels;
use super::pool::MakesSamples;
use super::sample::Sample;
use super::sample_config::{SampleConfig, Scans};
use crate::evaluate::EvaluationError;
use crate::evaluate::dataset::DataSet;
use crate::evaluate::selection::rank;
use crate::evaluate::table::{rows, text};
use crate::network::Category;
use crate::shape::Shape;

/// Of so many scans one is kept to test with.
const KEPT: usize = 5;
/// Fewest scans that are split by their names: two to train on, and a pair to test with.
const FEWEST: usize = 4;
/// A sample's labels are bytes.
const MOST_PARTS: usize = 255;

/// A folder of labelled scans, split.
pub struct LabelledScans {
    set: DataSet,
    folder: std::path::PathBuf,
    parts: Vec<String>,
    train: Vec<String>,
    test: Vec<String>,
    /// Whether a scan that is trained on has faces.
    meshes: bool,
}

impl LabelledScans {
    /// Whether a folder is meant as one.
    pub fn is_in(folder: &Path) -> bool {
        folder.join("shapes").is_dir()
    }

    /// The scans of a folder. All that are trained on are read, so that what is wrong with a file shows at once.
    pub fn open(folder: &Path) -> Result<Self, EvaluationError> {
        let set = DataSet::open(folder)?;
        let parts = set.part_names()?;
        if parts.is_empty() || parts.len() > MOST_PARTS {
            let problem = format!("{} parts are named, and there must be 1 to {MOST_PARTS}", parts.len());
            return Err(EvaluationError::misfit(&folder.join("labels.json"), problem));
        }
        let names = set.shapes()?;
        let [train, test] = ["train.txt", "test.txt"].map(|file| listed(&folder.join(file), &names));
        let [train, test] = split(names, train?, test?, folder)?;
        let folder = set.folder().to_owned();
        let mut scans = Self { set, folder, parts, train, test, meshes: false };
        for name in &scans.train {
            let shape = scans.labelled(name)?;
            scans.meshes |= !shape.faces().is_empty();
        }
        Ok(scans)
    }

    /// Names of the parts, as `labels.json` has them; a label is an index here.
    pub fn parts(&self) -> &[String] {
        &self.parts
    }

    /// The kind of body: parts meet where faces of a scan that is trained on join them (on clouds alone all may), and have the shares of the area that they have
    /// there. A part whose name says a side is the mirror image of that of the other side.
    pub fn category(&self) -> Result<Category, EvaluationError> {
        let count = self.parts.len();
        let (mut meeting, mut areas) = (BTreeSet::new(), vec![0.0; count]);
        for name in &self.train {
            let shape = self.labelled(name)?;
            let labels = shape.labels().unwrap_or_default();
            let whole = shape.surface_area().max(f64::MIN_POSITIVE);
            for face in shape.faces() {
                let [a, b, c] = face.map(|i| labels[i as usize] as usize);
                let area = shape.face_area(*face) / (3.0 * whole);
                [a, b, c].iter().for_each(|&part| areas[part] += area);
                let joined = [(a, b), (b, c), (c, a)].into_iter().filter(|(i, j)| i != j);
                meeting.extend(joined.map(|(i, j)| [i.min(j), i.max(j)]));
            }
            if shape.faces().is_empty() {
                labels.iter().for_each(|&part| areas[part as usize] += 1.0 / labels.len() as f64);
            }
        }
        if !self.meshes {
            meeting = (0..count).flat_map(|j| (0..j).map(move |i| [i, j])).collect();
        }
        let problem = |problem| EvaluationError::misfit(&self.folder.join("labels.json"), problem);
        category_of_labels(&self.set.name(), &self.parts, meeting, &areas).map_err(problem)
    }

    /// Names of the scans that are kept to test with.
    pub fn test(&self) -> &[String] {
        &self.test
    }

    /// What samples are of.
    pub fn scans(&self) -> Scans {
        Scans { folder: self.folder.clone(), names: self.train.clone() }
    }

    /// Samples of each scan: where there are meshes, one as it is and one as a cloud.
    pub fn per_scan(&self) -> usize {
        if self.meshes { 2 } else { 1 }
    }

    /// Samples in all.
    pub fn samples(&self) -> usize {
        self.per_scan() * self.train.len()
    }

    /// What makes them.
    pub fn maker<'a>(&'a self, config: &'a SampleConfig) -> impl MakesSamples + 'a {
        ScanMaker { scans: self, config }
    }

    /// Pairs of scans kept to test with: those of the set's own list, or where it has none of them every one with every other.
    pub fn test_pairs(&self) -> Result<Vec<[String; 2]>, EvaluationError> {
        let kept = |name: &String| self.test.contains(name);
        let own: Vec<[String; 2]> = self.set.pairs(None)?.into_iter().filter(|pair| pair.iter().all(kept)).collect();
        if !own.is_empty() {
            return Ok(own);
        }
        let others = |a: &String| self.test.iter().filter(move |b| *b != a).map(|b| [a.clone(), b.clone()]).collect();
        Ok(self.test.iter().flat_map(|a| -> Vec<[String; 2]> { others(a) }).collect())
    }

    /// A scan with its labels.
    fn labelled(&self, name: &str) -> Result<Shape, EvaluationError> {
        let shape = self.set.shape(name)?;
        let labels = self.set.labels(name, shape.points().len())?;
        Shape::new(shape.points().to_vec(), shape.faces().to_vec(), Some(labels))
            .map_err(|error| EvaluationError::method(name, crate::pipeline::Error::from(error)))
    }
}

struct ScanMaker<'a> {
    scans: &'a LabelledScans,
    config: &'a SampleConfig,
}

impl MakesSamples for ScanMaker<'_> {
    fn make(&self, index: usize) -> Result<Sample, String> {
        let per_scan = self.scans.per_scan();
        let name = &self.scans.train[index / per_scan];
        let shape = self.scans.labelled(name).map_err(|error| error.to_string())?;
        let shape = if index % per_scan == 1 { shape.without_faces() } else { shape };
        let kind = if shape.faces().is_empty() { self.config.laplacian } else { None };
        Sample::new(shape, None, kind, self.config).map_err(|error| format!("{name}: {error}"))
    }
}

/// Names that a file lists, if it is there; each must be one of `names`.
fn listed(path: &Path, names: &[String]) -> Result<Option<Vec<String>>, EvaluationError> {
    if !path.exists() {
        return Ok(None);
    }
    let text = text(path)?;
    let listed = rows::<1>(path, &text, "the name of a scan")?;
    for (line, [name]) in listed.iter().enumerate() {
        if !names.iter().any(|known| known == name) {
            let problem = format!("“{name}” is no scan of this set: there is no shapes/{name}.off");
            return Err(EvaluationError::malformed(path, line + 1, problem));
        }
    }
    let distinct: BTreeSet<&str> = listed.iter().map(|[name]| *name).collect();
    Ok(Some(distinct.into_iter().map(str::to_owned).collect()))
}

/// What is trained on, and what is kept to test with.
fn split(
    names: Vec<String>,
    train: Option<Vec<String>>,
    test: Option<Vec<String>>,
    folder: &Path,
) -> Result<[Vec<String>; 2], EvaluationError> {
    let without = |listed: &[String]| names.iter().filter(|name| !listed.contains(name)).cloned().collect();
    let [train, test]: [Vec<String>; 2] = match (train, test) {
        (Some(train), Some(test)) => [train, test],
        (Some(train), None) => {
            let test = without(&train);
            [train, test]
        }
        (None, Some(test)) => [without(&test), test],
        (None, None) if names.len() < FEWEST => {
            let problem = format!("{} labelled scans; at least {FEWEST} are needed to train and to test", names.len());
            return Err(EvaluationError::misfit(&folder.join("shapes"), problem));
        }
        (None, None) => {
            let mut names = names.clone();
            names.sort_by_cached_key(|name| rank(name));
            let train = names.split_off(names.len().div_ceil(KEPT).max(2));
            [train, names]
        }
    };
    if let Some(both) = train.iter().find(|name| test.contains(name)) {
        let problem = format!("“{both}” is in train.txt too, and what was trained on tests nothing");
        return Err(EvaluationError::misfit(&folder.join("test.txt"), problem));
    }
    if train.is_empty() {
        return Err(EvaluationError::misfit(&folder.join("train.txt"), "there is no scan to train on".to_owned()));
    }
    Ok([train, test])
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::split;

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|i| format!("tr_reg_{i:03}")).collect()
    }

    #[test]
    fn a_fifth_is_kept_by_a_hash_of_the_names_alone() {
        let of = |names: Vec<String>| split(names, None, None, Path::new("set")).expect("split");
        let [train, test] = of(names(100));
        assert_eq!((train.len(), test.len()), (80, 20));
        let mut backwards = names(100);
        backwards.reverse();
        assert_eq!(of(backwards), [train, test.clone()]);
        let tens: std::collections::BTreeSet<&str> = test.iter().map(|name| &name[..9]).collect();
        assert!(tens.len() >= 7, "{test:?}");
        assert_eq!(of(names(6)).map(|part| part.len()), [4, 2]);
        assert!(split(names(3), None, None, Path::new("set")).is_err());
    }

    #[test]
    fn files_say_how_to_split_and_contradict_each_other_in_vain() {
        let some = |range: std::ops::Range<usize>| Some(names(9)[range].to_vec());
        let of = |train, test| split(names(9), train, test, Path::new("set")).map(|parts| parts.map(|part| part.len()));
        assert_eq!(of(some(0..7), None).expect("split"), [7, 2]);
        assert_eq!(of(None, some(0..4)).expect("split"), [5, 4]);
        assert_eq!(of(some(0..3), some(3..5)).expect("split"), [3, 2]);
        assert!(of(some(0..3), some(2..5)).expect_err("refused").to_string().contains("tr_reg_002"));
        assert!(of(None, some(0..9)).expect_err("refused").to_string().contains("no scan to train on"));
    }
}
