use super::super::catalogue::{CICESE, EMPS, ODRIVE, XL330};
use super::*;

fn source(file: &str, rows: usize, gaps: Vec<usize>) -> Source {
    let t: Vec<f64> = (0..rows).map(|k| k as f64).collect();
    let recording = Recording { name: file.to_owned(), u: t.clone(), x: t.clone(), t, gaps, ..Recording::default() };
    Source { file: file.to_owned(), recording: Some(recording), remark: None }
}

fn names(recordings: &[Recording]) -> Vec<&str> {
    recordings.iter().map(|recording| recording.name.as_str()).collect()
}

/// One file: no hold-out of files, parts of time. Eight files: each left out. Sixteen and more: five groups of files.
#[test]
fn the_number_of_files_decides_the_splits() {
    let words = |machine| splits(machine).iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(words(&EMPS), ["all", "half 1", "half 2", "third 1", "third 2", "third 3"]);
    let xl330 = words(&XL330);
    assert_eq!(xl330[..3], ["all", "group kp100+200", "without 1 of 8"]);
    assert_eq!(xl330.len(), 2 + 8 + 5);
    assert_eq!(words(&CICESE).len(), 4 + 5 + 5);
    assert_eq!(words(&ODRIVE).len(), 1 + 5 + 5);
}

/// Parts of time are disjoint and complete, a gap on the edge of a part is none; groups and folds take whole files.
#[test]
fn a_split_takes_the_rows_and_files_it_names() {
    let one = [source("a.csv", 10, vec![2, 5, 7])];
    let half = |part| taken(&EMPS, Split::Part { part, of: 2 }, &one).fit.remove(0);
    assert_eq!((half(0).t, half(0).gaps), (vec![0.0, 1.0, 2.0, 3.0, 4.0], vec![2]));
    assert_eq!((half(1).t, half(1).gaps), (vec![5.0, 6.0, 7.0, 8.0, 9.0], vec![2]));

    let files = ["a_kp100", "a_kp400", "b_kp200", "b_kp800"].map(|file| source(file, 3, Vec::new()));
    let thirds = |part| taken(&XL330, Split::Part { part, of: 3 }, &files).fit;
    assert_eq!(names(&thirds(0)), ["a_kp100"]);
    assert_eq!(names(&thirds(2)), ["b_kp200", "b_kp800"]);
    let group = taken(&XL330, Split::Group("kp100+200"), &files);
    assert_eq!(names(&group.fit), ["a_kp100", "b_kp200"]);
    assert!(group.concerns(&files[0]) && !group.concerns(&files[1]));
    assert!(group.concerns(&Source { recording: None, ..files[1].clone() }), "refused");
    let fold = taken(&XL330, Split::Without { fold: 1, of: 2 }, &files);
    assert_eq!((names(&fold.fit), names(&fold.holdout)), (vec!["a_kp100", "b_kp200"], vec!["a_kp400", "b_kp800"]));
}
