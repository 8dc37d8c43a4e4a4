//! Programming of a flash that takes whole pages, by pieces that are smaller.

use super::constants::PAGE_BYTES;

/// A page to be programmed: where it starts, and its bytes. Those that are not to be changed are ones, which a NOR flash
/// leaves as they are.
pub type Page = (u32, [u8; PAGE_BYTES]);

/// The pages that `bytes` at `at` fall into, in order.
pub fn pages(at: u32, bytes: &[u8]) -> impl Iterator<Item = Page> {
    let (mut at, mut rest) = (at, bytes);
    core::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let inside = at as usize % PAGE_BYTES;
        let (now, later) = rest.split_at(rest.len().min(PAGE_BYTES - inside));
        let mut page = [0xff; PAGE_BYTES];
        page.iter_mut().skip(inside).zip(now).for_each(|(cell, byte)| *cell = *byte);
        let start = at - inside as u32;
        (at, rest) = (at + now.len() as u32, later);
        Some((start, page))
    })
}

#[cfg(test)]
mod tests;
