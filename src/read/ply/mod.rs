//! Stanford PLY: a text header that lists elements and their properties, then their values as text or binary.
//!
//! An own reader rather than ply-rs-bw: that one makes as many records as the header says of an element without properties (a
//! hang, or all memory, from 80 bytes), and its errors are sentences without the numbers of vertices promised and found.

mod body;
mod header;
mod labels;

use super::draft::Draft;
use super::error::{Place, ReadError};
use super::foreign;
use super::polygons::Polygons;
use crate::shape::{Repair, counted};
use body::{Body, Fault};
use header::{Element, Header, Kind, PLY};
use labels::Labels;

/// Names of the list of a face's corners, in the wild.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads `x y z` and labels of the element `vertex` and the corners of the element `face`; the rest is passed over.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let Header { order, elements, end, lines, strange } = header::read(bytes)?;
    let mut body = Body::new(bytes, end, order, lines);
    let mut vertices = None;
    let mut polygons = Polygons::new(PLY, 0);
    let mut repairs = Vec::new();
    repairs.extend(Repair::counted("header-lines-ignored", strange, || {
        format!("{} of the header that a PLY does not know not read", counted(strange, "line", "lines"))
    }));
    for element in &elements {
        match element.name.as_str() {
            "vertex" => vertices = Some(read_vertices(element, &mut body)?),
            "face" => read_faces(element, &mut body, &mut polygons)?,
            name => {
                skip(element, &mut body)?;
                let strips = if name == "tristrips" { element.count as usize } else { 0 };
                repairs.extend(Repair::counted("triangle-strips", strips, || {
                    "the faces of this PLY are stored as triangle strips, which are not read; save it with faces"
                        .to_owned()
                }));
            }
        }
    }
    let Some(Vertices { points, labels }) = vertices else {
        return Err(ReadError::MissingElement { format: PLY, what: "element “vertex”".to_owned() });
    };
    let (faces, cut) = polygons.finish(points.len())?;
    repairs.splice(0..0, cut);
    let left = body.left();
    repairs.extend(Repair::counted("trailing-data", left, || {
        format!("{} after the last element this PLY announces not read", counted(left, "byte", "bytes"))
    }));
    let labels = labels.given(&mut repairs);
    Ok(Draft { points, faces, labels, repairs })
}

struct Vertices {
    points: Vec<[f64; 3]>,
    labels: Labels,
}

fn read_vertices(element: &Element, body: &mut Body) -> Result<Vertices, ReadError> {
    let named = |name: &str| {
        let scalar = |same: fn(&str, &str) -> bool| {
            element.properties.iter().position(|p| same(&p.name, name) && matches!(p.kind, Kind::Scalar(_)))
        };
        scalar(|a, b| a == b).or_else(|| scalar(str::eq_ignore_ascii_case))
    };
    if named("packed_position").is_some() {
        return Err(foreign::compressed_splats());
    }
    let mut axes = [0; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        *axis = named(name).ok_or_else(|| ReadError::MissingElement {
            format: PLY,
            what: format!("property “{name}” of the element “vertex”"),
        })?;
    }
    let mut points = Vec::with_capacity(body.room_for(element));
    let mut labels = Labels::of(element);
    let mut row = vec![0.0; element.properties.len()];
    for found in 0..element.count {
        read_row(element, body, &mut row, None).map_err(|fault| body.error(fault, element, found))?;
        labels.push(points.len(), &row);
        points.push(axes.map(|axis| row[axis]));
    }
    Ok(Vertices { points, labels })
}

fn read_faces(element: &Element, body: &mut Body, polygons: &mut Polygons) -> Result<(), ReadError> {
    if element.count == 0 {
        return Ok(());
    }
    let list = element.properties.iter().position(|p| CORNERS.contains(&p.name.as_str()));
    let Some(list) = list.filter(|&i| matches!(element.properties[i].kind, Kind::List { .. })) else {
        let what = "list “vertex_indices” of the element “face”".to_owned();
        return Err(ReadError::MissingElement { format: PLY, what });
    };
    polygons.reserve(body.room_for(element));
    let mut row = vec![0.0; element.properties.len()];
    let mut corners = Vec::new();
    for found in 0..element.count {
        let at = read_row(element, body, &mut row, Some((list, &mut corners)))
            .map_err(|fault| body.error(fault, element, found))?;
        polygons.push(&corners, at);
    }
    Ok(())
}

/// Passes over an element. One without properties has no values, however many of it there are.
fn skip(element: &Element, body: &mut Body) -> Result<(), ReadError> {
    let mut row = vec![0.0; element.properties.len()];
    let rows = if element.properties.is_empty() { 0 } else { element.count };
    for found in 0..rows {
        read_row(element, body, &mut row, None).map_err(|fault| body.error(fault, element, found))?;
    }
    Ok(())
}

/// One record: scalars into `row`, the list with index `wanted.0` into `wanted.1`. Says where the record begins.
fn read_row(
    element: &Element,
    body: &mut Body,
    row: &mut [f64],
    mut wanted: Option<(usize, &mut Vec<i64>)>,
) -> Result<Place, Fault> {
    let at = body.begin()?;
    for (i, property) in element.properties.iter().enumerate() {
        match property.kind {
            Kind::Scalar(scalar) => row[i] = body.scalar(scalar)?,
            Kind::List { count, item } => {
                let length = body.count(count)?;
                match &mut wanted {
                    Some((list, items)) if *list == i => body.list(item, length, items)?,
                    _ => body.skip(item, length)?,
                }
            }
        }
    }
    Ok(at)
}
