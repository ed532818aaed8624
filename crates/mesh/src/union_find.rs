//! Disjoint sets (Tarjan 1975), by path halving; the smaller index leads, so that
//! the result does not depend on the order of the unions.

/// Sets over 0 … n − 1.
pub struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    /// Every element alone.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// The smallest element of this one's set.
    pub fn find(&mut self, mut element: u32) -> u32 {
        while self.parent[element as usize] != element {
            let grandparent = self.parent[self.parent[element as usize] as usize];
            self.parent[element as usize] = grandparent;
            element = grandparent;
        }
        element
    }

    /// Makes one set of two.
    pub fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
