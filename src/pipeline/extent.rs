//! What a piece of a body is a piece of, in words.

use super::PreparedShape;

/// A group of parts is on a piece that has this share of what a body has of it.
const PRESENT: f64 = 0.4;

impl PreparedShape {
    /// `47 % of a body: head, torso, left arm`, by the network that is most at home with it; nothing of a whole body.
    pub fn extent(&self) -> Option<String> {
        let share = self.info.share;
        let percent = format!("{:.0} % of a body", 100.0 * share);
        let embedding = self.embeddings.first().filter(|_| share < 1.0)?;
        let category = &embedding.category;
        let mut mass = vec![0.0; self.points_used()];
        for (carrier, m) in self.basis.mass.iter().enumerate() {
            mass[self.support.row_of_carrier(carrier)] += m * share / self.basis.mass.sum();
        }
        let (mut here, mut there) = (vec![0.0; category.groups.len()], vec![0.0; category.groups.len()]);
        for (part, probability) in category.parts.iter().zip(embedding.parts.columns()) {
            // A category without groups has nothing to name.
            let Some(group) = here.get_mut(part.group) else { return Some(percent) };
            *group += probability.iter().zip(&mass).map(|(&p, m)| f64::from(p) * m).sum::<f64>();
            there[part.group] += part.area;
        }
        let present = category.groups.iter().zip(here.iter().zip(&there));
        let present: Vec<&str> =
            present.filter(|(_, (here, there))| **here >= PRESENT * **there).map(|(name, _)| name.as_str()).collect();
        Some(if present.is_empty() { percent } else { format!("{percent}: {}", present.join(", ")) })
    }
}
