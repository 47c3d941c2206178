//! What a cut makes of the polygons and lids of a piece.

use std::collections::BTreeMap;

use glam::DVec3;

use super::piece::{AHEAD, Cut, Marks, Piece, Polygon, sides_of};

/// A piece as it is cut. Points are numbered as in the piece, then those at which edges are cut.
pub(super) struct Split<'a> {
    piece: &'a Piece,
    marks: &'a Marks,
    /// The edges that are cut, in order; the point of each comes at its place behind those of the piece.
    crossed: Vec<[u32; 2]>,
    points: Vec<DVec3>,
}

impl<'a> Split<'a> {
    pub(super) fn new(piece: &'a Piece, marks: &'a Marks, cut: &Cut) -> Self {
        let crossed: Vec<[u32; 2]> = piece.edges().iter().copied().filter(|&edge| marks.is_cut(edge)).collect();
        let mut points = piece.points.clone();
        points.extend(crossed.iter().map(|&edge| piece.cut_point(edge, cut)));
        Self { piece, marks, crossed, points }
    }

    /// The point at which an edge is cut, if it is.
    fn crossing(&self, [tail, head]: [u32; 2]) -> Option<u32> {
        let found = self.crossed.binary_search(&[tail.min(head), tail.max(head)]).ok()?;
        Some((self.piece.points.len() + found) as u32)
    }

    /// On which side of the plane a point lies, 0 in it.
    fn side(&self, point: u32) -> i8 {
        self.marks.sides.get(point as usize).copied().unwrap_or(0)
    }

    /// What of a polygon lies on a side.
    pub(super) fn clipped(&self, polygon: &Polygon, side: u8) -> Polygon {
        let off = if side == AHEAD { -1 } else { 1 };
        let mut kept = Polygon::new();
        for edge in sides_of(polygon) {
            if self.side(edge[0]) != off {
                kept.push(edge[0]);
            }
            kept.extend(self.crossing(edge));
        }
        kept
    }

    /// The borders of a lid's parts behind and ahead, each if there is one; a lid in the plane counts as ahead.
    pub(super) fn lid_halves(&self, lid: &[[u32; 2]]) -> [Option<Vec<[u32; 2]>>; 2] {
        if lid.iter().flatten().all(|&point| self.side(point) == 0) {
            return [None, Some(lid.to_vec())];
        }
        [-1, 1].map(|side| {
            let mut border = Vec::new();
            for &[tail, head] in lid {
                match self.crossing([tail, head]) {
                    Some(crossing) if self.side(tail) == side => border.push([tail, crossing]),
                    Some(crossing) => border.push([crossing, head]),
                    None if self.side(tail) == side || self.side(head) == side => border.push([tail, head]),
                    None => {}
                }
            }
            self.join_ends(&mut border);
            (!border.is_empty()).then_some(border)
        })
    }

    /// Closes a border by edges along the line on which its open ends lie.
    fn join_ends(&self, border: &mut Vec<[u32; 2]>) {
        let mut ends: BTreeMap<u32, i32> = BTreeMap::new();
        for &[tail, head] in &*border {
            *ends.entry(tail).or_default() -= 1;
            *ends.entry(head).or_default() += 1;
        }
        let mut ends: Vec<(u32, i32)> = ends.into_iter().filter(|&(_, count)| count != 0).collect();
        let place = |point: u32| self.points[point as usize];
        let (low, high) = ends.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &(point, _)| {
            (low.min(place(point)), high.max(place(point)))
        });
        let axis = (high - low).max_position();
        ends.sort_by(|a, b| place(a.0)[axis].total_cmp(&place(b.0)[axis]).then(a.0.cmp(&b.0)));
        // How often the line is still to be passed upwards, between an end and the next.
        let mut count = 0;
        for pair in ends.windows(2) {
            count += pair[0].1;
            let edge = if count > 0 { [pair[0].0, pair[1].0] } else { [pair[1].0, pair[0].0] };
            border.extend(std::iter::repeat_n(edge, count.unsigned_abs() as usize));
        }
    }

    /// The edges in the plane that the polygons and lids ahead of it leave open, as they pass them.
    pub(super) fn open_border(&self, polygons: &[Polygon], lids: &[Vec<[u32; 2]>]) -> Vec<[u32; 2]> {
        let mut passes: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for [tail, head] in polygons.iter().flat_map(sides_of).chain(lids.iter().flatten().copied()) {
            if self.side(tail) == 0 && self.side(head) == 0 && tail != head {
                *passes.entry([tail.min(head), tail.max(head)]).or_default() += if tail < head { 1 } else { -1 };
            }
        }
        let directed = |([low, high], count): ([u32; 2], i32)| {
            let edge = if count > 0 { [low, high] } else { [high, low] };
            std::iter::repeat_n(edge, count.unsigned_abs() as usize)
        };
        passes.into_iter().flat_map(directed).collect()
    }

    /// A piece of polygons and lids, with the points that they use.
    pub(super) fn piece(&self, mut polygons: Vec<Polygon>, mut lids: Vec<Vec<[u32; 2]>>) -> Piece {
        let mut numbers = vec![u32::MAX; self.points.len()];
        let mut points = Vec::new();
        let used = polygons.iter_mut().flatten().chain(lids.iter_mut().flatten().flatten());
        for point in used {
            let number = &mut numbers[*point as usize];
            if *number == u32::MAX {
                *number = points.len() as u32;
                points.push(self.points[*point as usize]);
            }
            *point = *number;
        }
        Piece::of(points, polygons, lids)
    }
}
