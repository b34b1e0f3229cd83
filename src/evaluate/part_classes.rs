//! Predicted parts in the classes of a set that has its own: merged by name.

use crate::network::PARTS;

/// For each of [`PARTS`] the class of a set with these names; `None` when one of them has none. Names may say the side or not (a class without one takes
/// both) and how they are spelled does not matter (`left_upper_arm`, `upperarm`, `arm`).
pub(super) fn class_of_parts(names: &[String]) -> Option<[u32; PARTS.len()]> {
    let classes: Vec<(Option<&str>, String)> = names.iter().map(|name| sided(name)).collect();
    let find = |side: Option<&str>, limb: &str| {
        classes.iter().position(|(other, name)| *other == side && limbs(limb).contains(&name.as_str()))
    };
    let mut found = [0; PARTS.len()];
    for (part, class) in PARTS.iter().zip(&mut found) {
        let (side, limb) = sided(part);
        // The limb itself, else what it belongs to when a set counts more coarsely.
        let places = [limb.as_str()].into_iter().chain(belongs_to(&limb).iter().copied());
        let mut classes = places.filter_map(|limb| find(side, limb).or_else(|| find(None, limb)));
        *class = classes.next()? as u32;
    }
    Some(found)
}

/// Side and limb of a name, spelled together in small letters.
fn sided(name: &str) -> (Option<&'static str>, String) {
    let letters: String = name.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    for side in ["left", "right"] {
        if let Some(limb) = letters.strip_prefix(side).or_else(|| letters.strip_suffix(side)) {
            return (Some(side), limb.to_owned());
        }
    }
    (None, letters)
}

/// Names for one limb.
fn limbs(limb: &str) -> &'static [&'static str] {
    match limb {
        "upperarm" => &["upperarm"],
        "forearm" => &["forearm", "lowerarm"],
        "thigh" => &["thigh", "upperleg"],
        "shank" => &["shank", "lowerleg", "calf", "shin"],
        "torso" => &["torso", "trunk", "body"],
        "hand" => &["hand"],
        "foot" => &["foot"],
        "head" => &["head"],
        "arm" => &["arm"],
        "leg" => &["leg"],
        _ => &[],
    }
}

fn belongs_to(limb: &str) -> &'static [&'static str] {
    match limb {
        "hand" => &["forearm", "arm", "upperarm"],
        "forearm" | "upperarm" => &["arm"],
        "foot" => &["shank", "leg"],
        "shank" | "thigh" => &["leg"],
        "head" => &["torso"],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn classes(names: &[&str]) -> Option<[u32; PARTS.len()]> {
        class_of_parts(&names.iter().map(|name| name.to_string()).collect::<Vec<_>>())
    }

    #[test]
    fn names_are_merged_as_a_set_spells_and_groups_them() {
        let own: Vec<String> = PARTS.iter().map(|name| name.replace(' ', "_")).collect();
        assert_eq!(class_of_parts(&own), Some(std::array::from_fn(|i| i as u32)));
        let sideless = classes(&["head", "torso", "upperarm", "lowerarm", "hand", "upperleg", "lowerleg", "foot"]);
        assert_eq!(sideless, Some([0, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7]));
        let coarse = classes(&["right leg", "left leg", "Left-Arm", "arm right", "Body"]);
        assert_eq!(coarse, Some([4, 4, 2, 3, 2, 3, 2, 3, 1, 0, 1, 0, 1, 0]));
        assert_eq!(classes(&["head", "tail"]), None);
    }
}
