//! Where the rooms are, and which of them a doorway joins.

use super::Dice;

/// Rooms along x and z.
pub(super) const COLUMNS: usize = 6;
pub(super) const ROWS: usize = 4;
/// Width of a room along x and z, from middle of wall to middle of wall, metres.
pub(super) const ROOM: f64 = 10.0;

/// A room, by its column and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Room {
    pub(super) column: usize,
    pub(super) row: usize,
}

/// A direction along the axes of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Heading {
    East,
    South,
    West,
    North,
}

impl Heading {
    pub(super) const ALL: [Self; 4] = [Self::East, Self::South, Self::West, Self::North];

    /// Its unit vector in x and z.
    pub(super) fn vector(self) -> [f64; 2] {
        match self {
            Self::East => [1.0, 0.0],
            Self::South => [0.0, 1.0],
            Self::West => [-1.0, 0.0],
            Self::North => [0.0, -1.0],
        }
    }

    /// The direction to the right of it, seen from above.
    pub(super) fn right(self) -> Self {
        match self {
            Self::East => Self::South,
            Self::South => Self::West,
            Self::West => Self::North,
            Self::North => Self::East,
        }
    }

    pub(super) fn back(self) -> Self {
        self.right().right()
    }
}

impl Room {
    pub(super) fn all() -> impl Iterator<Item = Self> {
        (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| Self { column, row }))
    }

    /// Its middle in x and z.
    pub(super) fn middle(self) -> [f64; 2] {
        let along = |index: usize, count: usize| (index as f64 - 0.5 * (count as f64 - 1.0)) * ROOM;
        [along(self.column, COLUMNS), along(self.row, ROWS)]
    }

    /// The room next to it, if it is not the last.
    pub(super) fn next(self, heading: Heading) -> Option<Self> {
        let (column, row) = match heading {
            Heading::East => (Some(self.column + 1), Some(self.row)),
            Heading::South => (Some(self.column), Some(self.row + 1)),
            Heading::West => (self.column.checked_sub(1), Some(self.row)),
            Heading::North => (Some(self.column), self.row.checked_sub(1)),
        };
        let (column, row) = (column?, row?);
        (column < COLUMNS && row < ROWS).then_some(Self { column, row })
    }
}

/// Which walls have a doorway.
#[derive(Clone, Debug)]
pub(super) struct FloorPlan {
    /// Of each room, row by row: a doorway to the east, and one to the south.
    doorways: Vec<[bool; 2]>,
}

impl FloorPlan {
    /// A plan in which every room can be reached: the second row is open from end to end, every room is open to the
    /// south, and of the other walls two in three have a doorway.
    pub(super) fn new(dice: &mut Dice) -> Self {
        let doorways = Room::all().map(|room| [room.row == 1 || dice.below(3) < 2, true]).collect();
        Self { doorways }
    }

    /// Whether a doorway leads from a room into the next one.
    pub(super) fn is_open(&self, room: Room, heading: Heading) -> bool {
        let Some(next) = room.next(heading) else { return false };
        let of = |room: Room| self.doorways[room.row * COLUMNS + room.column];
        match heading {
            Heading::East => of(room)[0],
            Heading::South => of(room)[1],
            Heading::West => of(next)[0],
            Heading::North => of(next)[1],
        }
    }

    /// The directions in which a doorway leads out of a room; at least one.
    pub(super) fn ways(&self, room: Room) -> Vec<Heading> {
        Heading::ALL.into_iter().filter(|heading| self.is_open(room, *heading)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_room_can_be_reached() {
        for seed in 0..50 {
            let plan = FloorPlan::new(&mut Dice::new(seed));
            let mut reached = vec![Room { column: 0, row: 0 }];
            let mut index = 0;
            while let Some(&room) = reached.get(index) {
                for next in plan.ways(room).into_iter().filter_map(|heading| room.next(heading)) {
                    if !reached.contains(&next) {
                        reached.push(next);
                    }
                }
                index += 1;
            }
            assert_eq!(reached.len(), COLUMNS * ROWS, "seed {seed}");
        }
    }

    #[test]
    fn a_doorway_leads_both_ways() {
        let plan = FloorPlan::new(&mut Dice::new(3));
        for room in Room::all() {
            for heading in Heading::ALL {
                if let Some(next) = room.next(heading) {
                    assert_eq!(plan.is_open(room, heading), plan.is_open(next, heading.back()));
                }
            }
        }
    }
}
