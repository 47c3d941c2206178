//! The connected parts of a mesh: what holds together by shared vertices.
//!
//! # Source
//! Disjoint sets with path halving: Tarjan, van Leeuwen, "Worst-case analysis of set union algorithms" (1984).

use super::topology::index_u32;

/// One vertex of each connected part, rising.
pub(super) fn first_vertices(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..).take(vertex_count).collect();
    for &[a, b, c] in triangles {
        for other in [b, c] {
            let (first, second) = (root(&mut parent, a), root(&mut parent, other));
            // The least vertex of a part is its root.
            let (least, most) = (first.min(second), first.max(second));
            parent[most as usize] = least;
        }
    }
    let is_root = |&(vertex, &parent): &(usize, &u32)| vertex == parent as usize;
    parent.iter().enumerate().filter(is_root).map(|(vertex, _)| index_u32(vertex)).collect()
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        let above = parent[parent[vertex as usize] as usize];
        parent[vertex as usize] = above;
        vertex = above;
    }
    vertex
}
