//! A vector in pages that its clones share until one of them writes: publishing a version costs the pages touched.

use std::{
    ops::{Index, IndexMut},
    sync::Arc,
};

/// A vector whose clones share pages of `PAGE` items until one of them writes. An item costs one more load than in a `Vec`.
/// Larger pages copy more for one write; smaller ones are more to share at each clone.
#[derive(Clone, Debug)]
pub(crate) struct Pages<T, const PAGE: usize = 64> {
    pages: Vec<Arc<[T; PAGE]>>,
    len: usize,
}

impl<T, const PAGE: usize> Default for Pages<T, PAGE> {
    fn default() -> Self {
        Self { pages: Vec::new(), len: 0 }
    }
}

impl<T: Clone + Default, const PAGE: usize> Pages<T, PAGE> {
    const PAGE_BYTES: usize = PAGE * size_of::<T>() + 2 * size_of::<usize>();

    /// How many items there are.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Appends an item; its index is the length before.
    pub(crate) fn push(&mut self, item: T) {
        if self.len == self.pages.len() * PAGE {
            self.pages.push(Arc::new(std::array::from_fn(|_| T::default())));
        }
        self.len += 1;
        let last = self.len - 1;
        self[last] = item;
    }

    /// All items in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        self.pages.iter().flat_map(|page| page.iter()).take(self.len)
    }

    /// An item; `None` beyond the last.
    pub(crate) fn get(&self, index: usize) -> Option<&T> {
        (index < self.len).then(|| &self[index])
    }

    /// The indices, up to the longer's length, whose pages the two do not share.
    pub(crate) fn unshared(&self, other: &Self) -> impl Iterator<Item = usize> {
        let page_count = self.pages.len().max(other.pages.len());
        let is_shared = |page: usize| match (self.pages.get(page), other.pages.get(page)) {
            (Some(own), Some(others)) => Arc::ptr_eq(own, others),
            _ => false,
        };
        let len = self.len.max(other.len);
        let unshared = (0..page_count).filter(move |&page| !is_shared(page));
        unshared.flat_map(move |page| page * PAGE..(page * PAGE + PAGE).min(len))
    }

    /// Bytes of the pages that `other` does not share, what items own elsewhere not.
    pub(crate) fn bytes_beside(&self, other: &Self) -> u64 {
        let shared = self.pages.iter().zip(&other.pages).filter(|(own, other)| Arc::ptr_eq(own, other)).count();
        ((self.pages.len() - shared) * Self::PAGE_BYTES) as u64
    }

    /// Bytes it holds in memory, what it shares included, what items own elsewhere not.
    pub(crate) fn memory_bytes(&self) -> u64 {
        (self.pages.len() * Self::PAGE_BYTES + self.pages.capacity() * size_of::<Arc<[T; PAGE]>>()) as u64
    }
}

impl<T, const PAGE: usize> Index<usize> for Pages<T, PAGE> {
    type Output = T;

    fn index(&self, index: usize) -> &T {
        &self.pages[index / PAGE][index % PAGE]
    }
}

impl<T: Clone, const PAGE: usize> IndexMut<usize> for Pages<T, PAGE> {
    /// Copies the page first if a clone shares it.
    #[inline]
    fn index_mut(&mut self, index: usize) -> &mut T {
        &mut Arc::make_mut(&mut self.pages[index / PAGE])[index % PAGE]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clone_keeps_what_it_saw_and_shares_what_was_not_written() {
        let mut pages: Pages<u32> = Pages::default();
        for item in 0..1000_u32 {
            pages.push(item);
        }
        let before = pages.clone();
        pages[70] = 7;
        pages.push(1000);
        assert_eq!((pages[70], pages[1000], pages.len()), (7, 1000, 1001));
        assert!(before.iter().copied().eq(0..1000));
        let shared = before.pages.iter().zip(&pages.pages).filter(|(a, b)| Arc::ptr_eq(a, b)).count();
        assert_eq!(shared, before.pages.len() - 2, "the pages of items 70 and 1000 were copied, no other");
        let unshared = (64..128).chain(960..1001);
        assert!(pages.unshared(&before).eq(unshared.clone()) && before.unshared(&pages).eq(unshared));
        assert_eq!((before.get(999), before.get(1000), pages.get(1000)), (Some(&999), None, Some(&1000)));
    }
}
