//! A tree over the skin of a height field that stores no triangle and no box: least and greatest heights of blocks of cells.
//!
//! # Method
//! A block of level `n` has 2ⁿ cells along each side. From the second level up each block knows between which heights its
//! part of the surface lies; blocks with a wall or of holes only say so too. Boxes follow from that and from the block's
//! place. A search goes down from the one block that holds all, nearest first, and makes triangles of single cells only. Where
//! it may reach the floor, boxes go down to that.
//!
//! # Source
//! Tevs, Ihrke, Seidel, "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering" (2008), for the
//! pyramid; minima, walls and the search for the nearest are ours.

use std::ops::ControlFlow;

use glam::DVec3;
use smallvec::SmallVec;

use super::HeightField;
use crate::{
    broad::{Line, Toll, Tree, distance_at_least},
    math::Aabb,
};

/// The lowest level that is stored.
const LEAST_LEVEL: usize = 2;

/// Heights of blocks, as sent.
#[derive(Debug)]
pub(super) struct Pyramid {
    /// From [`LEAST_LEVEL`] up; the last one has one block.
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    /// Blocks along x.
    columns: usize,
    blocks: Vec<Range>,
}

/// Between which heights the surface of a block lies; the lower one is −∞ if there is a wall down to the floor. Of a block
/// of holes the lower is above the upper.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f32,
    high: f32,
}

/// A block of cells.
#[derive(Clone, Copy)]
struct Block {
    level: usize,
    column: usize,
    row: usize,
}

/// Whether a search may reach the floor.
#[derive(Clone, Copy, PartialEq)]
enum Floor {
    IsWanted,
    IsNot,
}

/// A block and where it begins on a path, or how far away it is.
#[derive(Clone, Copy)]
struct Open {
    begins: f64,
    block: Block,
}

impl Range {
    const NOTHING: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

impl Pyramid {
    fn new(field: &HeightField) -> Self {
        let mut levels: Vec<Level> = Vec::new();
        loop {
            let level = LEAST_LEVEL + levels.len();
            let (columns, rows) = (blocks_along(field.columns, level), blocks_along(field.rows, level));
            let below = levels.last();
            let places = (0..rows).flat_map(|row| (0..columns).map(move |column| Block { level, column, row }));
            let blocks = places.map(|block| match below {
                None => cells_of(field, block)
                    .map(|(column, row)| field.range(column, row))
                    .fold(Range::NOTHING, Range::union),
                Some(below) => {
                    children(field, block).map(|child| below.range(child)).fold(Range::NOTHING, Range::union)
                }
            });
            levels.push(Level { columns, blocks: blocks.collect() });
            if columns * rows == 1 {
                return Self { levels };
            }
        }
    }

    pub(super) fn memory_bytes(&self) -> u64 {
        let blocks: usize = self.levels.iter().map(|level| size_of_val(level.blocks.as_slice())).sum();
        (blocks + self.levels.capacity() * size_of::<Level>()) as u64
    }

    fn top(&self) -> Block {
        Block { level: LEAST_LEVEL + self.levels.len() - 1, column: 0, row: 0 }
    }
}

impl Level {
    fn range(&self, block: Block) -> Range {
        self.blocks[block.row * self.columns + block.column]
    }
}

/// How many blocks of a level there are along so many samples.
fn blocks_along(samples: usize, level: usize) -> usize {
    (samples - 1).div_ceil(1 << level)
}

/// The blocks of the next lower level in a block.
fn children(field: &HeightField, block: Block) -> impl Iterator<Item = Block> + use<> {
    let level = block.level - 1;
    let (columns, rows) = (blocks_along(field.columns, level), blocks_along(field.rows, level));
    let all = (0..4).map(move |k| Block { level, column: 2 * block.column + k % 2, row: 2 * block.row + k / 2 });
    all.filter(move |child| child.column < columns && child.row < rows)
}

/// The cells of a block, by column and row.
fn cells_of(field: &HeightField, block: Block) -> impl Iterator<Item = (usize, usize)> + use<> {
    let side = 1 << block.level;
    let columns = block.column * side..((block.column + 1) * side).min(field.columns - 1);
    let rows = block.row * side..((block.row + 1) * side).min(field.rows - 1);
    rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
}

impl HeightField {
    fn pyramid(&self) -> &Pyramid {
        self.pyramid.get_or_build(|| Pyramid::new(self))
    }

    /// That of a cell.
    fn range(&self, column: usize, row: usize) -> Range {
        if !self.is_filled(column as isize, row as isize) {
            return Range::NOTHING;
        }
        let at = |column: usize, row: usize| self.heights[row * self.columns + column];
        let heights = [at(column, row), at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)];
        let range = heights.into_iter().map(|height| Range { low: height, high: height });
        let range = range.fold(Range::NOTHING, Range::union);
        if self.has_wall(column, row) { Range { low: f32::NEG_INFINITY, ..range } } else { range }
    }

    /// That of a block of a level that is stored, or of a cell.
    fn range_of(&self, block: Block) -> Range {
        match block.level.checked_sub(LEAST_LEVEL) {
            Some(stored) => self.pyramid().levels[stored].range(block),
            None => self.range(block.column, block.row),
        }
    }

    /// The box of the surface of a block with walls, and with its floor if that is wanted; `None` if it has only holes.
    fn block_bounds(&self, block: Block, floor: Floor) -> Option<Aabb> {
        let range = self.range_of(block);
        if range.low > range.high {
            return None;
        }
        let side = 1 << block.level;
        let (x, z) = self.sample_place(block.column * side, block.row * side);
        let far_column = ((block.column + 1) * side).min(self.columns - 1);
        let far_row = ((block.row + 1) * side).min(self.rows - 1);
        let (far_x, far_z) = self.sample_place(far_column, far_row);
        let height = |height: f32| f64::from(height) * self.spacing.y + 0.0;
        let is_deep = floor == Floor::IsWanted || range.low == f32::NEG_INFINITY;
        let low = if is_deep { self.floor } else { height(range.low) };
        Some(Aabb::new(DVec3::new(x, low, z), DVec3::new(far_x, height(range.high), far_z)))
    }

    /// Goes down from the top: `begins` says where a box begins, or that nothing of it is wanted, given the limit; of open
    /// blocks the one that begins first is next. `visit` takes a leaf and returns the new limit.
    fn search<T: Toll>(
        &self,
        mut limit: f64,
        toll: &mut T,
        begins: impl Fn(&Aabb, f64) -> Option<f64>,
        mut visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        let level_floor = Aabb::new(self.bounds.min, self.bounds.max.with_y(self.floor));
        let floor = if begins(&level_floor, limit).is_some() { Floor::IsWanted } else { Floor::IsNot };
        let block_begins = |block: Block, limit: f64| begins(&self.block_bounds(block, floor)?, limit);
        // The first to begin is last.
        let mut open: SmallVec<[Open; 64]> = SmallVec::new();
        let top = self.pyramid().top();
        open.extend(block_begins(top, limit).map(|begins| Open { begins, block: top }));
        while let Some(Open { begins: entry, block }) = open.pop() {
            if entry > limit {
                continue;
            }
            toll.pay()?;
            if block.level > LEAST_LEVEL {
                for child in children(self, block) {
                    if let Some(begins) = block_begins(child, limit) {
                        let at = open.partition_point(|other| other.begins > begins);
                        open.insert(at, Open { begins, block: child });
                    }
                }
                continue;
            }
            let mut found: SmallVec<[(f64, u32); 64]> = SmallVec::new();
            for (column, row) in cells_of(self, block) {
                if block_begins(Block { level: 0, column, row }, limit).is_some() {
                    self.each_leaf((column, row), |leaf, corners| {
                        found.extend(begins(&around(corners), limit).map(|begins| (begins, leaf)));
                    });
                }
            }
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (begins, leaf) in found {
                if begins <= limit {
                    limit = limit.min(visit(toll, leaf)?);
                }
            }
        }
        Ok(())
    }
}

/// The box of a triangle.
fn around([a, b, c]: [DVec3; 3]) -> Aabb {
    Aabb::new(a.min(b).min(c), a.max(b).max(c))
}

impl Tree for HeightField {
    fn bounds(&self) -> Option<Aabb> {
        Some(self.bounds)
    }

    fn visit_box<T: Toll>(
        &self,
        query: Aabb,
        _layers: u32,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32) -> Result<ControlFlow<()>, T::Stop>,
    ) -> Result<(), T::Stop> {
        let begins = |bounds: &Aabb, _: f64| bounds.intersects(query).then_some(0.0);
        self.search(0.0, toll, begins, |toll, leaf| {
            Ok(if visit(toll, leaf)?.is_break() { f64::NEG_INFINITY } else { 0.0 })
        })
    }

    fn visit_ray<T: Toll>(
        &self,
        line: &Line,
        limit: f64,
        _layers: u32,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        self.search(limit, toll, |bounds, limit| line.entry(bounds, limit), visit)
    }

    fn visit_nearest<T: Toll>(
        &self,
        query: Aabb,
        limit: f64,
        _layers: u32,
        toll: &mut T,
        visit: impl FnMut(&mut T, u32) -> Result<f64, T::Stop>,
    ) -> Result<(), T::Stop> {
        let begins = |bounds: &Aabb, limit: f64| Some(distance_at_least(query, *bounds)).filter(|far| *far <= limit);
        self.search(limit, toll, begins, visit)
    }

    /// Neighbours touch, so this is a search by the box of every leaf.
    fn visit_pairs<T: Toll>(
        &self,
        toll: &mut T,
        mut visit: impl FnMut(&mut T, u32, u32) -> Result<(), T::Stop>,
    ) -> Result<(), T::Stop> {
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                let mut leaves: SmallVec<[(u32, Aabb); 12]> = SmallVec::new();
                self.each_leaf((column, row), |leaf, corners| leaves.push((leaf, around(corners))));
                for (leaf, bounds) in leaves {
                    self.visit_box(bounds, u32::MAX, toll, |toll, other| {
                        if other > leaf {
                            visit(toll, leaf, other)?;
                        }
                        Ok(ControlFlow::Continue(()))
                    })?;
                }
            }
        }
        Ok(())
    }
}
