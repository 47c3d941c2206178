//! The boxes of a tree, level by level, for those who draw it.

use std::collections::VecDeque;

use super::{
    forest::{Nodes, Rooted},
    node::{NO_NODE, Target},
};
use crate::math::Aabb;

/// The box of a node or leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeBox {
    /// Rounded outwards, metres.
    pub bounds: Aabb,
    /// 0 is the root.
    pub level: u32,
}

/// See [`super::StaticTree::node_boxes`].
pub(super) fn node_boxes(tree: &impl Rooted, level_max: u32, count_max: usize) -> Vec<NodeBox> {
    let forest = tree.forest();
    let mut boxes = Vec::new();
    let mut open = VecDeque::new();
    for cell in forest.cells.iter().filter(|cell| cell.root != NO_NODE) {
        boxes.push(NodeBox { bounds: cell.bounds, level: 0 });
        open.push_back((cell.root, cell.origin, 1));
    }
    boxes.extend(tree.listed().map(|large| NodeBox { bounds: large.bounds, level: 0 }));
    while let Some((index, origin, level)) = open.pop_front() {
        if level > level_max || boxes.len() >= count_max {
            break;
        }
        let node = forest.nodes.node(index);
        for lane in node.taken() {
            boxes.push(NodeBox { bounds: node.lane(lane).in_world(origin), level });
            if let Target::Node(below) = node.children[lane].target() {
                open.push_back((below, origin, level + 1));
            }
        }
    }
    boxes.truncate(count_max);
    boxes
}
