//! The category of labelled scans of one's own.

use std::collections::BTreeSet;

use crate::network::{Category, Part, Thresholds};

/// Of scans of one's own: names of the parts, pairs of them that meet, and their areas in any unit. Parts of which one name says left where another says
/// right, in capitals or not, are mirror images; what meets on one side meets on the other. No shape is held to be of another category, and confidence is
/// that of maps without a network, until both are fitted.
pub(super) fn category_of_labels(
    name: &str,
    parts: &[String],
    meeting: impl IntoIterator<Item = [usize; 2]>,
    areas: &[f64],
) -> Result<Category, String> {
    let spelled: Vec<String> = parts.iter().map(|name| name.to_lowercase()).collect();
    let other = |name: &str| name.replace("left", "\0").replace("right", "left").replace('\0', "right");
    let mirror = |i: usize| spelled.iter().position(|part| *part == other(&spelled[i])).unwrap_or(i);
    let total: f64 = areas.iter().sum();
    let mut pairs: BTreeSet<[usize; 2]> = meeting.into_iter().collect();
    let mirrored: Vec<[usize; 2]> = pairs.iter().map(|pair| pair.map(mirror)).collect();
    pairs.extend(mirrored.into_iter().map(|[i, j]| [i.min(j), i.max(j)]));
    let part = |i: usize| {
        let letters = |text: &str| text.chars().filter(|c| c.is_alphanumeric()).collect::<String>();
        let side = ["left", "right"].into_iter().find(|&side| mirror(i) != i && spelled[i].contains(side));
        let class = letters(&side.map_or(spelled[i].clone(), |side| spelled[i].replace(side, "")));
        // A part that none of these scans has is there all the same.
        let area = (areas[i] / total).max(1e-4);
        Part {
            name: parts[i].clone(),
            side: side.map(str::to_owned),
            mirror: mirror(i),
            group: 0,
            area,
            classes: vec![class],
        }
    };
    let category = Category {
        name: name.to_owned(),
        one: name.to_owned(),
        version: 1,
        parts: (0..parts.len()).map(part).collect(),
        meeting: pairs.into_iter().collect(),
        groups: Vec::new(),
        cues: Vec::new(),
        extent: None,
        thresholds: Thresholds { bijectivity: 0.2, certainty: 0.0, contact: 1.0 },
        confidence: Vec::new(),
        confidence_of_pieces: Vec::new(),
    };
    category.check()?;
    Ok(category)
}

#[cfg(test)]
mod tests {
    use super::category_of_labels;

    #[test]
    fn sides_are_told_by_name_and_what_meets_on_one_meets_on_the_other() {
        let names = ["Trunk", "Left Fin", "right fin"].map(str::to_owned);
        let category = category_of_labels("fish", &names, [[0, 1]], &[8.0, 1.0, 1.0]).expect("a category");
        assert_eq!(category.parts.iter().map(|part| part.mirror).collect::<Vec<_>>(), [0, 2, 1]);
        assert!(category.meet(0, 2) && !category.meet(1, 2));
        assert_eq!((category.parts[1].side.as_deref(), category.parts[1].classes[0].as_str()), (Some("left"), "fin"));
        assert_eq!(category.parts.iter().map(|part| part.area).collect::<Vec<_>>(), [0.8, 0.1, 0.1]);
    }
}
