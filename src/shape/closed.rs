//! Whether a surface ends anywhere.

/// Whether there are faces, and every edge of them is in two or more.
pub(crate) fn is_closed(faces: &[[u32; 3]]) -> bool {
    let mut edges: Vec<[u32; 2]> =
        faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[u, v]| [u.min(v), u.max(v)]).collect();
    edges.sort_unstable();
    !faces.is_empty() && edges.chunk_by(|one, other| one == other).all(|same| same.len() > 1)
}

/// Whether it is a surface, and has an end.
pub(crate) fn has_borders(faces: &[[u32; 3]]) -> bool {
    !faces.is_empty() && !is_closed(faces)
}

#[cfg(test)]
mod tests {
    use super::{has_borders, is_closed};

    #[test]
    fn a_tetrahedron_is_closed_until_a_face_is_gone() {
        let faces = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
        assert!(is_closed(&faces));
        assert!(!is_closed(&faces[1..]));
        assert!(!is_closed(&[]));
        assert!(has_borders(&faces[1..]) && !has_borders(&faces) && !has_borders(&[]));
    }
}
