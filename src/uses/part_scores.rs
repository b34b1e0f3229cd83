//! How well predicted parts agree with given ones.

use std::collections::BTreeMap;

/// Agreement of part labels on one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartScores {
    /// Intersection over union by area, mean over the parts that the given labels have.
    pub mean_iou: f64,
    /// The share of the area where both labels are the same.
    pub agreement: f64,
}

/// Compares part labels, one per point; `area` (n) is the surface that each point stands for, in any unit.
pub fn part_scores(predicted: &[u32], given: &[u32], area: &[f64]) -> PartScores {
    // Area per part: given, and both; predicted area outside of the given part is what the union adds.
    let mut parts: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for ((&predicted, &given), &area) in predicted.iter().zip(given).zip(area) {
        parts.entry(given).or_default()[0] += area;
        parts.entry(predicted).or_default()[1] += area;
        if predicted == given {
            parts.entry(given).or_default()[2] += area;
        }
    }
    let total: f64 = area.iter().sum();
    let agreed: f64 = parts.values().map(|[_, _, both]| both).sum();
    let present: Vec<f64> = parts
        .values()
        .filter(|[given, ..]| *given > 0.0)
        .map(|[given, predicted, both]| both / (given + predicted - both))
        .collect();
    PartScores {
        mean_iou: present.iter().sum::<f64>() / present.len().max(1) as f64,
        agreement: if total > 0.0 { agreed / total } else { 0.0 },
    }
}
