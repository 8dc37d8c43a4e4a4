//! Parsers of other crates that panic on damaged files: the panic becomes a refusal, and nothing is printed.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread is in such a parser.
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}
static HOOK: Once = Once::new();

/// What a parser gives, or `None` where it panics. It must leave nothing behind that is used afterwards.
pub(super) fn guarded<T>(parse: impl FnOnce() -> T) -> Option<T> {
    // The hook of before stays for every other panic, of this thread and of others.
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !GUARDED.get() {
                before(panic);
            }
        }));
    });
    let outer = GUARDED.replace(true);
    let result = catch_unwind(AssertUnwindSafe(parse));
    GUARDED.set(outer);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_refusal() {
        assert_eq!(guarded(|| [1, 2].iter().sum::<i32>()), Some(3));
        assert_eq!(guarded(|| Vec::<i32>::new()[std::hint::black_box(0)]), None);
    }
}
