//! Dressed bodies beside bare ones, in the layout that `evaluate` reads.

use std::path::Path;

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::avatar::{Avatar, legs_hang};
use super::chance::{happens, pick, uniform};
use super::data::DataError;
use super::layout::{Labelled, Layout};
use super::parts::PARTS;
use super::pose::{Arm, Pose};
use super::poses::Stance;
use super::random::PoseSource;
use super::samples::SampleError;
use super::scan::even_mesh;
use super::shape_mixture::Person;
use super::style::Style;
use super::{BodyModel, Template};

/// Points of the template that the truth is given at, and vertices of a bare body.
pub const POINTS: usize = 5000;
/// Share of bodies that stand or walk with their arms at their sides.
const GENTLE: f64 = 0.5;
/// Poses tried before another person is taken.
const POSES: usize = 10;
/// Largest share of a gentle body's spots inside another part.
const THROUGH: f64 = 0.004;

impl BodyModel {
    /// A person who stands or walks, arms a little away from the trunk, and the skin in metres.
    pub fn gentle_body(&self, template: &Template, rng: &mut ChaCha8Rng) -> Result<(Person, Vec<DVec3>), DataError> {
        loop {
            let person = Person::random(rng);
            let rest = self.rest(&person)?;
            for _ in 0..POSES {
                let mut pose = Pose::in_stance(*pick(rng, &[Stance::Standing, Stance::Standing, Stance::Stride]), rng);
                for arm in &mut pose.arms {
                    *arm = Arm {
                        raise: uniform(rng, 18.0..80.0),
                        forward: uniform(rng, -10.0..35.0),
                        elbow: uniform(rng, 0.0..40.0),
                        ..Arm::default()
                    };
                }
                let skin = self.posed(&rest, &pose.turns(&rest.skeleton)).skin;
                if template.reach.contact(&template.pick(&skin), &template.triangles).through <= THROUGH {
                    return Ok((person, skin));
                }
            }
        }
    }

    /// A person in a gentle pose, or in any.
    pub fn some_body(&self, template: &Template, rng: &mut ChaCha8Rng) -> Result<(Person, Vec<DVec3>), DataError> {
        if happens(rng, GENTLE) {
            return self.gentle_body(template, rng);
        }
        let body = self.draw_body(template, PoseSource::Free, Style::default(), rng)?;
        Ok((body.person, body.skin))
    }

    /// The avatar of a seed.
    pub fn avatar_of(&self, template: &Template, seed: u64) -> Result<Avatar, DataError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (person, skin) = self.some_body(template, &mut rng)?;
        self.avatar(&person, &skin, legs_hang(self, &skin), &mut rng)
    }

    /// A bare body as an even mesh of `points` vertices.
    pub fn bare(&self, skin: &[DVec3], points: usize, rng: &mut ChaCha8Rng) -> Labelled {
        let mesh = even_mesh(skin, &self.skin.triangles, points, rng);
        Labelled {
            points: mesh.vertices.iter().map(|&v| skin[v as usize]).collect(),
            labels: mesh.vertices.iter().map(|&v| self.labels[v as usize]).collect(),
            triangles: mesh.faces,
            seen: mesh.cell.into_iter().map(Some).collect(),
        }
    }
}

/// Writes `count` avatars, half as many bare bodies of other people, and pairs of both; returns the names of the shapes.
pub fn write_avatars(model: &BodyModel, out: &Path, count: usize, seed: u64) -> Result<Vec<String>, SampleError> {
    let layout = Layout::new(out, &["shells"])?;
    let template = model.template(POINTS)?;
    let avatars: Vec<String> = (0..count as u64).map(|i| format!("avatar_{:06}", seed + i)).collect();
    let bare_count = (count / 2).max(2);
    let bare: Vec<String> = (0..bare_count).map(|i| format!("bare_{:06}", seed + (count + i) as u64)).collect();
    for (i, name) in avatars.iter().enumerate() {
        let avatar = model.avatar_of(&template, seed + i as u64)?;
        let rows: Vec<String> = avatar.shells.iter().map(|(name, points, _)| format!("{points} {name}")).collect();
        layout.lines(&format!("shells/{name}.txt"), &rows)?;
        layout.shape(name, &avatar.labelled(model), model, &template)?;
    }
    for (i, name) in bare.iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(seed + (count + i) as u64);
        let (_, skin) = model.some_body(&template, &mut rng)?;
        layout.shape(name, &model.bare(&skin, POINTS, &mut rng), model, &template)?;
    }
    layout.lines("pairs.txt", &pairs(&avatars, &bare, seed))?;
    layout.save("labels.json", format!("{}\n", serde_json::json!(PARTS.map(|p| p.replace(' ', "_")))).into_bytes())?;
    layout.lines("NOTE.txt", &[note(count, bare_count, seed)])?;
    Ok([avatars, bare].concat())
}

impl Avatar {
    /// With the part of the skin below each point.
    pub fn labelled(&self, model: &BodyModel) -> Labelled {
        Labelled {
            points: self.points.clone(),
            triangles: self.triangles.clone(),
            labels: self.below.iter().map(|&v| model.labels[v as usize]).collect(),
            seen: self.seen.clone(),
        }
    }
}

/// Each avatar to two others, to two bare bodies, and from one.
fn pairs(avatars: &[String], bare: &[String], seed: u64) -> Vec<String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut pairs = Vec::new();
    for (i, name) in avatars.iter().enumerate() {
        let n = avatars.len();
        if n > 2 {
            let first = rng.random_range(1..n - 1);
            for step in [first, rng.random_range(first + 1..n)] {
                pairs.push(format!("{name} {}", avatars[(i + step) % n]));
            }
        }
        for step in 0..2 {
            pairs.push(format!("{name} {}", bare[(i + step) % bare.len()]));
        }
        pairs.push(format!("{} {name}", bare[(i + 2) % bare.len()]));
    }
    pairs
}

fn note(count: usize, bare: usize, seed: u64) -> String {
    format!(
        "{count} people of this project's generator, seeds from {seed}, dressed in shells as avatars are (shells/NAME.txt: points and name of each, in the \
         order of the points), and {bare} bare bodies of other people. The truth of a point of the body is the outermost surface above it; 0 where a skirt \
         hides it. Labels are those of the skin below. Metres, y up. CC0."
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_avatar_meets_two_others_and_bare_bodies_both_ways() {
        let names = |what: &str, n: usize| -> Vec<String> { (0..n).map(|i| format!("{what}{i}")).collect() };
        let pairs = pairs(&names("a", 12), &names("b", 6), 3);
        assert_eq!(pairs.len(), 12 * 5);
        assert!(pairs.iter().all(|p| p.split_once(' ').is_some_and(|(a, b)| a != b)));
        assert_eq!(pairs.iter().collect::<std::collections::BTreeSet<_>>().len(), pairs.len());
    }
}
