//! Farthest-point sampling, and the way back from the samples to every point.

use kiddo::{ImmutableKdTree, SquaredEuclidean};

/// `count` of the points `allowed`, each as far as possible from those before it (Gonzalez 1985), starting farthest from their centroid.
/// A prefix of the result is itself such a sampling. Ties go to the lower index, so the same points give the same samples.
pub fn farthest_points(points: &[[f64; 3]], allowed: &[u32], count: usize) -> Vec<u32> {
    let count = count.min(allowed.len());
    let mut chosen = Vec::with_capacity(count);
    if count == 0 {
        return chosen;
    }
    let position = |i: u32| points[i as usize];
    let mut centroid = [0.0; 3];
    for &i in allowed {
        (0..3).for_each(|c| centroid[c] += position(i)[c] / allowed.len() as f64);
    }
    let mut distance: Vec<f64> = allowed.iter().map(|&i| squared_distance(position(i), centroid)).collect();
    let mut next = farthest(&distance);
    distance.fill(f64::INFINITY);
    loop {
        chosen.push(allowed[next]);
        if chosen.len() == count {
            return chosen;
        }
        let newest = position(allowed[next]);
        for (d, &i) in distance.iter_mut().zip(allowed) {
            *d = d.min(squared_distance(position(i), newest));
        }
        // A chosen point is never chosen again, not even where all that is left are its copies.
        distance[next] = f64::NEG_INFINITY;
        next = farthest(&distance);
    }
}

fn farthest(distance: &[f64]) -> usize {
    let mut best = 0;
    for (i, &d) in distance.iter().enumerate() {
        if d > distance[best] {
            best = i;
        }
    }
    best
}

/// For every point, the row in `samples` of the sample nearest in space.
pub fn nearest_samples(points: &[[f64; 3]], samples: &[u32]) -> Vec<u32> {
    let positions: Vec<[f64; 3]> = samples.iter().map(|&i| points[i as usize]).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&positions) else {
        return vec![0; points.len()];
    };
    points.iter().map(|point| tree.query(point).nearest_one::<SquaredEuclidean<f64>>().execute().item).collect()
}

fn squared_distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum()
}
