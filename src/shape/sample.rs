//! Farthest-point sampling, and the way back from the samples to every point.

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::progress::Cancelled;
use crate::vector::squared_distance;

/// Points per bucket: few enough that a bucket is small against the spacing of the samples, many enough that there are not many buckets.
const BUCKET: usize = 64;

/// `count` of the points `allowed`, each as far as possible from those before it (Gonzalez 1985), starting farthest from their centroid.
/// A prefix of the result is itself such a sampling. Ties go to the lower index, so the same points give the same samples. `report` is given the share that is
/// done and may stop it.
///
/// Points lie in buckets with a box each, and a new sample only visits buckets that it may come nearer to than their farthest point is to the
/// samples before (the idea of Han et al. 2023, "QuickFPS"): 5000 of 320 000 points take 0.2 s instead of 12, and are the same.
pub fn farthest_points(
    points: &[[f64; 3]],
    allowed: &[u32],
    count: usize,
    report: &mut dyn FnMut(f64) -> Result<(), Cancelled>,
) -> Result<Vec<u32>, Cancelled> {
    let count = count.min(allowed.len());
    let mut chosen = Vec::with_capacity(count);
    if count == 0 {
        return Ok(chosen);
    }
    let mut centroid = [0.0; 3];
    for &i in allowed {
        (0..3).for_each(|c| centroid[c] += points[i as usize][c] / allowed.len() as f64);
    }
    let mut members: Vec<Member> = allowed
        .iter()
        .map(|&index| {
            let position = points[index as usize];
            Member { position, index, distance: squared_distance(position, centroid) }
        })
        .collect();
    let mut buckets = Vec::with_capacity(allowed.len() / BUCKET * 2 + 1);
    split(&mut members, 0, &mut buckets);
    let mut next = farthest(&buckets);
    members.iter_mut().for_each(|member| member.distance = f64::INFINITY);
    buckets.iter_mut().for_each(|bucket| bucket.farthest.distance = f64::INFINITY);
    loop {
        let (position, index) = (next.position, next.index);
        chosen.push(index);
        if chosen.len() == count {
            return Ok(chosen);
        }
        if chosen.len() % 256 == 0 {
            report(chosen.len() as f64 / count as f64)?;
        }
        for bucket in &mut buckets {
            if bucket.farthest.distance > bucket.squared_distance_to(position) || bucket.farthest.index == index {
                bucket.come_nearer(&mut members, position, index);
            }
        }
        next = farthest(&buckets);
    }
}

/// A point that may be chosen.
#[derive(Clone, Copy)]
struct Member {
    position: [f64; 3],
    index: u32,
    /// Squared distance to the nearest chosen point; −∞ once it is chosen itself, so that not even its copies make it come again.
    distance: f64,
}

/// Members that lie close together.
struct Bucket {
    members: std::ops::Range<usize>,
    low: [f64; 3],
    high: [f64; 3],
    farthest: Member,
}

impl Bucket {
    /// To the nearest corner, side or inside of the box.
    fn squared_distance_to(&self, point: [f64; 3]) -> f64 {
        let beyond: [f64; 3] = std::array::from_fn(|c| (self.low[c] - point[c]).max(point[c] - self.high[c]).max(0.0));
        beyond.iter().map(|d| d * d).sum()
    }

    fn come_nearer(&mut self, members: &mut [Member], newest: [f64; 3], index: u32) {
        let members = &mut members[self.members.clone()];
        for member in members.iter_mut() {
            member.distance = if member.index == index {
                f64::NEG_INFINITY
            } else {
                member.distance.min(squared_distance(member.position, newest))
            };
        }
        self.farthest = farthest_of(members);
    }
}

/// The farther one; of two equally far the one with the lower index.
fn farther(a: Member, b: Member) -> Member {
    if b.distance > a.distance || (b.distance == a.distance && b.index < a.index) { b } else { a }
}

fn farthest_of(members: &[Member]) -> Member {
    members[1..].iter().fold(members[0], |best, &member| farther(best, member))
}

fn farthest(buckets: &[Bucket]) -> Member {
    buckets[1..].iter().fold(buckets[0].farthest, |best, bucket| farther(best, bucket.farthest))
}

/// Halves the members across their longest side until they fit a bucket.
fn split(members: &mut [Member], start: usize, buckets: &mut Vec<Bucket>) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for member in members.iter() {
        for c in 0..3 {
            low[c] = low[c].min(member.position[c]);
            high[c] = high[c].max(member.position[c]);
        }
    }
    if members.len() <= BUCKET {
        buckets.push(Bucket { members: start..start + members.len(), low, high, farthest: farthest_of(members) });
        return;
    }
    let side = |c: usize| high[c] - low[c];
    let axis = (1..3).fold(0, |longest, c| if side(c) > side(longest) { c } else { longest });
    let middle = members.len() / 2;
    members.select_nth_unstable_by(middle, |a, b| {
        a.position[axis].total_cmp(&b.position[axis]).then(a.index.cmp(&b.index))
    });
    let (near, far) = members.split_at_mut(middle);
    split(near, start, buckets);
    split(far, start + middle, buckets);
}

/// For every point, the row in `samples` of the sample nearest in space.
pub fn nearest_samples(points: &[[f64; 3]], samples: &[u32]) -> Vec<u32> {
    let positions: Vec<[f64; 3]> = samples.iter().map(|&i| points[i as usize]).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&positions) else {
        return vec![0; points.len()];
    };
    points.iter().map(|point| tree.query(point).nearest_one::<SquaredEuclidean<f64>>().execute().item).collect()
}
