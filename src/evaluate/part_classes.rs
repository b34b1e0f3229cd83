//! Predicted parts in the classes of a set that has its own: merged by name.

use crate::network::Category;

/// For each part of `category` the class of a set with these names; `None` when one of them has none. Names may say the side or not (a class without one takes
/// both) and how they are spelled does not matter (`left_upper_arm`, `upperarm`, `arm`).
pub(super) fn class_of_parts(category: &Category, names: &[String]) -> Option<Vec<u32>> {
    let sides: Vec<&str> = category.parts.iter().filter_map(|part| part.side.as_deref()).collect();
    let classes: Vec<(Option<&str>, String)> = names.iter().map(|name| sided(name, &sides)).collect();
    let find = |side: Option<&str>, wanted: &str| {
        classes.iter().position(|(other, name)| *other == side && name == wanted).map(|class| class as u32)
    };
    let class = |part: &crate::network::Part| {
        let side = part.side.as_deref();
        part.classes.iter().find_map(|name| find(side, name).or_else(|| find(None, name)))
    };
    category.parts.iter().map(class).collect()
}

/// Side and the rest of a name, spelled together in small letters.
fn sided<'s>(name: &str, sides: &[&'s str]) -> (Option<&'s str>, String) {
    let letters: String = name.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    for &side in sides {
        if let Some(rest) = letters.strip_prefix(side).or_else(|| letters.strip_suffix(side)) {
            return (Some(side), rest.to_owned());
        }
    }
    (None, letters)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn people() -> Category {
        Category::from_json(include_str!("../../data/categories/people.json")).expect("people")
    }

    fn classes(names: &[&str]) -> Option<Vec<u32>> {
        class_of_parts(&people(), &names.iter().map(|name| name.to_string()).collect::<Vec<_>>())
    }

    #[test]
    fn names_are_merged_as_a_set_spells_and_groups_them() {
        let own: Vec<String> = people().parts.iter().map(|part| part.name.replace(' ', "_")).collect();
        assert_eq!(class_of_parts(&people(), &own), Some((0..14).collect()));
        let sideless = classes(&["head", "torso", "upperarm", "lowerarm", "hand", "upperleg", "lowerleg", "foot"]);
        assert_eq!(sideless, Some(vec![0, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7]));
        let coarse = classes(&["right leg", "left leg", "Left-Arm", "arm right", "Body"]);
        assert_eq!(coarse, Some(vec![4, 4, 2, 3, 2, 3, 2, 3, 1, 0, 1, 0, 1, 0]));
        assert_eq!(classes(&["head", "tail"]), None);
    }
}
