//! Flesh gives way where limbs press on each other: skins that pass through each other are pushed apart until they lie against each other.
//!
//! Real scans touch in patches as large as a palm or a sole, skin on skin. Rigid limbs touch in a few points, or pass through each other, and a network that has
//! only seen that takes a sole that is pressed to the other leg for a piece of that leg.

use std::collections::BTreeSet;

use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::parts::PARTS;
use super::scan::normals;

/// Skin within this distance of a spot that touches may be moved (m).
const WITHIN: f64 = 0.07;
/// Skins farther apart than this do not feel each other (m).
const FELT: f64 = 0.03;
/// What is left between skins that press on each other (m).
const LEFT: f64 = 0.0005;
/// Rounds of pushing, each from the places that the one before left.
const ROUNDS: usize = 4;
/// Parts that hang together; their creases are not pressed apart. By name without sides, where a side is the same.
const JOINED: [(&str, &str); 7] = [
    ("head", "torso"),
    ("torso", "upper arm"),
    ("upper arm", "forearm"),
    ("forearm", "hand"),
    ("torso", "thigh"),
    ("thigh", "shank"),
    ("shank", "foot"),
];

/// Whether two parts can press on each other.
fn apart(a: u32, b: u32) -> bool {
    let split = |label: u32| PARTS[label as usize].split_once(' ').unwrap_or(("", PARTS[label as usize]));
    let ((side_a, name_a), (side_b, name_b)) = (split(a), split(b));
    let one_side = side_a.is_empty() || side_b.is_empty() || side_a == side_b;
    a != b && !(one_side && JOINED.iter().any(|&(x, y)| (x, y) == (name_a, name_b) || (y, x) == (name_a, name_b)))
}

/// Moves the vertices of a posed skin (metres) with part `labels`. `touching` are the places of the spots that touch ([`super::reach::Reach::touching`]).
pub fn press(skin: &mut [DVec3], triangles: &[[u32; 3]], labels: &[u32], touching: &[DVec3]) {
    if touching.is_empty() {
        return;
    }
    let near = |p: &DVec3| touching.iter().any(|spot| spot.distance_squared(*p) < WITHIN * WITHIN);
    let rows: Vec<usize> = (0..skin.len()).filter(|&i| near(&skin[i])).collect();
    let around = ring(triangles, &rows, skin.len());
    for _ in 0..ROUNDS {
        let normals = normals(skin, triangles);
        let mut inwards = vec![0.0; rows.len()];
        for part in 0..PARTS.len() as u32 {
            let of_part: Vec<usize> = rows.iter().copied().filter(|&j| labels[j] == part).collect();
            let places: Vec<[f64; 3]> = of_part.iter().map(|&j| skin[j].to_array()).collect();
            let (1.., Ok(tree)) = (places.len(), ImmutableKdTree::<f64, 3>::new_from_slice(&places)) else { continue };
            for (r, &i) in rows.iter().enumerate().filter(|&(_, &i)| apart(labels[i], part)) {
                let nearest = tree.query(&skin[i].to_array()).nearest_one::<SquaredEuclidean<f64>>().execute();
                let j = of_part[nearest.item as usize];
                if nearest.distance < FELT * FELT && normals[i].dot(normals[j]) < -0.1 {
                    let depth: f64 = LEFT - (skin[i] - skin[j]).dot(normals[j]);
                    inwards[r] = depth.max(0.0).max(2.0 * inwards[r]) / 2.0;
                }
            }
        }
        // A push takes the skin around it along, or the edge of the patch would be a step.
        let spread: Vec<f64> = (0..rows.len())
            .map(|r| {
                let mean = around[r].iter().map(|&s| inwards[s]).sum::<f64>() / around[r].len().max(1) as f64;
                inwards[r].max(0.5 * mean)
            })
            .collect();
        rows.iter().zip(spread).for_each(|(&i, push)| skin[i] -= push * normals[i]);
    }
}

/// For each of `rows` the rows of the vertices around it.
fn ring(triangles: &[[u32; 3]], rows: &[usize], count: usize) -> Vec<Vec<usize>> {
    let mut row_of = vec![usize::MAX; count];
    rows.iter().enumerate().for_each(|(row, &i)| row_of[i] = row);
    let mut around = vec![BTreeSet::new(); rows.len()];
    for t in triangles {
        let t = t.map(|v| row_of[v as usize]);
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            if a != usize::MAX && b != usize::MAX {
                around[a].insert(b);
                around[b].insert(a);
            }
        }
    }
    around.into_iter().map(|set| set.into_iter().collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 21 × 21 vertices, one centimetre apart, at height `y`; it faces up or down.
    fn square(y: f64, up: bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let at = |i: u32, j: u32| 21 * i + j;
        let points =
            (0..21).flat_map(|i| (0..21).map(move |j| DVec3::new(0.01 * f64::from(i), y, 0.01 * f64::from(j))));
        let cells = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
        let faces = cells.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            if up { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] }
        });
        (points.collect(), faces.collect())
    }

    #[test]
    fn skins_that_pass_through_each_other_come_to_lie_on_each_other() {
        // The lower one looks up and lies 6 mm above the upper one, which looks down.
        let ((mut skin, mut faces), (upper, more)) = (square(0.006, true), square(0.0, false));
        faces.extend(more.iter().map(|t| t.map(|v| v + 441)));
        skin.extend(upper);
        let hand_on_trunk: Vec<u32> = (0..882).map(|i| if i < 441 { 6 } else { 1 }).collect();
        let middle = DVec3::new(0.1, 0.003, 0.1);
        let before = skin.clone();
        press(&mut skin, &faces, &hand_on_trunk, &[middle]);
        let (low, high) = (skin[220].y, skin[441 + 220].y);
        assert!(high - low > 0.0 && high - low < 0.002, "{low} {high}");
        assert!((low - 0.003).abs() < 0.001, "each gives way by half: {low}");
        assert_eq!(skin[0], before[0], "what is far from the spot stays");
        // An arm and the trunk it hangs on are one.
        let mut joined = before.clone();
        press(&mut joined, &faces, &(0..882).map(|i| if i < 441 { 2 } else { 1 }).collect::<Vec<_>>(), &[middle]);
        assert_eq!(joined, before);
    }

    #[test]
    fn thighs_press_on_each_other_and_shanks_on_no_thigh_of_their_own() {
        let part = |name: &str| PARTS.iter().position(|part| *part == name).expect(name) as u32;
        assert!(apart(part("left thigh"), part("right thigh")));
        assert!(apart(part("right foot"), part("left shank")));
        assert!(apart(part("head"), part("left hand")));
        assert!(!apart(part("left thigh"), part("left shank")));
        assert!(!apart(part("torso"), part("right upper arm")));
        assert!(!apart(part("head"), part("head")));
    }
}
