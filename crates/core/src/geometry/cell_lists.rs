//! Numbers kept by cell of the plane, found again by cell.
//!
//! Cells are kept in blocks of 8 × 8. A ray mostly stays in a block from one cell to the next, and a bit for each cell
//! tells whether there is anything in it; most cells of a floor are empty.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use super::cells::Cell;

/// Cells along an edge of a block, as a power of two.
const BLOCK_BITS: i32 = 3;
/// Column or row within a block.
const BLOCK_MASK: i32 = (1 << BLOCK_BITS) - 1;
/// Cells of a block.
const BLOCK_CELLS: usize = 1 << (2 * BLOCK_BITS);

/// See the module.
#[derive(Clone, Default)]
pub(super) struct CellLists {
    blocks: Vec<Block>,
    of_place: HashMap<u64, u32, BuildHasherDefault<PlaceHasher>>,
}

#[derive(Clone)]
struct Block {
    /// A bit for each cell that holds something.
    occupied: u64,
    cells: [Vec<u32>; BLOCK_CELLS],
}

fn place_of((x, y): Cell) -> u64 {
    (u64::from((x >> BLOCK_BITS) as u32) << 32) | u64::from((y >> BLOCK_BITS) as u32)
}

fn within((x, y): Cell) -> usize {
    (((y & BLOCK_MASK) << BLOCK_BITS) | (x & BLOCK_MASK)) as usize
}

impl CellLists {
    /// Adds a number to a cell.
    pub fn add(&mut self, cell: Cell, number: u32) {
        let block = *self.of_place.entry(place_of(cell)).or_insert_with(|| {
            self.blocks.push(Block {
                occupied: 0,
                cells: [const { Vec::new() }; BLOCK_CELLS],
            });
            (self.blocks.len() - 1) as u32
        });
        let block = &mut self.blocks[block as usize];
        let k = within(cell);
        block.occupied |= 1 << k;
        block.cells[k].push(number);
    }

    /// Takes a number out of a cell.
    pub fn remove(&mut self, cell: Cell, number: u32) {
        let Some(&block) = self.of_place.get(&place_of(cell)) else {
            return;
        };
        let block = &mut self.blocks[block as usize];
        let k = within(cell);
        let list = &mut block.cells[k];
        if let Some(at) = list.iter().position(|&n| n == number) {
            list.swap_remove(at);
        }
        if list.is_empty() {
            block.occupied &= !(1 << k);
        }
    }

    /// For looking into cells near each other.
    pub fn reader(&self) -> Reader<'_> {
        Reader {
            lists: self,
            known: [None; REMEMBERED * REMEMBERED],
        }
    }
}

/// Blocks along an edge of the square of blocks that a reader remembers (16 m), a power of two.
const REMEMBERED: usize = 8;

/// Looks into cells; remembers the blocks that it has seen, one for each remainder of column and row.
pub(super) struct Reader<'a> {
    lists: &'a CellLists,
    known: [Option<(u64, Option<&'a Block>)>; REMEMBERED * REMEMBERED],
}

impl<'a> Reader<'a> {
    /// What a cell holds, in no order.
    #[inline]
    pub fn get(&mut self, cell: Cell) -> &'a [u32] {
        let k = within(cell);
        match self.block(cell) {
            Some(block) if block.occupied >> k & 1 != 0 => &block.cells[k],
            _ => &[],
        }
    }

    /// Calls `visit` for every cell of row `y` from column `x0` to `x1` that holds something, with what it holds. Cells that hold
    /// nothing, most of a floor, cost nothing.
    #[inline]
    pub fn in_row(&mut self, y: i32, (x0, x1): (i32, i32), mut visit: impl FnMut(Cell, &'a [u32])) {
        for column in x0 >> BLOCK_BITS..=x1 >> BLOCK_BITS {
            let first = column << BLOCK_BITS;
            let Some(block) = self.block((first, y)) else {
                continue;
            };
            let row = within((first, y));
            let (from, to) = ((x0 - first).max(0), (x1 - first).min(BLOCK_MASK));
            let wanted = (2_u64 << to) - (1 << from);
            let mut held = block.occupied >> row & wanted;
            while held != 0 {
                let k = held.trailing_zeros();
                visit((first + k as i32, y), &block.cells[row + k as usize]);
                held &= held - 1;
            }
        }
    }

    #[inline]
    fn block(&mut self, cell: Cell) -> Option<&'a Block> {
        let place = place_of(cell);
        let remainder = |v: i32| (v >> BLOCK_BITS) as usize % REMEMBERED;
        let known = &mut self.known[remainder(cell.1) * REMEMBERED + remainder(cell.0)];
        if let Some((at, block)) = known
            && *at == place
        {
            return *block;
        }
        let number = self.lists.of_place.get(&place);
        let block = number.map(|&k| &self.lists.blocks[k as usize]);
        *known = Some((place, block));
        block
    }
}

/// Places of blocks are small integers: one multiplication mixes them well enough and is ten times faster than SipHash.
#[derive(Clone, Copy, Default)]
struct PlaceHasher(u64);

impl Hasher for PlaceHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.write_u64(u64::from(b));
        }
    }
    fn write_u64(&mut self, key: u64) {
        let mixed = (self.0 ^ key).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 29);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_into_a_cell_is_there_and_nowhere_else() {
        let mut lists = CellLists::default();
        for k in -20..20 {
            lists.add((k, 3 * k), (k + 20) as u32);
        }
        lists.add((0, 0), 99);
        lists.remove((0, 0), 20);
        lists.remove((5, 15), 25);
        let mut reader = lists.reader();
        assert_eq!(reader.get((0, 0)), [99]);
        assert!(reader.get((5, 15)).is_empty());
        assert!(reader.get((1, 0)).is_empty());
        assert_eq!(reader.get((-20, -60)), [0]);
        assert_eq!(reader.get((19, 57)), [39]);
    }

    #[test]
    fn a_row_gives_what_its_cells_give_one_by_one() {
        let mut lists = CellLists::default();
        for k in -40..40 {
            lists.add((k * k % 31 - 15, k % 3), (k + 40) as u32);
        }
        let mut reader = lists.reader();
        for (y, x0, x1) in [(0, -15, 15), (1, -3, -3), (-2, -8, 7), (2, 3, 12), (5, -20, 20)] {
            let mut in_row = Vec::new();
            reader.in_row(y, (x0, x1), |cell, held| in_row.push((cell, held)));
            let one_by_one: Vec<(Cell, &[u32])> = (x0..=x1)
                .map(|x| ((x, y), reader.get((x, y))))
                .filter(|(_, held)| !held.is_empty())
                .collect();
            assert_eq!(in_row, one_by_one, "row {y}, {x0} to {x1}");
        }
    }
}
