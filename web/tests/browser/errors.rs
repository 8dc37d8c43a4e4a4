//! What is wrong with a file is said in the command's words, and a run can be ended.

use std::path::Path;

use breakaway::command::recording_args::RecordingArgs;

use super::data::measured_data;
use super::page::Page;

/// What the command says of a file, without its folder, which a browser does not tell.
fn words_of_the_command(file: &Path, columns: &RecordingArgs) -> String {
    let error = columns.read_session(&[file]).unwrap_err();
    error.to_string().replace(&file.display().to_string(), &file.file_name().unwrap().to_string_lossy())
}

/// A file that has gone, or changed, since it was chosen cannot be read by a browser.
#[test]
fn a_file_that_cannot_be_read_is_named() {
    let mut page = needs!(Page::open());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gone.csv");
    std::fs::write(&file, with_a_word()).unwrap();
    page.choose("#fit-files", &[&file]);
    std::fs::remove_file(&file).unwrap();
    let said = page.discover().unwrap_err();
    assert!(said.starts_with("gone.csv: the browser cannot read the file"), "{said}");
}

/// A recording of 200 rows that moves, with a word where row 100 has its drive.
fn with_a_word() -> String {
    let row = |k: u32| {
        let t = f64::from(k) * 0.01;
        let drive = if k == 100 { "broken".to_owned() } else { (3.0 * t).sin().to_string() };
        format!("{t},{drive},{}\n", (2.0 * t).cos())
    };
    std::iter::once("t,u,x\n".to_owned()).chain((0..200).map(row)).collect()
}

#[test]
fn a_broken_file_is_refused_in_the_commands_words() {
    let mut page = needs!(Page::open());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("broken.csv");
    std::fs::write(&file, with_a_word()).unwrap();
    page.choose("#fit-files", &[&file]);
    for (role, name) in [("time", "t"), ("input", "u"), ("position", "x")] {
        page.column(role, name);
    }
    let said = page.discover().unwrap_err();
    let expected = words_of_the_command(&file, &RecordingArgs::default());
    assert!(expected.contains("broken"), "{expected}");
    assert_eq!(said, expected);
}

#[test]
fn what_is_no_recording_is_refused_in_the_commands_words() {
    let mut page = needs!(Page::open());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("empty.csv");
    std::fs::write(&file, "").unwrap();
    page.offer("#fit-files", &[&file]);
    let looked = breakaway::recording::formats::Log::read(&file).unwrap_err().to_string();
    assert_eq!(page.message(), looked.replace(&file.display().to_string(), "empty.csv"));
}

#[test]
fn a_run_can_be_cancelled_and_begun_again() {
    let mut page = needs!(Page::open());
    let data = needs!(measured_data());
    page.choose("#fit-files", &[&data.join("emps/emps_train.csv")]);
    page.press("#run");
    page.until_working();
    page.press("#cancel");
    assert_eq!(page.message(), "Cancelled. Nothing was kept.");
    assert_eq!(
        page.browser.value("document.querySelector('#work').hidden && document.querySelector('#result').hidden"),
        true
    );
    // The worker is gone: nothing reports a step any more.
    let step = "document.querySelector('#step').textContent";
    let before = page.browser.value(step);
    page.browser.value("new Promise((resolve) => setTimeout(resolve, 500))");
    assert_eq!(page.browser.value(step), before);
    page.press("#run");
    page.until_working();
}
