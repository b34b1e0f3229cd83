//! A person's rest shape: MakeHuman's macro targets, mixed.
//!
//! Every macro detail (sex, age, muscle, …) lies between two named values and gives each a factor; the two sum to 1. A
//! target names one value of several details, and its weight is the product of their factors. The values and their places
//! on the 0–1 sliders are those of `targets/macrodetails/macro.json`.

use glam::DVec3;

use super::data::{BodyData, DataError};
use super::style::Style;

/// Who it is. Every number is a slider in [0, 1]; ½ is the middle of the population.
#[derive(Clone, Debug, PartialEq)]
pub struct Person {
    /// 0 female, 1 male.
    pub sex: f64,
    /// 0 a baby, 0.1875 ten years, 0.5 twenty-five, 1 ninety.
    pub age: f64,
    /// Muscle from least to most.
    pub muscle: f64,
    /// Weight from least to most.
    pub weight: f64,
    /// Height from least to most, for the sex and age.
    pub height: f64,
    /// Proportions from uncommon to ideal.
    pub proportions: f64,
    /// Chest from least to most; acts on the female share only.
    pub cup: f64,
    /// Shares of the African, Asian and Caucasian targets; they should sum to 1.
    pub ancestry: [f64; 3],
    /// Detail targets (`nose/nose-volume-incr`) and their weights.
    pub details: Vec<(String, f64)>,
    /// Proportions that no person has.
    pub style: Style,
}

impl Default for Person {
    fn default() -> Self {
        let half = 0.5;
        Self {
            sex: half,
            age: half,
            muscle: half,
            weight: half,
            height: half,
            proportions: half,
            cup: half,
            ancestry: [1.0 / 3.0; 3],
            details: Vec::new(),
            style: Style::default(),
        }
    }
}

/// A named value of a macro detail and its factor. An empty name is the value without a target.
type Factor = (&'static str, f64);

impl Person {
    /// The targets that make this person: file names under `targets` (no ending) and weights, all weights positive.
    pub fn terms(&self) -> Vec<(String, f64)> {
        let sexes = between(self.sex, &[(0.0, "female"), (1.0, "male")]);
        let ages = between(self.age, &[(0.0, "baby"), (0.1875, "child"), (0.5, "young"), (1.0, "old")]);
        let muscles = between(self.muscle, &[(0.0, "minmuscle"), (0.5, "averagemuscle"), (1.0, "maxmuscle")]);
        let weights = between(self.weight, &[(0.0, "minweight"), (0.5, "averageweight"), (1.0, "maxweight")]);
        let heights = between(self.height, &[(0.0, "minheight"), (0.5, ""), (1.0, "maxheight")]);
        let cups = between(self.cup, &[(0.0, "mincup"), (0.5, ""), (1.0, "maxcup")]);
        let kinds = [(0.0, "uncommonproportions"), (0.5, ""), (1.0, "idealproportions")];
        let proportions = between(self.proportions, &kinds);

        let mut terms = self.details.clone();
        let mut add = |name: String, weight: f64| {
            if weight > 0.0 {
                terms.push((name, weight));
            }
        };
        for &(sex, by_sex) in &sexes {
            for &(age, by_age) in &ages {
                for (people, share) in ["african", "asian", "caucasian"].iter().zip(self.ancestry) {
                    add(format!("macrodetails/{people}-{sex}-{age}"), share * by_sex * by_age);
                }
                for (&(muscle, by_muscle), &(weight, by_weight)) in pairs(&muscles, &weights) {
                    let factor = by_sex * by_age * by_muscle * by_weight;
                    let build = format!("{sex}-{age}-{muscle}-{weight}");
                    add(format!("macrodetails/universal-{build}"), factor);
                    for &(height, by_height) in named(&heights) {
                        add(format!("macrodetails/height/{build}-{height}"), factor * by_height);
                    }
                    for &(kind, by_kind) in named(&proportions).filter(|_| age != "baby") {
                        add(format!("macrodetails/proportions/{build}-{kind}"), factor * by_kind);
                    }
                    for &(cup, by_cup) in named(&cups).filter(|_| sex == "female" && age != "baby") {
                        add(format!("breast/{build}-{cup}-averagefirmness"), factor * by_cup);
                    }
                }
            }
        }
        terms
    }

    /// Rest positions (all base vertices, helpers included) in decimetres.
    pub fn shape(&self, data: &BodyData) -> Result<Vec<DVec3>, DataError> {
        let mut shape = data.base.clone();
        for (name, weight) in self.terms() {
            for &(vertex, offset) in data.target(&name)?.iter() {
                shape[vertex as usize] += weight * offset;
            }
        }
        Ok(shape)
    }
}

/// The two values around `x` with their factors; those with factor 0 are left out.
fn between(x: f64, values: &[(f64, &'static str)]) -> Vec<Factor> {
    let (first, last) = (values[0].0, values[values.len() - 1].0);
    let x = x.clamp(first, last);
    let at = values.windows(2).position(|w| x <= w[1].0).unwrap_or(0);
    let ((low, low_name), (high, high_name)) = (values[at], values[at + 1]);
    let t = (x - low) / (high - low);
    [(low_name, 1.0 - t), (high_name, t)].into_iter().filter(|f| f.1 > 0.0).collect()
}

fn named(factors: &[Factor]) -> impl Iterator<Item = &Factor> {
    factors.iter().filter(|f| !f.0.is_empty())
}

fn pairs<'a>(a: &'a [Factor], b: &'a [Factor]) -> impl Iterator<Item = (&'a Factor, &'a Factor)> {
    a.iter().flat_map(move |x| b.iter().map(move |y| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_multiply_and_each_family_sums_to_one() {
        let person = Person { sex: 0.3, age: 0.62, muscle: 0.8, weight: 0.1, height: 0.9, ..Person::default() };
        let sum = |part: &str| -> f64 { person.terms().iter().filter(|t| t.0.contains(part)).map(|t| t.1).sum() };
        assert!((sum("universal-") - 1.0).abs() < 1e-12);
        assert!((sum("asian") + sum("african") - 1.0).abs() < 1e-12, "caucasian contains asian");
        assert!((sum("-maxheight") - 0.8).abs() < 1e-12);
        assert_eq!(sum("-idealproportions"), 0.0);
    }

    #[test]
    fn a_slider_on_a_named_value_uses_that_value_alone() {
        let woman = Person { sex: 0.0, ..Person::default() };
        let builds: Vec<_> = woman.terms().into_iter().filter(|t| t.0.contains("universal")).collect();
        assert_eq!(builds, [("macrodetails/universal-female-young-averagemuscle-averageweight".to_owned(), 1.0)]);
    }
}
