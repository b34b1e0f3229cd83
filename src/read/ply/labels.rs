//! Labels of points: which property of a PLY holds them, and whether its values can be labels.

use super::header::{Element, Kind};
use crate::read::error::quoted;
use crate::shape::Repair;

/// What writers call a label, best first; CloudCompare puts `scalar_` before every name and writes floats.
const NAMES: [&str; 25] = [
    "label",
    "labels",
    "part",
    "parts",
    "part_id",
    "part_label",
    "segment",
    "segment_id",
    "segment_label",
    "seg",
    "seg_id",
    "segmentation",
    "semantic",
    "semantic_label",
    "semantic_id",
    "class",
    "class_id",
    "class_label",
    "classification",
    "category",
    "category_id",
    "region",
    "region_id",
    "vertex_label",
    "point_label",
];

/// What else may be one, and is only named.
const LIKE: [&str; 8] = ["label", "part", "segment", "class", "categor", "region", "instance", "cluster"];

/// Names that a message repeats at most.
const NAMED: usize = 8;

/// The columns that may hold labels, and what they held so far.
pub(super) struct Labels {
    columns: Vec<Column>,
}

struct Column {
    index: usize,
    name: String,
    /// Place in [`NAMES`]; none for what only sounds like a label.
    rank: Option<usize>,
    values: Vec<u32>,
    /// The first value that cannot be a label, and its point.
    unfit: Option<(usize, f64)>,
}

impl Labels {
    /// The columns of `element` that are called like labels.
    pub fn of(element: &Element) -> Self {
        let scalars = element.properties.iter().enumerate().filter(|(_, p)| matches!(p.kind, Kind::Scalar(_)));
        let mut columns: Vec<Column> = scalars
            .filter_map(|(index, property)| {
                let name = normal(&property.name);
                let rank = NAMES.iter().position(|known| *known == name);
                (rank.is_some() || LIKE.iter().any(|part| name.contains(part))).then(|| Column {
                    index,
                    name: property.name.clone(),
                    rank,
                    values: Vec::new(),
                    unfit: None,
                })
            })
            .collect();
        columns.sort_by_key(|column| column.rank.unwrap_or(usize::MAX));
        Self { columns }
    }

    /// The values of the next point, of which there were `point` before.
    pub fn push(&mut self, point: usize, row: &[f64]) {
        for column in self.columns.iter_mut().filter(|column| column.rank.is_some() && column.unfit.is_none()) {
            let value = row[column.index];
            if value.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(&value) {
                column.values.push(value as u32);
            } else {
                column.unfit = Some((point, value));
                column.values = Vec::new();
            }
        }
    }

    /// The labels of the best column that has them, and what is to be said of the others. One value throughout says nothing, but where it
    /// is called `label`.
    pub fn given(mut self, repairs: &mut Vec<Repair>) -> Option<Vec<u32>> {
        let tells =
            |column: &Column| column.rank == Some(0) || column.values.iter().any(|value| value != &column.values[0]);
        let best = self.columns.iter().position(|c| c.rank.is_some() && c.unfit.is_none() && tells(c));
        let taken = best.map(|at| self.columns.remove(at));
        let unfit = self.columns.iter().find_map(|column| Some((column, column.unfit?)));
        if let (None, Some((column, (point, value)))) = (&taken, unfit) {
            let of = if column.rank == Some(0) {
                String::new()
            } else {
                format!(" (“{}”)", quoted(column.name.as_bytes()))
            };
            repairs.extend(Repair::counted("labels-ignored", 1, || {
                format!("the label {value} of point {point}{of} is not a whole number from 0 on, so no labels are used")
            }));
        }
        let others: Vec<String> = self.columns.iter().map(|c| format!("“{}”", quoted(c.name.as_bytes()))).collect();
        let from = taken.as_ref().map(|column| format!("labels are those of “{}”; ", quoted(column.name.as_bytes())));
        let said = unfit.is_some() && taken.is_none() && others.len() == 1;
        repairs.extend(Repair::counted("label-columns-ignored", if said { 0 } else { others.len() }, || {
            let names = others[..others.len().min(NAMED)].join(", ");
            format!("{}what looks like labels and is not read: {names}", from.unwrap_or_default())
        }));
        taken.map(|column| column.values)
    }
}

/// A name without what programs put before it, in lower case, its words joined by `_`.
fn normal(name: &str) -> String {
    let lower = name.to_ascii_lowercase().replace(['-', ' ', '.', ':'], "_");
    ["scalar_", "sf_"].iter().find_map(|before| lower.strip_prefix(before)).unwrap_or(&lower).to_owned()
}
