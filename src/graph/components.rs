//! Connected pieces.

/// Labels of the connected pieces of a graph on `n` vertices, numbered in order of their lowest vertex, and their count.
pub fn components(n: usize, edges: impl IntoIterator<Item = (u32, u32)>) -> (Vec<u32>, usize) {
    let mut forest = Forest::new(n);
    for (i, j) in edges {
        forest.join(i, j);
    }
    let mut label_of_root = vec![u32::MAX; n];
    let mut count = 0;
    let labels = (0..n as u32)
        .map(|i| {
            let root = forest.root(i) as usize;
            if label_of_root[root] == u32::MAX {
                label_of_root[root] = count;
                count += 1;
            }
            label_of_root[root]
        })
        .collect();
    (labels, count as usize)
}

/// Disjoint sets with path halving.
pub(crate) struct Forest {
    parent: Vec<u32>,
}

impl Forest {
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    /// Joins the sets of `i` and `j`; false when they were one already.
    pub(crate) fn join(&mut self, i: u32, j: u32) -> bool {
        let (a, b) = (self.root(i), self.root(j));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }
}
