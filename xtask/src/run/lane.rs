//! What goes on at the same time: beside the steps unseen, or behind a program with time-outs.

use std::cell::Cell;
use std::process::Command;

thread_local! {
    /// Whether the commands of this thread run beside those of the steps.
    static BESIDE: Cell<bool> = const { Cell::new(false) };
    /// Whether they take only what others leave of the processor.
    static YIELDING: Cell<bool> = const { Cell::new(false) };
}

/// Does `work` with its commands unseen, and with their processor time counted by itself.
pub fn beside<T>(work: impl FnOnce() -> T) -> T {
    BESIDE.set(true);
    let done = work();
    BESIDE.set(false);
    done
}

pub(super) fn is_beside() -> bool {
    BESIDE.get()
}

/// Does `work` with its commands at the lowest priority. Where there is no `nice`, there is no pseudo-terminal either, and
/// no virtual board to make way for.
pub fn yielding<T>(work: impl FnOnce() -> T) -> T {
    YIELDING.set(cfg!(unix));
    let done = work();
    YIELDING.set(false);
    done
}

/// The same command by `nice`, if it is to yield.
pub(super) fn niced(command: &Command) -> Option<Command> {
    if !YIELDING.get() {
        return None;
    }
    let mut niced = Command::new("nice");
    niced.args(["-n", "19"]).arg(command.get_program()).args(command.get_args());
    if let Some(folder) = command.get_current_dir() {
        niced.current_dir(folder);
    }
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => niced.env(name, value),
            None => niced.env_remove(name),
        };
    }
    Some(niced)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::run::run;

    /// As a test itself may have been started by `nice`, its own priority is not compared with.
    #[test]
    fn what_yields_has_the_lowest_priority_its_folder_and_its_variables() {
        let folder = std::env::temp_dir().canonicalize().unwrap();
        let looks = || {
            let mut command = Command::new("sh");
            command.args(["-c", "test $(nice) = 19 && test \"$(pwd -P)\" = \"$HERE\" && test -z \"$HOME\""]);
            command.current_dir(&folder).env("HERE", &folder).env_remove("HOME");
            run(&mut command)
        };
        yielding(looks).unwrap();
        assert!(niced(&Command::new("sh")).is_none());
    }
}
