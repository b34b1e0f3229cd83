//! A body dressed in shells, as game avatars are: clothes over skin, hair, eyes, shoes, with borders of their own that share no vertex.

use std::collections::BTreeMap;

use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use super::BodyModel;
use super::chance::{happens, pick, uniform};
use super::data::DataError;
use super::scan::normals;
use super::shape_mixture::Person;
use super::shell::{Cover, Cut, Shell};
use super::skirt::skirt;
use super::trinkets::{ball, frame};
use super::wardrobe::{Garment, Measures};

/// Hidden skin that stays beside the hem of what hides it: metres.
const UNDER_HEM: f64 = 0.025;
/// A skirt hangs around shanks up to this far apart: metres.
const NEAR: f64 = 0.6;

/// All shells in one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Avatar {
    /// Metres.
    pub points: Vec<DVec3>,
    /// Over `points`.
    pub triangles: Vec<[u32; 3]>,
    /// The vertex of the skin below each point.
    pub below: Vec<u32>,
    /// The skin that was dressed, in metres.
    pub skin: Vec<DVec3>,
    /// For each vertex of the skin the point that is seen above it; `None` where it is hidden between the legs under a skirt.
    pub seen: Vec<Option<u32>>,
    /// Name, points and promise of a border of each shell, in the order in which their points follow.
    pub shells: Vec<(String, usize, bool)>,
}

/// Who is dressed.
struct Wearer<'a> {
    model: &'a BodyModel,
    skin: &'a [DVec3],
    normals: Vec<DVec3>,
    measures: Measures,
}

impl BodyModel {
    /// Dresses a posed person (metres). `hanging` says whether legs are near enough to each other for a skirt.
    pub fn avatar(
        &self,
        person: &Person,
        skin: &[DVec3],
        hanging: bool,
        rng: &mut ChaCha8Rng,
    ) -> Result<Avatar, DataError> {
        let normals = normals(skin, &self.skin.triangles);
        let wearer = Wearer { model: self, skin, normals, measures: Measures::of(self, person)? };
        let mut worn = wearer.clothes(hanging, rng);
        worn.extend(wearer.hair_and_shoes(rng));
        for shell in &mut worn {
            if happens(rng, 0.12) {
                shell.double();
            }
        }
        let mut linings = Vec::new();
        for shell in worn.iter().filter(|shell| shell.points.len() > 100) {
            if happens(rng, 0.3) {
                linings.push(shell.lining(uniform(rng, 0.001..0.003)));
            }
        }
        let mut shells = wearer.bare_skin(&worn, rng);
        shells.extend(worn);
        shells.extend(linings);
        shells.extend(wearer.trinkets(rng));
        if happens(rng, 0.4) {
            for shell in &mut shells {
                if happens(rng, 0.4) {
                    shell.confuse(rng);
                }
            }
        }
        Ok(Avatar::of(shells, skin, &self.skin.triangles))
    }
}

impl Wearer<'_> {
    fn garment(&self, name: &str, height: f64, count: usize, covered: &[bool], rng: &mut ChaCha8Rng) -> Shell {
        let ease = uniform(rng, 2.0..25.0) as usize;
        Garment { name, height, count, ease }.shell(self.model, self.skin, covered, rng)
    }

    /// Shirt, trousers or skirt, at times a coat and a belt; each above the one before it.
    fn clothes(&self, hanging: bool, rng: &mut ChaCha8Rng) -> Vec<Shell> {
        let labels = &self.model.labels;
        let dense = |rng: &mut ChaCha8Rng| (300.0 * uniform(rng, 0.0..2.3).exp()) as usize;
        let mut worn = Vec::new();
        let mut height = uniform(rng, 0.005..0.01);
        let (waist, ankle) = (uniform(rng, 0.05..0.3), *pick(rng, &[0.35, 0.6, 1.2, 1.75, 1.9]));
        let in_skirt = hanging && happens(rng, 0.7);
        let legs = if in_skirt { 0.2 } else { ankle };
        let trousers = self.measures.choose(labels, |part, along, _| match part {
            "torso" => along < waist,
            "thigh" | "shank" => along < legs,
            _ => false,
        });
        worn.push(self.garment(if in_skirt { "briefs" } else { "trousers" }, height, dense(rng), &trousers, rng));
        height += uniform(rng, 0.004..0.008);
        let (hem, neckline) = (uniform(rng, -0.1..waist - 0.04), uniform(rng, 0.82..1.05));
        let sleeve = *pick(rng, &[0.25, 0.5, 0.9, 1.5, 1.85]);
        let shirt = |part: &str, along: f64, _: usize| match part {
            "torso" => along > hem && along < neckline,
            "upper arm" | "forearm" => along < sleeve,
            _ => false,
        };
        worn.push(self.garment("shirt", height, dense(rng), &self.measures.choose(labels, shirt), rng));
        if in_skirt {
            let inside = self.measures.choose(labels, |part, along, _| match part {
                "torso" => along < 0.35,
                "thigh" | "shank" => true,
                _ => false,
            });
            let mean = |wanted: &dyn Fn(&str, f64) -> bool| {
                let chosen = self.measures.choose(labels, |part, along, _| wanted(part, along));
                let (sum, count) = chosen
                    .iter()
                    .zip(self.skin)
                    .filter(|(c, _)| **c)
                    .fold((DVec3::ZERO, 0.0), |(sum, count), (_, p)| (sum + *p, count + 1.0));
                sum / f64::max(count, 1.0)
            };
            let top = mean(&|part, along| part == "torso" && (along - 0.25).abs() < 0.06);
            let knees = mean(&|part, along| part == "shank" && along < 1.15);
            let ends = [top, top.lerp(knees, uniform(rng, 0.6..1.25))];
            worn.push(skirt("skirt", self.skin, &self.normals, &inside, ends, height + 0.005));
        }
        height += uniform(rng, 0.006..0.01);
        if happens(rng, 0.3) {
            // Open at the front.
            let opening = uniform(rng, 0.015..0.04);
            let rest = &self.measures.rest;
            let front = self.measures.choose(labels, |part, _, v| {
                part == "torso" && self.measures.rest[v].z > 0.02 && rest[v].x.abs() < opening
            });
            let low = uniform(rng, 0.1..0.5);
            let coat = self.measures.choose(labels, |part, along, v| match part {
                "torso" => along < 0.97 && !front[v],
                "upper arm" | "forearm" => along < 1.88,
                "thigh" => along < low,
                _ => false,
            });
            worn.push(self.garment("coat", height + uniform(rng, 0.0..0.012), dense(rng), &coat, rng));
        } else if happens(rng, 0.5) {
            let middle = uniform(rng, 0.1..0.25);
            let belt = self.measures.choose(labels, |part, along, _| part == "torso" && (along - middle).abs() < 0.05);
            worn.push(self.garment("belt", height, 200, &belt, rng));
        }
        worn
    }

    fn hair_and_shoes(&self, rng: &mut ChaCha8Rng) -> Vec<Shell> {
        let labels = &self.model.labels;
        let mut worn = Vec::new();
        if happens(rng, 0.85) {
            let long = if happens(rng, 0.4) { uniform(rng, 0.15..0.45) } else { 0.0 };
            let hair = self.measures.hair(labels, long);
            worn.push(self.garment(
                "hair",
                uniform(rng, 0.01..0.035),
                uniform(rng, 300.0..1500.0) as usize,
                &hair,
                rng,
            ));
        }
        if happens(rng, 0.85) {
            let (shaft, height) = (*pick(rng, &[1.9, 1.9, 1.7, 1.4]), uniform(rng, 0.006..0.014));
            let count = uniform(rng, 200.0..800.0) as usize;
            for side in ["left", "right"] {
                let other = if side == "left" { "right" } else { "left" };
                let shoe =
                    self.measures.choose(labels, |part, along, _| part == "foot" || part == "shank" && along > shaft);
                let own = |v: usize| !super::parts::PARTS[labels[v] as usize].starts_with(other);
                let shoe: Vec<bool> = shoe.iter().enumerate().map(|(v, &c)| c && own(v)).collect();
                worn.push(self.garment(&format!("{side} shoe"), height, count, &shoe, rng));
            }
        }
        worn
    }

    /// The skin: at times cut away where clothes hide it, at times with head and hands apart.
    fn bare_skin(&self, worn: &[Shell], rng: &mut ChaCha8Rng) -> Vec<Shell> {
        let triangles = &self.model.skin.triangles;
        let mut hidden = vec![false; self.skin.len()];
        let cut_away = happens(rng, 0.55);
        for cover in worn.iter().filter(|_| cut_away).flat_map(|shell| &shell.covers) {
            hidden[cover.vertex as usize] = true;
        }
        erode(&mut hidden, triangles, self.skin, UNDER_HEM);
        let (head_apart, hands_apart) = (happens(rng, 0.6), happens(rng, 0.6));
        let piece = |v: u32| match self.model.labels[v as usize] {
            0 if head_apart => 1,
            6 if hands_apart => 2,
            7 if hands_apart => 3,
            _ => 0,
        };
        let gap = if happens(rng, 0.6) { uniform(rng, 0.0..0.005) } else { 0.0 };
        let counts = [uniform(rng, 1500.0..4000.0), uniform(rng, 1000.0..3000.0), uniform(rng, 400.0..3000.0)];
        let mut shells = Vec::new();
        for (number, name) in ["skin", "head", "left hand", "right hand"].into_iter().enumerate() {
            let cut = Cut::of(triangles, |t| {
                piece(t[0].min(t[1]).min(t[2])) == number && !t.iter().all(|&v| hidden[v as usize])
            });
            if cut.triangles.is_empty() {
                continue;
            }
            let mut places = cut.pick(self.skin);
            cut.draw_back(&mut places, 0.5 * gap);
            let heights = vec![0.0; places.len()];
            shells.push(cut.shell(name, &places, &heights, counts[number.min(2)] as usize, rng));
        }
        shells
    }

    /// Eyes always; buttons and teeth at times.
    fn trinkets(&self, rng: &mut ChaCha8Rng) -> Vec<Shell> {
        let (labels, rest) = (&self.model.labels, &self.measures.rest);
        // The vertex of the front nearest to a place seen from the front.
        let front = |label: u32, x: f64, along: f64| {
            let apart = |v: &usize| {
                let up = self.measures.along[*v] - along;
                (rest[*v].x - x).abs() + 0.4 * up.abs() - 0.3 * rest[*v].z
            };
            (0..labels.len()).filter(|&v| labels[v] == label).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
        };
        let mut shells = Vec::new();
        let on = |name: &str, v: usize, depth: f64, radii: [f64; 3]| {
            let n = self.normals[v];
            ball(name, self.skin[v] - depth * n, frame(n), radii, v as u32)
        };
        for (name, x) in [("left eye", 1.0), ("right eye", -1.0)] {
            shells.push(on(name, front(0, x * 0.031, 0.66), 0.008, [0.012; 3]));
        }
        if happens(rng, 0.6) {
            shells.push(on("upper teeth", front(0, 0.0, 0.46), 0.012, [0.02, 0.005, 0.008]));
            shells.push(on("lower teeth", front(0, 0.0, 0.43), 0.014, [0.018, 0.005, 0.008]));
        }
        if happens(rng, 0.5) {
            let count = uniform(rng, 3.0..9.0) as usize;
            for i in 0..count {
                let along = 0.15 + 0.65 * i as f64 / count as f64;
                shells.push(on(&format!("button {i}"), front(1, 0.0, along), -0.02, [0.006, 0.006, 0.003]));
            }
        }
        shells
    }
}

/// Takes vertices nearer than `margin` (along edges, about) to what is not hidden out of what is.
fn erode(hidden: &mut [bool], triangles: &[[u32; 3]], skin: &[DVec3], margin: f64) {
    let mut way: Vec<f64> = hidden.iter().map(|&h| if h { f64::INFINITY } else { 0.0 }).collect();
    loop {
        let mut changed = false;
        for t in triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let (a, b, length) = (a as usize, b as usize, skin[a as usize].distance(skin[b as usize]));
                for (from, to) in [(a, b), (b, a)] {
                    if way[from] + length < way[to] && way[from] + length < margin {
                        way[to] = way[from] + length;
                        changed = true;
                    }
                }
            }
        }
        if !changed {
            break;
        }
    }
    hidden.iter_mut().zip(way).for_each(|(h, w)| *h = w.is_infinite());
}

impl Avatar {
    /// Puts shells together and finds what is outermost over each vertex of the skin.
    fn of(shells: Vec<Shell>, skin: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut avatar = Self {
            points: Vec::new(),
            triangles: Vec::new(),
            below: Vec::new(),
            skin: skin.to_vec(),
            seen: Vec::new(),
            shells: Vec::new(),
        };
        let mut outermost: BTreeMap<u32, (f64, Option<u32>)> = BTreeMap::new();
        for shell in shells {
            let first = avatar.points.len() as u32;
            for Cover { vertex, height, point } in &shell.covers {
                let here = outermost.entry(*vertex).or_insert((f64::NEG_INFINITY, None));
                if *height >= here.0 {
                    *here = (*height, point.map(|p| p + first));
                }
            }
            avatar.shells.push((shell.name, shell.points.len(), shell.open));
            avatar.points.extend(shell.points);
            avatar.below.extend(shell.below);
            avatar.triangles.extend(shell.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        let mut seen: Vec<Option<Option<u32>>> =
            (0..skin.len() as u32).map(|v| outermost.get(&v).map(|(_, point)| *point)).collect();
        // Where a gap leaves a vertex bare, what is over its neighbour.
        while seen.contains(&None) {
            let before = seen.clone();
            for &[a, b, c] in triangles {
                for (v, w) in [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)] {
                    let (v, w) = (v as usize, w as usize);
                    if seen[v].is_none() {
                        seen[v] = before[w];
                    }
                }
            }
            if seen == before {
                break;
            }
        }
        avatar.seen = seen.into_iter().map(Option::flatten).collect();
        avatar
    }
}

/// Whether thighs hang near enough to each other for a skirt around both, for a posed skin in metres.
pub fn legs_hang(model: &BodyModel, skin: &[DVec3]) -> bool {
    let mean = |label: u32| {
        let of = skin.iter().zip(&model.labels).filter(|(_, l)| **l == label).map(|(p, _)| *p);
        let (sum, count) = of.fold((DVec3::ZERO, 0.0), |(s, c), p| (s + p, c + 1.0));
        sum / f64::max(count, 1.0)
    };
    let ways = [(8, 10), (9, 11)].map(|(thigh, shank)| (mean(shank) - mean(thigh)).normalize_or_zero());
    let apart = mean(10).distance(mean(11));
    ways.iter().all(|way| way.y < -0.75) && apart < NEAR
}
