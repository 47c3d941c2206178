//! Which triangles of a mesh share an edge.

/// Neighbours of triangles. The side `k` of a triangle goes from its corner `k` to the next.
#[derive(Clone, Debug)]
pub struct Adjacency {
    /// Sides as `3 * triangle + k`, those of one edge side by side, triangles rising within an edge.
    sides: Vec<u32>,
    /// For each side (`3 * triangle + k`) where its edge begins in `sides`.
    first_of_edge: Vec<u32>,
    open_edges: usize,
    non_manifold_edges: usize,
    duplicate_triangles: usize,
    uneven_side: Option<u32>,
}

impl Adjacency {
    pub(super) fn new(triangles: &[[u32; 3]]) -> Self {
        let ends = |side: u32| {
            let triangle = triangles[side as usize / 3];
            let (a, b) = (triangle[side as usize % 3], triangle[(side as usize + 1) % 3]);
            (a.min(b), a.max(b))
        };
        let mut sides: Vec<u32> = (0..).take(3 * triangles.len()).collect();
        sides.sort_unstable_by_key(|&side| (ends(side), side));
        let mut adjacency = Self {
            first_of_edge: vec![0; sides.len()],
            sides,
            open_edges: 0,
            non_manifold_edges: 0,
            duplicate_triangles: duplicates(triangles),
            uneven_side: None,
        };
        let mut begin = 0;
        while begin < adjacency.sides.len() {
            let edge = ends(adjacency.sides[begin]);
            let count = adjacency.sides[begin..].iter().take_while(|&&side| ends(side) == edge).count();
            let is_up = |side: u32| {
                let triangle = triangles[side as usize / 3];
                triangle[side as usize % 3] < triangle[(side as usize + 1) % 3]
            };
            let ups = adjacency.sides[begin..begin + count].iter().filter(|&&side| is_up(side)).count();
            if 2 * ups != count && adjacency.uneven_side.is_none() {
                adjacency.uneven_side = Some(adjacency.sides[begin]);
            }
            for &side in &adjacency.sides[begin..begin + count] {
                adjacency.first_of_edge[side as usize] = u32::try_from(begin).unwrap_or(u32::MAX);
            }
            adjacency.open_edges += usize::from(count == 1);
            adjacency.non_manifold_edges += usize::from(count > 2);
            begin += count;
        }
        adjacency
    }

    /// The other triangles at side `k` of a triangle, each with the number of its own side there; rising.
    pub fn across(&self, triangle: usize, k: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let side = 3 * triangle + k;
        let first = self.first_of_edge[side];
        self.sides[first as usize..]
            .iter()
            .map(|&other| other as usize)
            .take_while(move |&other| self.first_of_edge[other] == first)
            .filter(move |&other| other != side)
            .map(|other| (other / 3, other % 3))
    }

    /// Edges with one triangle only.
    #[must_use]
    pub fn open_edges(&self) -> usize {
        self.open_edges
    }

    /// Edges with more than two triangles.
    #[must_use]
    pub fn non_manifold_edges(&self) -> usize {
        self.non_manifold_edges
    }

    /// Triangles with the same three vertices as an earlier one.
    #[must_use]
    pub fn duplicate_triangles(&self) -> usize {
        self.duplicate_triangles
    }

    /// Whether each edge is passed as often one way as the other.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.uneven_side.is_none()
    }

    /// A side (triangle and number of its side) of an edge that is passed more often one way than the other; `None` if there
    /// is no such edge.
    #[must_use]
    pub fn uneven_side(&self) -> Option<(usize, usize)> {
        self.uneven_side.map(|side| (side as usize / 3, side as usize % 3))
    }

    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.sides.as_slice()) + size_of_val(self.first_of_edge.as_slice())
    }
}

fn duplicates(triangles: &[[u32; 3]]) -> usize {
    let sorted = |&[a, b, c]: &[u32; 3]| {
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        [least, a ^ b ^ c ^ least ^ most, most]
    };
    let mut sets: Vec<[u32; 3]> = triangles.iter().map(sorted).collect();
    sets.sort_unstable();
    sets.windows(2).filter(|pair| pair[0] == pair[1]).count()
}
