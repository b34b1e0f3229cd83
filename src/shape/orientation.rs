//! Triangles wound alike: which of them to turn so that neighbours agree about the outside.

use std::collections::VecDeque;

/// The two sides of faces that meet at an edge of exactly two faces, and whether these run along it in the same direction, which is to disagree.
fn hinges(faces: &[[u32; 3]]) -> Vec<(u32, u32, bool)> {
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (&[a, b, c], face) in faces.iter().zip(0..) {
        sides.extend([(a, b), (b, c), (c, a)].map(|(i, j)| (i.min(j), i.max(j), i > j, face)));
    }
    sides.sort_unstable();
    let edges = sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    edges
        .filter_map(|edge| match edge {
            [(.., first, one), (.., second, other)] => Some((*one, *other, first == second)),
            _ => None,
        })
        .collect()
}

/// The faces, in each patch the fewer of them turned so that neighbours agree; how many were turned; and along how many edges neighbours disagree all the
/// same, because the surface has one side only, as a Möbius strip has.
///
/// A patch is what hangs together by edges of exactly two faces: where three or more meet, no two of them are neighbours. A patch that cannot be made to
/// agree stays as it is.
pub(super) fn wound_alike(faces: &[[u32; 3]]) -> (Vec<[u32; 3]>, usize, usize) {
    let hinges = hinges(faces);
    let mut start = vec![0; faces.len() + 1];
    hinges.iter().flat_map(|&(one, other, _)| [one, other]).for_each(|face| start[face as usize + 1] += 1);
    for face in 0..faces.len() {
        start[face + 1] += start[face];
    }
    let mut next = start.clone();
    let mut neighbours = vec![(0, false); 2 * hinges.len()];
    for &(one, other, disagree) in &hinges {
        for (from, to) in [(one, other), (other, one)] {
            neighbours[next[from as usize]] = (to, disagree);
            next[from as usize] += 1;
        }
    }

    let mut wound = faces.to_vec();
    let (mut turned, mut contradicting) = (0, 0);
    let mut turn: Vec<Option<bool>> = vec![None; faces.len()];
    let (mut patch, mut front) = (Vec::new(), VecDeque::new());
    for seed in 0..faces.len() {
        if turn[seed].is_some() {
            continue;
        }
        patch.clear();
        turn[seed] = Some(false);
        front.push_back(seed);
        let (mut count, mut contradictions, mut disagreeing) = (0, 0, 0);
        while let Some(face) = front.pop_front() {
            patch.push(face);
            let own = turn[face] == Some(true);
            count += usize::from(own);
            for &(to, disagree) in &neighbours[start[face]..start[face + 1]] {
                disagreeing += usize::from(disagree);
                match turn[to as usize] {
                    Some(other) => contradictions += usize::from((own != other) != disagree),
                    None => {
                        turn[to as usize] = Some(own != disagree);
                        front.push_back(to as usize);
                    }
                }
            }
        }
        if contradictions > 0 {
            // Every edge was seen from both of its sides.
            contradicting += disagreeing / 2;
            continue;
        }
        let fewer = 2 * count <= patch.len();
        for &face in patch.iter().filter(|&&face| turn[face] == Some(fewer)) {
            wound[face].swap(1, 2);
            turned += 1;
        }
    }
    (wound, turned, contradicting)
}

#[cfg(test)]
mod tests {
    use super::wound_alike;
    use crate::shape::faces::agree;

    /// A band of 2n triangles around; with a twist it is a Möbius strip.
    fn band(n: u32, twisted: bool) -> Vec<[u32; 3]> {
        let at = |i: u32, side: u32| match i == n && twisted {
            true => 1 - side,
            false => 2 * (i % n) + side,
        };
        (0..n)
            .flat_map(|i| {
                let [a, b, c, d] = [at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    #[test]
    fn the_fewer_faces_of_each_piece_are_turned_back() {
        let whole = band(12, false);
        assert_eq!(wound_alike(&whole), (whole.clone(), 0, 0));
        let mut pair: Vec<[u32; 3]> = whole.clone();
        pair.extend(whole.iter().map(|face| face.map(|i| i + 24)));
        let mut crossed = pair.clone();
        [3, 4, 11, 30].into_iter().for_each(|face| crossed[face].swap(1, 2));
        assert!(!agree(&crossed));
        assert_eq!(wound_alike(&crossed), (pair.clone(), 4, 0));
        // A piece that is wound the other way as a whole contradicts nobody.
        pair[24..].iter_mut().for_each(|face| face.swap(1, 2));
        assert_eq!(wound_alike(&pair), (pair.clone(), 0, 0));
    }

    #[test]
    fn a_surface_of_one_side_stays_as_it_is_and_the_piece_beside_it_does_not() {
        let mut faces = band(12, true);
        let strip = faces.len();
        faces.extend(band(12, false).iter().map(|face| face.map(|i| i + 24)));
        faces[strip + 5].swap(1, 2);
        let (wound, turned, contradicting) = wound_alike(&faces);
        assert_eq!((turned, contradicting), (1, 1));
        assert_eq!(wound[..strip], faces[..strip]);
        assert!(agree(&wound[strip..]));
    }
}
