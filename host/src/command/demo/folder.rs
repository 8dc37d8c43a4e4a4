//! The folder of a demo: what may be replaced in it.

use std::path::Path;

use crate::command::output::Output;
use crate::file::FileKind;

/// Files that a demo writes beside its recordings.
const FILES: [(&str, FileKind); 8] = [
    ("model.toml", FileKind::Model),
    ("improved.toml", FileKind::Model),
    ("controller.toml", FileKind::Controller),
    ("demo.html", FileKind::Page),
    ("discovery.html", FileKind::Page),
    ("track.html", FileKind::Page),
    ("limit_cycles.svg", FileKind::Figure),
    ("ladder.svg", FileKind::Figure),
];

/// Checks before the story begins that it writes over nothing but what an earlier demo wrote.
pub(super) fn claim(folder: &Path, output: Output) -> anyhow::Result<()> {
    let files = FILES.map(|(name, kind)| (folder.join(name), kind)).into_iter();
    let parts = ["", "fit", "score"].into_iter().filter_map(|part| std::fs::read_dir(folder.join(part)).ok());
    let paths = parts.flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let recordings = paths.filter(|path| path.extension().is_some_and(|e| e == "csv"));
    let files = files.chain(recordings.map(|path| (path, FileKind::Recording)));
    for (path, kind) in files.filter(|(path, _)| path.exists()) {
        output.may_write(&path, kind, &[])?;
    }
    Ok(())
}
