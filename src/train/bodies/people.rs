//! People drawn at random: much more varied than a crowd, so that whoever comes lies among them.

use rand_chacha::ChaCha8Rng;

use super::chance::{happens, normal, pick, uniform};
use super::shape_mixture::Person;
use super::style::Style;

/// Spread of the sliders drawn as normals about their middle; one in fourteen ends at a limit.
const SPREAD: f64 = 0.28;
/// The same for height, whose limits are giants of 2.5 m and dwarfs.
const HEIGHTS: f64 = 0.2;
/// Most detail targets on one person.
const DETAILS: usize = 10;

/// Detail targets: folder and name, the endings of the two directions, whether each side has its own, and how far they go.
const TARGETS: [(&str, [&str; 2], bool, f64); 46] = [
    ("torso/torso-scale-depth", ["decr", "incr"], false, 0.8),
    ("torso/torso-scale-horiz", ["decr", "incr"], false, 0.8),
    ("torso/torso-scale-vert", ["decr", "incr"], false, 0.8),
    ("torso/torso-vshape", ["decr", "incr"], false, 0.8),
    ("torso/torso-muscle-dorsi", ["decr", "incr"], false, 1.0),
    ("torso/torso-muscle-pectoral", ["decr", "incr"], false, 1.0),
    ("torso/measure-waist-circ", ["decr", "incr"], false, 0.6),
    ("torso/measure-hips-circ", ["decr", "incr"], false, 0.6),
    ("torso/measure-bust-circ", ["decr", "incr"], false, 0.6),
    ("torso/measure-shoulder-dist", ["decr", "incr"], false, 0.7),
    ("torso/measure-waisttohip-dist", ["decr", "incr"], false, 0.7),
    ("hip/hip-scale-depth", ["decr", "incr"], false, 0.8),
    ("hip/hip-scale-horiz", ["decr", "incr"], false, 0.8),
    ("hip/hip-waist", ["down", "up"], false, 1.0),
    ("stomach/stomach-tone", ["decr", "incr"], false, 1.0),
    ("stomach/stomach-pregnant", ["decr", "incr"], false, 0.8),
    ("buttocks/buttocks-volume", ["decr", "incr"], false, 1.0),
    ("neck/neck-scale-horiz", ["decr", "incr"], false, 0.8),
    ("neck/neck-scale-vert", ["decr", "incr"], false, 0.8),
    ("neck/neck-scale-depth", ["decr", "incr"], false, 0.8),
    ("neck/neck-double", ["decr", "incr"], false, 1.0),
    ("head/head-scale-horiz", ["decr", "incr"], false, 0.8),
    ("head/head-scale-vert", ["decr", "incr"], false, 0.8),
    ("head/head-scale-depth", ["decr", "incr"], false, 0.8),
    ("head/head-fat", ["decr", "incr"], false, 1.0),
    ("head/head-age", ["decr", "incr"], false, 1.0),
    ("nose/nose-volume", ["decr", "incr"], false, 1.0),
    ("nose/nose-scale-depth", ["decr", "incr"], false, 1.0),
    ("chin/chin-prominent", ["decr", "incr"], false, 1.0),
    ("chin/chin-width", ["decr", "incr"], false, 1.0),
    ("arms/{}-lowerarm-fat", ["decr", "incr"], true, 1.0),
    ("arms/{}-lowerarm-muscle", ["decr", "incr"], true, 1.0),
    ("arms/{}-lowerarm-scale-vert", ["decr", "incr"], true, 0.6),
    ("arms/{}-upperarm-fat", ["decr", "incr"], true, 1.0),
    ("arms/{}-upperarm-muscle", ["decr", "incr"], true, 1.0),
    ("arms/{}-upperarm-scale-vert", ["decr", "incr"], true, 0.6),
    ("arms/{}-upperarm-shoulder-muscle", ["decr", "incr"], true, 1.0),
    ("legs/{}-lowerleg-fat", ["decr", "incr"], true, 1.0),
    ("legs/{}-lowerleg-muscle", ["decr", "incr"], true, 1.0),
    ("legs/{}-lowerleg-scale-vert", ["decr", "incr"], true, 0.6),
    ("legs/{}-upperleg-fat", ["decr", "incr"], true, 1.0),
    ("legs/{}-upperleg-muscle", ["decr", "incr"], true, 1.0),
    ("legs/{}-upperleg-scale-vert", ["decr", "incr"], true, 0.6),
    ("legs/{}-leg-valgus", ["decr", "incr"], true, 0.6),
    ("feet/{}-foot-scale", ["decr", "incr"], true, 0.8),
    ("hands/{}-hand-scale", ["decr", "incr"], true, 0.8),
];

impl Person {
    /// Anyone: both sexes and what lies between (Beta(½, ½)), 30 % partly old, 15 % partly a child, builds to the limits of the data, mixed ancestry
    /// and up to ten detail targets.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        // Near a named value the value itself: half as many targets to add up.
        let snapped = |x: f64| {
            if x < 0.06 {
                0.0
            } else if x > 0.94 {
                1.0
            } else {
                x
            }
        };
        let mut slider = |spread: f64| snapped((0.5 + spread * normal(rng)).clamp(0.0, 1.0));
        let (muscle, weight, height) = (slider(SPREAD), slider(SPREAD), slider(HEIGHTS));
        let sex = snapped((std::f64::consts::FRAC_PI_2 * uniform(rng, 0.0..1.0)).sin().powi(2));
        let age = match uniform(rng, 0.0..1.0) {
            u if u < 0.30 => uniform(rng, 0.52..0.95),
            u if u < 0.45 => uniform(rng, 0.17..0.48),
            _ => 0.5,
        };
        let ancestry = if happens(rng, 0.4) {
            *pick(rng, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        } else {
            let shares = [0; 3].map(|_| -uniform(rng, 1e-9..1.0).ln());
            shares.map(|s| s / shares.iter().sum::<f64>())
        };
        let (proportions, cup) = (uniform(rng, 0.0..1.0), uniform(rng, 0.0..1.0));
        let count = (uniform(rng, 0.0..1.0) * (DETAILS + 1) as f64) as usize;
        let details = (0..count).flat_map(|_| detail(rng)).collect();
        Self { sex, age, muscle, weight, height, proportions, cup, ancestry, details, style: Style::default() }
    }
}

/// A detail target and its weight; both sides of a sided one, alike up to a tenth.
fn detail(rng: &mut ChaCha8Rng) -> Vec<(String, f64)> {
    let &(name, endings, sided, most) = pick(rng, &TARGETS);
    let ending = pick(rng, &endings);
    let weight = uniform(rng, 0.1..most);
    let sides: &[&str] = if sided { &["l", "r"] } else { &[""] };
    sides.iter().map(|s| (format!("{}-{ending}", name.replace("{}", s)), weight * uniform(rng, 0.9..1.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_crowd_has_its_extremes() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let crowd: Vec<Person> = (0..400).map(|_| Person::random(&mut rng)).collect();
        let share = |f: &dyn Fn(&Person) -> bool| crowd.iter().filter(|p| f(p)).count() as f64 / 400.0;
        // Standard error of a share at 0.3: 0.023.
        assert!((share(&|p| p.age > 0.5) - 0.30).abs() < 0.08);
        assert!((share(&|p| p.age < 0.5) - 0.15).abs() < 0.07);
        assert!(share(&|p| p.sex < 0.1) > 0.15 && share(&|p| p.sex > 0.9) > 0.15);
        assert!(share(&|p| p.height < 0.25) > 0.05 && share(&|p| p.weight > 0.9) > 0.05);
        assert!(crowd.iter().all(|p| (p.ancestry.iter().sum::<f64>() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn the_same_seed_is_the_same_person() {
        let person = |seed| Person::random(&mut ChaCha8Rng::seed_from_u64(seed));
        assert_eq!(person(5), person(5));
        assert_ne!(person(5), person(6));
    }
}
