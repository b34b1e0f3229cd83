//! Points spread over a surface: by area at random, then thinned by farthest-point sampling.

use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// Where it is.
    pub place: DVec3,
    /// The nearest corner of the triangle it lies in.
    pub vertex: u32,
}

/// `count` points drawn uniformly by area.
pub fn uniform_points(positions: &[DVec3], triangles: &[[u32; 3]], count: usize, rng: &mut ChaCha8Rng) -> Vec<DVec3> {
    draw_points(positions, triangles, count, rng).into_iter().map(|drawn| drawn.place).collect()
}

/// The same with the vertices they lie next to.
pub fn draw_points(positions: &[DVec3], triangles: &[[u32; 3]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Drawn> {
    let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize]);
    let mut total = 0.0;
    let up_to: Vec<f64> = triangles
        .iter()
        .map(|t| {
            let [p, q, r] = corners(t);
            total += (q - p).cross(r - p).length();
            total
        })
        .collect();
    let mut draw = || {
        let at = rng.random::<f64>() * total;
        let t = up_to.partition_point(|&a| a <= at).min(triangles.len() - 1);
        let [p, q, r] = corners(&triangles[t]);
        // The square root makes the density even over the triangle.
        let (s, v) = (rng.random::<f64>().sqrt(), rng.random::<f64>());
        let place = p * (1.0 - s) + q * (s * (1.0 - v)) + r * (s * v);
        let distance = |&w: &u32| positions[w as usize].distance_squared(place);
        let nearest = triangles[t].into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        Drawn { place, vertex: nearest.unwrap_or(triangles[t][0]) }
    };
    (0..count).map(|_| draw()).collect()
}

/// Indices of `count` points, each the farthest from those before it; the first is point 0.
pub fn farthest_points(points: &[DVec3], count: usize) -> Vec<usize> {
    let mut distance = vec![f64::INFINITY; points.len()];
    let mut chosen = Vec::with_capacity(count);
    let mut next = 0;
    while chosen.len() < count.min(points.len()) {
        chosen.push(next);
        let from = points[next];
        for (d, p) in distance.iter_mut().zip(points) {
            *d = d.min(p.distance_squared(from));
        }
        next = (0..points.len()).max_by(|&a, &b| distance[a].total_cmp(&distance[b])).unwrap_or(0);
    }
    chosen
}

/// For each point of `queries` the index of the nearest of `points`.
pub fn nearest(queries: &[DVec3], points: &[DVec3]) -> Vec<u32> {
    let to = |q: &DVec3| {
        let distance = |i: &u32| points[*i as usize].distance_squared(*q);
        (0..points.len() as u32).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    queries.iter().map(to).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn points_are_spread_by_area_not_by_triangle() {
        // One large and one small triangle, areas 9 : 1.
        let positions =
            [DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 3.0, DVec3::Z, DVec3::Z + DVec3::X, DVec3::Z + DVec3::Y];
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let points = uniform_points(&positions, &triangles, 4000, &mut ChaCha8Rng::seed_from_u64(1));
        let large = points.iter().filter(|p| p.z == 0.0).count();
        // Binomial(4000, 0.9): standard deviation 19.
        assert!((3500..3700).contains(&large), "{large}");
        assert!(points.iter().all(|p| p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 3.0 + 1e-12));
    }

    #[test]
    fn farthest_points_of_a_line_halve_it_again_and_again() {
        let line: Vec<DVec3> = (0..9).map(|i| DVec3::X * f64::from(i)).collect();
        assert_eq!(farthest_points(&line, 3), [0, 8, 4]);
        assert_eq!(nearest(&[DVec3::X * 3.4], &line), [3]);
    }
}
