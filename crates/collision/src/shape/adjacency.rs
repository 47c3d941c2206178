//! Which triangles of a mesh share an edge.
//!
//! # Method
//! Sides are counted into a list for each vertex, which is short; each list is then sorted by the other end.

use smallvec::SmallVec;

use super::topology::index_u32;

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
    pub(super) fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let side_count = 3 * triangles.len();
        let ends = ends_of_lists(vertex_count, triangles);
        let mut lists = lists_of_sides(&ends, triangles);
        let mut adjacency = Self {
            sides: Vec::with_capacity(side_count),
            first_of_edge: vec![0; side_count],
            open_edges: 0,
            non_manifold_edges: 0,
            duplicate_triangles: 0,
            uneven_side: None,
        };
        let mut begin = 0;
        for end in ends {
            let mut list = &mut lists[begin..end as usize];
            sort(list);
            while let Some(first) = list.first() {
                let higher = first.higher();
                let count = list.iter().position(|side| side.higher() != higher).unwrap_or(list.len());
                let (edge, rest) = list.split_at_mut(count);
                adjacency.add_edge(edge, triangles);
                list = rest;
            }
            begin = end as usize;
        }
        adjacency
    }

    /// Takes in the sides of the next edge.
    fn add_edge(&mut self, edge: &[Side], triangles: &[[u32; 3]]) {
        let begin = index_u32(self.sides.len());
        let mut up_count = 0;
        for side in edge {
            self.sides.push(side.number());
            self.first_of_edge[side.number() as usize] = begin;
            up_count += side.is_up();
        }
        let count = edge.len();
        if 2 * up_count as usize != count && self.uneven_side.is_none() {
            self.uneven_side = Some(edge[0].number());
        }
        self.open_edges += usize::from(count == 1);
        self.non_manifold_edges += usize::from(count > 2);
        if count > 1 {
            self.duplicate_triangles += duplicates(edge, triangles);
        }
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

/// A side in the list of its lower vertex: its higher vertex, its number, and whether it goes up from the lower one, in one
/// number that sorts by these.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side(u64);

impl Side {
    fn new(number: usize, from: u32, to: u32) -> Self {
        Self(u64::from(from.max(to)) << 32 | (number as u64) << 1 | u64::from(from < to))
    }

    fn higher(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// `3 * triangle + k`.
    fn number(self) -> u32 {
        self.0 as u32 >> 1
    }

    /// 1 if it is.
    fn is_up(self) -> u32 {
        self.0 as u32 & 1
    }
}

/// The end of each vertex's list of sides, where the lists of all vertices lie one after the other: a side is in that of
/// its lower vertex.
fn ends_of_lists(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut ends = vec![0; vertex_count];
    for &[a, b, c] in triangles {
        for lower in [a.min(b), b.min(c), c.min(a)] {
            ends[lower as usize] += 1;
        }
    }
    let mut end = 0;
    for count in &mut ends {
        end += *count;
        *count = end;
    }
    ends
}

/// The lists, each in any order.
fn lists_of_sides(ends: &[u32], triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut free = ends.to_vec();
    let mut lists = vec![Side(0); 3 * triangles.len()];
    for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
        for (k, [from, to]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
            let at = &mut free[from.min(to) as usize];
            *at -= 1;
            lists[*at as usize] = Side::new(3 * triangle + k, from, to);
        }
    }
    lists
}

/// Most vertices have few sides, for which this is quicker than a sort for many.
fn sort(list: &mut [Side]) {
    if list.len() > 24 {
        return list.sort_unstable();
    }
    for next in 1..list.len() {
        let side = list[next];
        let mut at = next;
        while at > 0 && list[at - 1] > side {
            list[at] = list[at - 1];
            at -= 1;
        }
        list[at] = side;
    }
}

/// How many of the triangles at an edge have the vertices of an earlier one there; counted at the edge of their two lowest
/// vertices only, so that each is once.
fn duplicates(edge: &[Side], triangles: &[[u32; 3]]) -> usize {
    let higher = edge[0].higher();
    let third = |side: &Side| triangles[side.number() as usize / 3][(side.number() as usize + 2) % 3];
    if let [one, other] = edge {
        return usize::from(third(one) == third(other) && third(one) > higher);
    }
    let mut thirds: SmallVec<[u32; 8]> = edge.iter().map(third).filter(|&third| third > higher).collect();
    thirds.sort_unstable();
    thirds.windows(2).filter(|pair| pair[0] == pair[1]).count()
}
