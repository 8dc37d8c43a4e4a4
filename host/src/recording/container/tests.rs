use super::columns::Columns;
use super::*;
use crate::recording::{Format, ReadOptions, Recording, Units};

/// A recording of a capture, with a gap in the current and the board's mode.
const CAPTURE: &str = "# tick: 0.001 s\n# units: u=V, x=rad, r=rad, i_A=A\n# board: virtual\nt,u,x,r,mode,i_A\n\
                       -0.001,1.5,0.25,0.5,idle,0.1\n0.0,-2.5,0.75,0.5,relay,\n";

#[test]
fn the_ending_tells_the_form() {
    let of = |name: &str| Container::of(Path::new(name));
    assert_eq!([of("a.csv"), of("a"), of("-")], [Container::Csv; 3]);
    assert_eq!([of("a.MCAP"), of("b.parquet")], [Container::Mcap, Container::Parquet]);
}

#[test]
fn columns_have_their_units_and_no_words() {
    let columns = Columns::read(CAPTURE.as_bytes()).unwrap();
    assert_eq!(columns.names, ["t_s", "u_V", "x_rad", "r_rad", "i_A"]);
    assert_eq!(columns.header[2], ("board".to_owned(), "virtual".to_owned()));
    assert!(columns.rows() == 2 && columns.values[4][1].is_nan());
    let torn = CAPTURE.replace("-2.5", "-2.5.");
    assert_eq!(Columns::read(torn.as_bytes()).unwrap_err().kind(), io::ErrorKind::InvalidData);
}

/// What is written in each form is read back bit for bit, by the columns that carry their units.
#[test]
fn every_form_holds_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let t: Vec<f64> = (0..50).map(|k| 0.1 + 1e-3 * f64::from(k)).collect();
    let recording = Recording {
        u: t.iter().map(|t| (40.0 * t).sin()).collect(),
        x: t.iter().map(|t| t.powi(3) / 3.0).collect(),
        t,
        units: Units { u: "V".into(), x: "rad".into() },
        ..Recording::default()
    };
    for (name, format) in [("a.mcap", Format::Mcap), ("a.parquet", Format::Parquet)] {
        let path = folder.path().join(name);
        recording.write(&path).unwrap();
        let named = |name: &str| Some(name.to_owned());
        let options =
            ReadOptions { time: named("t_s"), input: named("u_V"), position: named("x_rad"), ..ReadOptions::default() };
        let read = Recording::read(&path, &options).unwrap();
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same(&read.t, &recording.t) && same(&read.u, &recording.u) && same(&read.x, &recording.x), "{name}");
        assert_eq!((read.t.len(), &read.units), (recording.t.len(), &recording.units), "{name}");
        let head = std::fs::read(&path).unwrap();
        assert_eq!(Format::of(&head), Some(format));
    }
}
