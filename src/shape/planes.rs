//! Flat patches of a surface: floors, walls, the sides of furniture.

use std::collections::BTreeSet;

use faer::{Mat, Side};

use crate::graph::{Forest, Neighbours};
use crate::vector::{dot, minus};

/// Points that a plane is tried around, evenly taken from all.
const SEEDS: usize = 400;
/// Planes that are tried.
const TRIED: usize = 16;
/// A patch has at least this share of the points.
const LEAST: f64 = 0.025;
/// A point lies on a plane within this part of the spacing.
const THICK: f64 = 0.4;
/// And the surface around it is turned from the plane by no more than the angle of this cosine.
const AGREES: f64 = 0.9;

/// Of the points beside a noisy patch at least this share lies on either side of it.
const BOTH_SIDES: f64 = 0.25;

/// A flat patch.
pub struct Patch {
    /// Unit normal.
    pub normal: [f64; 3],
    /// Along the normal, from the origin.
    pub offset: f64,
    /// Points on it, ascending.
    pub points: Vec<u32>,
    /// Root of the mean squared distance of these from the plane.
    pub roughness: f64,
    /// Standard deviation of the distance of points from the plane by chance; 0 where nothing beside those on it lies on the other side.
    pub noise: f64,
}

impl Patch {
    /// Distance of a place from the plane, signed.
    pub fn height(&self, place: [f64; 3]) -> f64 {
        dot(self.normal, place) - self.offset
    }
}

/// The flat patches among evenly spread `points`, `spacing` apart, largest first. Points of one patch hang together by `neighbours`.
pub fn flat_patches(points: &[[f64; 3]], neighbours: &Neighbours, spacing: f64) -> Vec<Patch> {
    let n = neighbours.len();
    fn at<'i>(points: &[[f64; 3]], of: impl Iterator<Item = &'i u32>) -> Vec<[f64; 3]> {
        of.map(|&i| points[i as usize]).collect()
    }
    let normals: Vec<[f64; 3]> =
        (0..n).map(|i| Plane::of(&at(points, neighbours.of(i).iter().chain([&(i as u32)]))).normal).collect();
    let thick = THICK * spacing;
    let mut free = vec![true; n];
    let mut patches = Vec::new();
    for _ in 0..TRIED {
        let on_plane = |normal: [f64; 3], offset: f64| {
            let (free, normals) = (&free, &normals);
            (0..n).filter(move |&i| {
                free[i] && (dot(normal, points[i]) - offset).abs() <= thick && dot(normal, normals[i]).abs() >= AGREES
            })
        };
        let seeds = (0..n).step_by((n / SEEDS).max(1)).filter(|&i| free[i]);
        let best = seeds
            .map(|i| (on_plane(normals[i], dot(normals[i], points[i])).count(), i))
            .max_by_key(|&(count, i)| (count, std::cmp::Reverse(i)));
        let Some((_, seed)) = best.filter(|&(count, _)| count as f64 >= LEAST * n as f64) else { break };
        // Fitted anew to what lies on it, twice: the first comes from a few points.
        let (mut normal, mut offset) = (normals[seed], dot(normals[seed], points[seed]));
        let first: Vec<usize> = on_plane(normal, offset).collect();
        for _ in 0..2 {
            let fitted = Plane::of(&on_plane(normal, offset).map(|i| points[i]).collect::<Vec<_>>());
            (normal, offset) = (fitted.normal, dot(fitted.normal, fitted.middle));
        }
        let on: Vec<u32> = on_plane(normal, offset).map(|i| i as u32).collect();
        let patch = largest_together(&on, neighbours);
        // What was looked at is not looked at again, also where hardly a point lies on the plane that was fitted.
        on.iter().for_each(|&i| free[i as usize] = false);
        if (on.len() as f64) < LEAST * n as f64 {
            first.iter().for_each(|&i| free[i] = false);
        }
        if patch.len() as f64 >= LEAST * n as f64 {
            let squares = patch.iter().map(|&i| (dot(normal, points[i as usize]) - offset).powi(2));
            let roughness = (squares.sum::<f64>() / patch.len() as f64).sqrt();
            let height = |i: u32| dot(normal, points[i as usize]) - offset;
            let around: BTreeSet<u32> = patch.iter().flat_map(|&i| neighbours.of(i as usize)).copied().collect();
            // Noise is on both sides; what stands on a plane, or bends away from it, on one.
            let off = around.iter().filter(|&i| patch.binary_search(i).is_err());
            let (above, below): (Vec<u32>, Vec<u32>) = off.partition(|&&i| height(i) > 0.0);
            let noisy = above.len().min(below.len()) as f64 >= BOTH_SIDES * (above.len() + below.len()) as f64;
            let mut heights: Vec<f64> = around.iter().map(|&i| height(i).abs()).collect();
            let middle = heights.len() / 2;
            let noise = if noisy { 1.48 * *heights.select_nth_unstable_by(middle, f64::total_cmp).1 } else { 0.0 };
            patches.push(Patch { normal, offset, points: patch, roughness, noise });
        }
    }
    patches.sort_by_key(|patch| std::cmp::Reverse(patch.points.len()));
    patches
}

/// The most of `points`, ascending, that hang together.
fn largest_together(points: &[u32], neighbours: &Neighbours) -> Vec<u32> {
    let mut among = vec![false; neighbours.len()];
    points.iter().for_each(|&i| among[i as usize] = true);
    let mut forest = Forest::new(neighbours.len());
    for &i in points {
        neighbours.of(i as usize).iter().filter(|&&j| among[j as usize]).for_each(|&j| {
            forest.join(i, j);
        });
    }
    let roots: Vec<u32> = points.iter().map(|&i| forest.root(i)).collect();
    let mut sizes = vec![0; neighbours.len()];
    roots.iter().for_each(|&root| sizes[root as usize] += 1);
    let Some(&largest) = roots.iter().max_by_key(|&&root| (sizes[root as usize], std::cmp::Reverse(root))) else {
        return Vec::new();
    };
    points.iter().zip(&roots).filter(|(_, root)| **root == largest).map(|(&i, _)| i).collect()
}

/// The plane that points lie on best.
pub(super) struct Plane {
    /// Unit normal.
    pub(super) normal: [f64; 3],
    /// The middle of the points.
    pub(super) middle: [f64; 3],
    /// The share of their spread that is off it: 0 on a plane, ⅓ where they fill space evenly.
    pub(super) spread_off: f64,
}

impl Plane {
    /// Distance of a place from the plane, signed.
    pub(super) fn height(&self, place: [f64; 3]) -> f64 {
        dot(self.normal, minus(place, self.middle))
    }

    /// By principal components.
    pub(super) fn of(points: &[[f64; 3]]) -> Self {
        let count = points.len().max(1) as f64;
        let middle: [f64; 3] = std::array::from_fn(|c| points.iter().map(|p| p[c]).sum::<f64>() / count);
        let mut spread = Mat::<f64>::zeros(3, 3);
        for &p in points {
            let d = minus(p, middle);
            for r in 0..3 {
                for c in 0..3 {
                    spread[(r, c)] += d[r] * d[c];
                }
            }
        }
        let Ok(eigen) = spread.self_adjoint_eigen(Side::Lower) else {
            return Self { normal: [0.0, 0.0, 1.0], middle, spread_off: 0.0 };
        };
        // Eigenvalues ascend.
        let (normal, values) = (std::array::from_fn(|c| eigen.U()[(c, 0)]), eigen.S().column_vector());
        let all = values[0] + values[1] + values[2];
        Self { normal, middle, spread_off: if all > 0.0 { values[0] / all } else { 0.0 } }
    }
}

#[cfg(test)]
mod tests {
    use super::flat_patches;
    use crate::graph::nearest_neighbours;

    /// A grid of 40 × 40 points one apart in the plane of two axes.
    fn plate(corner: [f64; 3], axes: [usize; 2]) -> impl Iterator<Item = [f64; 3]> {
        (0..1600).map(move |i| {
            let mut p = corner;
            (p[axes[0]], p[axes[1]]) = (p[axes[0]] + f64::from(i % 40), p[axes[1]] + f64::from(i / 40));
            p
        })
    }

    #[test]
    fn the_sides_of_a_corner_are_found_and_nothing_on_a_sphere() {
        let corner: Vec<[f64; 3]> = plate([0.0; 3], [0, 1]).chain(plate([0.0, 0.0, 1.0], [0, 2])).collect();
        let patches = flat_patches(&corner, &nearest_neighbours(&corner, 10), 1.0);
        assert_eq!(patches.len(), 2);
        assert!(patches.iter().all(|patch| patch.points.len() > 1400 && patch.roughness < 0.1));
        let sphere: Vec<[f64; 3]> = (0..3000)
            .map(|i| {
                let (z, turn) = (1.0 - f64::from(2 * i + 1) / 3000.0, f64::from(i) * 2.399963);
                [(1.0 - z * z).sqrt() * turn.cos(), (1.0 - z * z).sqrt() * turn.sin(), z].map(|x| 15.0 * x)
            })
            .collect();
        assert!(flat_patches(&sphere, &nearest_neighbours(&sphere, 10), 1.0).is_empty());
        // Where every plane is as good as every other one, looking ends all the same.
        let copies = vec![[1.0, 2.0, 3.0]; 300];
        assert!(flat_patches(&copies, &nearest_neighbours(&copies, 10), 1.0).len() <= 1);
    }
}
