//! Points that lie at exactly one place, as the corners of triangle soup and the split vertices at texture seams do.

/// For each point (n) the first one at its place; −0 equals 0.
pub(super) fn first_at_place(points: &[[f64; 3]]) -> Vec<u32> {
    let key = |i: u32| points[i as usize].map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut first = vec![0; points.len()];
    for place in order.chunk_by(|&i, &j| key(i) == key(j)) {
        place.iter().for_each(|&i| first[i as usize] = place[0]);
    }
    first
}

/// The faces with every corner moved to the `first` point at its place, without those of which two corners meet there.
pub(super) fn weld(faces: &[[u32; 3]], first: &[u32]) -> Vec<[u32; 3]> {
    let mut welded: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|i| first[i as usize])).collect();
    welded.retain(|[a, b, c]| a != b && b != c && c != a);
    welded
}
