//! What kind of body a network knows, as data: its parts and how they hang together, and the numbers that were fitted to it. It travels in the header of a
//! weights file and is checked there, so that nothing in this crate knows one kind of body from another.

use ndarray::ArrayView1;
use serde::{Deserialize, Serialize};

use super::WeightsError;

/// Most parts that a category may have: labels of parts are bytes.
const MOST_PARTS: usize = 255;
/// Cues of confidence that every category has: three signs of a fault near and wide, and two of the network's at the point, near and wide.
pub(crate) const CUES: usize = 12;
/// Rows of the confidence table: refined by registration or not, by clouds or meshes.
pub(crate) const SITUATIONS: usize = 4;

/// A kind of body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Category {
    /// Its name, for many of them: `"people"`.
    pub name: String,
    /// The name of one, as sentences have it.
    pub one: String,
    /// Version of this description.
    pub version: u32,
    /// The parts; a label is an index here.
    pub parts: Vec<Part>,
    /// Pairs of parts that meet on a body, besides each with itself.
    pub meeting: Vec<[usize; 2]>,
    /// Names of coarser groups of parts.
    #[serde(default)]
    pub groups: Vec<String>,
    /// Parts whose probabilities together are one cue of confidence each; parts in none are what is left.
    #[serde(default)]
    pub cues: Vec<Vec<usize>>,
    /// Shortest and longest extent of a body along an axis, in metres: what the unit of a scan is told from. Without it no unit is.
    #[serde(default)]
    pub extent: Option<[f64; 2]>,
    /// When a shape is none of this category.
    pub thresholds: Thresholds,
    /// Coefficients of confidence, four rows: of first maps where a cloud takes part and between meshes (whose faces agree on an
    /// outside), then the same after registration. Each has a
    /// constant, then cycle, strain and residual, each near and wide, then how unsure the network is of the part and how differently it speaks of a point and its match, each at
    /// the point, near and wide, then one per group of `cues`, then that of the prior. Empty where none were fitted.
    #[serde(default)]
    pub confidence: Vec<Vec<f64>>,
    /// The same where one of the two is a piece, without groups and prior. Empty: as between wholes.
    #[serde(default)]
    pub confidence_of_pieces: Vec<Vec<f64>>,
}

/// A part of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Part {
    /// Its name.
    pub name: String,
    /// The side it is on, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<String>,
    /// The same part of the other side, or itself.
    pub mirror: usize,
    /// Index of its group.
    #[serde(default)]
    pub group: usize,
    /// The share of a body's area that it has on average.
    pub area: f64,
    /// What other data sets may call it, without side, in small letters and one word, the nearest first; where they count more coarsely, what it belongs to.
    #[serde(default)]
    pub classes: Vec<String>,
}

/// Above and below what a pair or a shape is unlike those a network was trained on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Thresholds {
    /// Largest ‖C_ab C_ba − I‖²/k of a pair.
    pub bijectivity: f64,
    /// Smallest mean probability of the likeliest part of a shape.
    pub certainty: f64,
    /// Share of a cloud's edges between parts that do not meet from which limbs are in contact.
    pub contact: f64,
}

impl Category {
    /// From JSON; says what is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, WeightsError> {
        let category: Self = serde_json::from_str(text).map_err(|e| WeightsError(format!("its category: {e}")))?;
        category.check().map_err(|problem| WeightsError(format!("its category \"{}\": {problem}", category.name)))?;
        Ok(category)
    }

    /// As JSON, as it stands in the header of weights.
    pub fn to_json(&self) -> Result<String, WeightsError> {
        serde_json::to_string(self).map_err(|e| WeightsError(e.to_string()))
    }

    /// Whether everything in it fits together.
    pub(crate) fn check(&self) -> Result<(), String> {
        let count = self.parts.len();
        if !(1..=MOST_PARTS).contains(&count) {
            return Err(format!("{count} parts; there must be 1 to {MOST_PARTS}"));
        }
        let known = |part: usize, what: &str| match part < count {
            true => Ok(()),
            false => Err(format!("{what} names part {part} of {count}")),
        };
        for (i, part) in self.parts.iter().enumerate() {
            known(part.mirror, "a mirror image")?;
            if self.parts[part.mirror].mirror != i {
                let other = &self.parts[part.mirror].name;
                return Err(format!(
                    "the mirror image of \"{}\" is \"{other}\", but not the other way round",
                    part.name
                ));
            }
            if part.group >= self.groups.len() && !self.groups.is_empty() {
                return Err(format!("\"{}\" is of group {} of {}", part.name, part.group, self.groups.len()));
            }
            if self.parts[..i].iter().any(|before| before.name == part.name) {
                return Err(format!("two parts are called \"{}\"", part.name));
            }
            if !(part.area > 0.0 && part.area <= 1.0) {
                return Err(format!("\"{}\" has {} of the area", part.name, part.area));
            }
        }
        let area: f64 = self.parts.iter().map(|part| part.area).sum();
        if (area - 1.0).abs() > 0.02 {
            return Err(format!("the parts have {area} of the area together"));
        }
        for (at, &[i, j]) in self.meeting.iter().enumerate() {
            known(i, "a pair that meets")?;
            known(j, "a pair that meets")?;
            if i == j || self.meeting[..at].iter().any(|&[p, q]| [p, q] == [i, j] || [q, p] == [i, j]) {
                return Err(format!("\"{}\" and \"{}\" meet twice", self.parts[i].name, self.parts[j].name));
            }
            let mirrored = [self.parts[i].mirror, self.parts[j].mirror];
            if !self.meet(mirrored[0], mirrored[1]) {
                let [one, other] = [&self.parts[i].name, &self.parts[j].name];
                return Err(format!("\"{one}\" and \"{other}\" meet, but their mirror images do not"));
            }
        }
        self.cues.iter().flatten().try_for_each(|&part| known(part, "a cue"))?;
        if let Some([shortest, longest]) = self.extent
            && !(shortest > 0.0 && longest > shortest && longest.is_finite())
        {
            return Err(format!("its extent is {shortest} to {longest} metres"));
        }
        let Thresholds { bijectivity, certainty, contact } = self.thresholds;
        if !(bijectivity > 0.0 && (0.0..=1.0).contains(&certainty) && (0.0..=1.0).contains(&contact)) {
            return Err(format!("its thresholds are {:?}", self.thresholds));
        }
        let of_wholes = (&self.confidence, 1 + CUES + self.cues.len() + 1, "wholes");
        for (table, row, of) in [of_wholes, (&self.confidence_of_pieces, 1 + CUES, "pieces")] {
            let complete =
                |coefficients: &Vec<f64>| coefficients.len() == row && coefficients.iter().all(|c| c.is_finite());
            if !(table.is_empty() || table.len() == SITUATIONS && table.iter().all(complete)) {
                return Err(format!("confidence of {of} needs {SITUATIONS} rows of {row} numbers, or none"));
            }
        }
        Ok(())
    }

    /// Whether two parts are one or meet.
    pub fn meet(&self, i: usize, j: usize) -> bool {
        i == j || self.meeting.iter().any(|&[p, q]| [p, q] == [i, j] || [q, p] == [i, j])
    }

    /// Probability that two points belong to one part or to parts that meet, by their probabilities of parts, as if these were independent of each other:
    /// where both are in doubt between parts that do not meet, it is as low as where they differ.
    pub(crate) fn meeting(&self, p: ArrayView1<f32>, q: ArrayView1<f32>) -> f32 {
        let same: f32 = p.dot(&q);
        same + self.meeting.iter().map(|&[i, j]| p[i] * q[j] + p[j] * q[i]).sum::<f32>()
    }

    /// Whether it was found out when a shape is of another category: scans of one's own say nothing of that.
    pub(crate) fn knows_others(&self) -> bool {
        self.thresholds.certainty > 0.0
    }

    /// Names of the parts.
    pub fn part_names(&self) -> Vec<&str> {
        self.parts.iter().map(|part| part.name.as_str()).collect()
    }
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, array};

    use super::Category;

    fn people() -> Category {
        Category::from_json(include_str!("../../data/categories/people.json")).expect("people")
    }

    fn certain(part: usize) -> Array1<f32> {
        let mut row = Array1::zeros(people().parts.len());
        row[part] = 1.0;
        row
    }

    #[test]
    fn parts_meet_themselves_and_their_neighbours_on_both_sides_alike() {
        let people = people();
        let meeting = |i: usize, j: usize| people.meeting(certain(i).view(), certain(j).view());
        for i in 0..people.parts.len() {
            for j in 0..people.parts.len() {
                assert_eq!(meeting(i, j), if people.meet(i, j) { 1.0 } else { 0.0 }, "{i} {j}");
                assert_eq!(meeting(i, j), meeting(j, i));
                assert_eq!(meeting(i, j), meeting(people.parts[i].mirror, people.parts[j].mirror));
            }
        }
        let doubtful = array![0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(people.meeting(doubtful.view(), certain(4).view()), 0.5, "torso or hand beside a forearm");
    }

    #[test]
    fn the_mirror_image_of_a_part_and_of_its_group_is_on_the_other_side() {
        let people = people();
        let other = |name: &str| name.replace("left", "LEFT").replace("right", "left").replace("LEFT", "right");
        for part in &people.parts {
            let mirrored = &people.parts[part.mirror];
            assert_eq!(mirrored.name, other(&part.name));
            assert_eq!(people.groups[mirrored.group], other(&people.groups[part.group]));
            assert_eq!(mirrored.side.as_deref().map(other), part.side, "{}", part.name);
        }
    }

    #[test]
    fn a_category_whose_pieces_do_not_fit_is_refused_by_what_is_wrong() {
        let refused = |change: &dyn Fn(&mut Category)| {
            let mut changed = people();
            change(&mut changed);
            changed.check().expect_err("refused")
        };
        assert!(refused(&|c| c.parts.clear()).contains("0 parts"));
        assert!(refused(&|c| c.parts[2].mirror = 5).contains("not the other way round"));
        assert!(refused(&|c| c.parts[0].mirror = 99).contains("part 99 of 14"));
        assert!(refused(&|c| c.parts[1].name = "head".to_owned()).contains("two parts"));
        assert!(refused(&|c| c.parts[0].area = 0.5).contains("together"));
        assert!(refused(&|c| c.parts[0].area = f64::NAN).contains("of the area"));
        assert!(refused(&|c| c.meeting.push([2, 9])).contains("mirror images do not"));
        assert!(refused(&|c| c.meeting.push([0, 14])).contains("part 14"));
        assert!(refused(&|c| c.meeting.push([1, 0])).contains("meet twice"));
        assert!(refused(&|c| c.meeting.push([3, 3])).contains("meet twice"));
        assert!(refused(&|c| c.cues[0].push(14)).contains("a cue"));
        assert!(refused(&|c| c.groups.truncate(3)).contains("group 3 of 3"));
        assert!(refused(&|c| c.extent = Some([2.0, 1.0])).contains("extent"));
        assert!(refused(&|c| c.thresholds.certainty = f64::NAN).contains("thresholds"));
        assert!(refused(&|c| c.confidence = vec![vec![0.0; 21]; 3]).contains("wholes needs 4 rows of 21"));
        assert!(refused(&|c| c.confidence_of_pieces = vec![vec![0.0; 21]; 4]).contains("pieces needs 4 rows of 13"));
    }
}
