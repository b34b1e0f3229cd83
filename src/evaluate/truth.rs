//! What the right match of a pair is, from whichever kind of ground truth the set has.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::EvaluationError;
use super::dataset::DataSet;
use super::table::{index, indices, number, rows, text};
use crate::read::faces_as_written;
use crate::shape::Shape;
use crate::vector::{cross, minus, norm, squared_distance};

/// The ground truth of a pair A → B. Errors are measured on a mesh that is B, or stands for it where B is a cloud.
pub(super) struct Truth {
    /// (point of A, its true vertex on the mesh), the lines of the file whose template point is on both: a point may have several or none.
    pub lines: Vec<(u32, u32)>,
    /// (line, the true vertex if left and right were exchanged), where the set tells and the vertex is there.
    pub mirrored: Option<Vec<(usize, u32)>>,
    /// The mesh's vertex at each point of B; `None` where the mesh is B itself.
    pub vertex_of: Option<Vec<u32>>,
    /// How large A's body is beside B's, each in the unit of its file, by the faces of A that are on both; `None` where there are none, or no line says that a shape lacks
    /// a point.
    pub scale: Option<f64>,
    /// (point of A, whether it has a partner on B) for every template point on A; `None` where no line says that a shape lacks one.
    pub paired: Option<Vec<(u32, bool)>>,
}

/// A mesh to measure on.
pub(super) struct Mesh {
    set: DataSet,
    name: String,
}

impl Mesh {
    /// Reads it.
    pub(super) fn shape(&self) -> Result<Shape, EvaluationError> {
        self.set.shape(&self.name)
    }
}

impl Truth {
    /// Reads the ground truth of A → B, whose shapes have been read.
    pub(super) fn of(set: &DataSet, a: (&str, &Shape), b: (&str, &Shape)) -> Result<Self, EvaluationError> {
        let has = |extension: &str| set.truth_file(&format!("{}.{extension}", a.0)).exists();
        let truth = if has("vts") {
            Self::by_template(set, a, b)?
        } else if has("baryc_gt") {
            Self::of_piece(set, a, b)?
        } else if has("tpl") {
            Self::of_clouds(set, a, b)?
        } else {
            let files = format!("corres/{}.vts, .baryc_gt or .tpl", a.0);
            let sentence = format!("{} has no ground truth for {}: {files}", set.name(), a.0);
            return Err(EvaluationError::NotMeasurable(sentence));
        };
        let sentence = match &truth {
            Self { lines, .. } if !lines.is_empty() => return Ok(truth),
            Self { paired: Some(_), .. } => format!("no template point is on both {} and {}", a.0, b.0),
            _ => format!("the ground truth for {} has no line", a.0),
        };
        Err(EvaluationError::NotMeasurable(sentence))
    }

    /// The mesh on which errors on B are measured.
    pub(super) fn mesh(set: &DataSet, b: &str) -> Result<Mesh, EvaluationError> {
        if !set.truth_file(&format!("{b}.tpl")).exists() {
            return Ok(Mesh { set: set.clone(), name: b.to_owned() });
        }
        let (_, sibling) = template(set)?;
        let same_number = |name: &String| number_in(name).is_some() && number_in(name) == number_in(b);
        match &sibling.shapes()?.into_iter().filter(same_number).collect::<Vec<_>>()[..] {
            [name] => Ok(Mesh { name: name.clone(), set: sibling }),
            found => {
                let (many, sibling) = (found.len(), sibling.name());
                let sentence = format!("{many} shapes of {sibling} have the number of {b}: one was expected");
                Err(EvaluationError::NotMeasurable(sentence))
            }
        }
    }

    /// Line i of each shape's .vts is its vertex at template point i, 0 where it is a piece that the point is not on.
    fn by_template(set: &DataSet, a: (&str, &Shape), b: (&str, &Shape)) -> Result<Self, EvaluationError> {
        let path = |name: &str| set.truth_file(name);
        let on_a = vertices_if_any(&path(&format!("{}.vts", a.0)), a)?;
        let on_b = vertices_if_any(&path(&format!("{}.vts", b.0)), b)?;
        same_length(&path(&format!("{}.vts", b.0)), &on_b, &path(&format!("{}.vts", a.0)), &on_a)?;
        let mirror = path(&format!("{}.sym.vts", b.0));
        let exchanged = mirror.exists().then(|| vertices_if_any(&mirror, b)).transpose()?;
        if let Some(exchanged) = &exchanged {
            same_length(&mirror, exchanged, &path(&format!("{}.vts", a.0)), &on_a)?;
        }
        let on_both = |i: usize| Some((on_a[i]?, on_b[i]?));
        let shared: Vec<usize> = (0..on_a.len()).filter(|&i| on_both(i).is_some()).collect();
        let mirrored = |exchanged: Vec<Option<u32>>| -> Vec<(usize, u32)> {
            shared.iter().enumerate().filter_map(|(line, &i)| Some((line, exchanged[i]?))).collect()
        };
        let pieces = on_a.contains(&None) || on_b.contains(&None);
        let paired = || on_a.iter().zip(&on_b).filter_map(|(on_a, on_b)| Some(((*on_a)?, on_b.is_some()))).collect();
        Ok(Self {
            lines: shared.iter().filter_map(|&i| on_both(i)).collect(),
            mirrored: exchanged.map(mirrored).filter(|lines| !lines.is_empty()),
            vertex_of: None,
            scale: pieces.then(|| scale(a.1, b.1, shared.iter().filter_map(|&i| on_both(i)))).flatten(),
            paired: pieces.then(paired),
        })
    }

    /// Row i of A's .baryc_gt is where point i of the piece lies on the whole; the nearest corner of that face counts.
    fn of_piece(set: &DataSet, a: (&str, &Shape), b: (&str, &Shape)) -> Result<Self, EvaluationError> {
        let path = set.truth_file(&format!("{}.baryc_gt", a.0));
        let faces = faces_as_written(&set.shape_bytes(b.0)?)
            .map_err(|e| EvaluationError::unreadable(&set.shape_file(b.0), e))?;
        let text = text(&path)?;
        let rows = rows::<4>(&path, &text, "a face and three weights")?;
        if rows.len() != a.1.points().len() {
            let problem = format!("{} lines for {}, which has {} points", rows.len(), a.0, a.1.points().len());
            return Err(EvaluationError::misfit(&path, problem));
        }
        let (allowed, what) = (1..=faces.len(), format!("a face of {}", b.0));
        let mut lines = Vec::with_capacity(rows.len());
        for (i, words) in rows.into_iter().enumerate() {
            let face = faces[index(&path, i + 1, words[0], &allowed, &what)? as usize];
            let mut weights = [0.0; 3];
            for (weight, word) in weights.iter_mut().zip(&words[1..]) {
                *weight = number(&path, i + 1, word)?;
            }
            lines.push((i as u32, nearest_corner(b.1, face, weights)));
        }
        Ok(Self { lines, mirrored: None, vertex_of: None, scale: None, paired: None })
    }

    /// Row i of each cloud's .tpl is the template's vertex there; another table leads from it to the mesh of the
    /// sibling set.
    fn of_clouds(set: &DataSet, a: (&str, &Shape), b: (&str, &Shape)) -> Result<Self, EvaluationError> {
        let mesh = Self::mesh(set, b.0)?;
        let (table, sibling) = template(set)?;
        let on_mesh = sibling.truth_file(&format!("{}.vts", mesh.name));
        let on_mesh = vertices(&on_mesh, (&mesh.name, &mesh.shape()?))?;
        let row_of = indices(&table, 1..=on_mesh.len(), &format!("a row of {}.vts", mesh.name))?;
        let at_points = |(name, shape): (&str, &Shape)| -> Result<Vec<u32>, EvaluationError> {
            let path = set.truth_file(&format!("{name}.tpl"));
            let of_template = indices(&path, 0..=row_of.len().saturating_sub(1), "a vertex of the template")?;
            if of_template.len() != shape.points().len() {
                let problem =
                    format!("{} lines for {name}, which has {} points", of_template.len(), shape.points().len());
                return Err(EvaluationError::misfit(&path, problem));
            }
            Ok(of_template.into_iter().map(|s| on_mesh[row_of[s as usize] as usize]).collect())
        };
        let lines = (0..).zip(at_points(a)?).collect();
        Ok(Self { lines, mirrored: None, vertex_of: Some(at_points(b)?), scale: None, paired: None })
    }
}

/// √area of the faces of A whose corners are all on B over that of the same faces there; lines are (point of A, point of B).
fn scale(a: &Shape, b: &Shape, lines: impl Iterator<Item = (u32, u32)>) -> Option<f64> {
    let on_b: BTreeMap<u32, u32> = lines.collect();
    let area = |shape: &Shape, corners: [u32; 3]| {
        let [p, q, r] = corners.map(|v| shape.points()[v as usize]);
        0.5 * norm(cross(minus(q, p), minus(r, p)))
    };
    let (mut of_a, mut of_b) = (0.0, 0.0);
    for &face in a.faces() {
        let [Some(p), Some(q), Some(r)] = face.map(|v| on_b.get(&v).copied()) else { continue };
        of_a += area(a, face);
        of_b += area(b, [p, q, r]);
    }
    (of_a > 0.0 && of_b > 0.0).then(|| (of_a / of_b).sqrt())
}

/// 0-based vertices of a .vts that may be that of a piece: 0 stands for none.
fn vertices_if_any(path: &Path, (name, shape): (&str, &Shape)) -> Result<Vec<Option<u32>>, EvaluationError> {
    let written = indices(path, 0..=shape.points().len(), &format!("a vertex of {name}, or 0 for none,"))?;
    Ok(written.into_iter().map(|vertex| vertex.checked_sub(1)).collect())
}

/// 0-based vertices of the .vts of a whole shape.
fn vertices(path: &Path, (name, shape): (&str, &Shape)) -> Result<Vec<u32>, EvaluationError> {
    indices(path, 1..=shape.points().len(), &format!("a vertex of {name}"))
}

fn same_length(
    path: &Path,
    lines: &[Option<u32>],
    other: &Path,
    others: &[Option<u32>],
) -> Result<(), EvaluationError> {
    if lines.len() == others.len() {
        return Ok(());
    }
    let problem = format!("{} lines, but {} has {}", lines.len(), other.display(), others.len());
    Err(EvaluationError::misfit(path, problem))
}

/// `corres/template_to_SIBLING.txt` and the set it leads to.
fn template(set: &DataSet) -> Result<(PathBuf, DataSet), EvaluationError> {
    let name_in = |file: &String| Some(file.strip_prefix("template_to_")?.strip_suffix(".txt")?.to_owned());
    let Some(sibling) = set.truth_files()?.iter().find_map(name_in) else {
        let sentence =
            format!("{} has clouds but no corres/template_to_SET.txt that leads to their meshes", set.name());
        return Err(EvaluationError::NotMeasurable(sentence));
    };
    Ok((set.truth_file(&format!("template_to_{sibling}.txt")), set.sibling(&sibling)?))
}

/// The digits at the end of a name.
fn number_in(name: &str) -> Option<&str> {
    let digits = &name[name.trim_end_matches(|c: char| c.is_ascii_digit()).len()..];
    (!digits.is_empty()).then_some(digits)
}

/// The corner of a face nearest to the point with these barycentric weights; the first of equals.
fn nearest_corner(shape: &Shape, face: [u32; 3], weights: [f64; 3]) -> u32 {
    let corners = face.map(|i| shape.points()[i as usize]);
    let point = std::array::from_fn(|c| (0..3).map(|corner| weights[corner] * corners[corner][c]).sum());
    let distance = corners.map(|corner| squared_distance(corner, point));
    let nearest = (1..3).fold(0, |best, corner| if distance[corner] < distance[best] { corner } else { best });
    face[nearest]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_that_of_the_faces_on_both() {
        // A square, and as many points in no face as make it a scan.
        let square = |side: f64| -> Vec<[f64; 3]> {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].into_iter();
            let more = (0..60).map(|i| [2.0 + f64::from(i), 1.0]);
            corners.chain(more).map(|[x, y]| [side * x, side * y, 0.0]).collect()
        };
        let faces = vec![[0, 1, 2], [0, 2, 3]];
        let a = Shape::new(square(3.0), faces.clone(), None).expect("a square");
        let b = Shape::new(square(2.0), faces, None).expect("a square");
        let on_both = |lines: &[u32]| scale(&a, &b, lines.iter().map(|&v| (v, v)));
        // One face is enough, an edge is not.
        assert_eq!((on_both(&[0, 1, 2, 3]), on_both(&[0, 1, 2]), on_both(&[0, 1])), (Some(1.5), Some(1.5), None));
    }
}
