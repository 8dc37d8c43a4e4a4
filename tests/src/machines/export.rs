//! The machines as plain tables, for the programs that discovery is compared with.

use std::path::Path;

use breakaway_core::plant::Kind;

use super::Machine;
use super::reading::Source;

/// Name of the list of machines in the folder.
pub const LIST: &str = "list.csv";

/// One machine of the list.
#[derive(Debug, serde::Serialize)]
struct Listed<'a> {
    machine: &'a str,
    /// Unit of the position.
    unit: &'a str,
    /// Wave numbers that one may know beforehand (poles, slots), joined by `;`.
    waves: String,
}

/// A sample.
#[derive(Debug, serde::Serialize)]
struct Sample {
    /// Recording, from 0.
    recording: usize,
    /// Piece of the recording between gaps, from 0.
    piece: usize,
    t: f64,
    u: f64,
    x: f64,
}

/// Writes `folder/list.csv`, and `folder/MACHINE.csv` with every sample of each machine.
///
/// # Errors
/// A file cannot be written.
pub fn write(folder: &Path, machines: &[(&Machine, Vec<Source>)]) -> Result<(), csv::Error> {
    std::fs::create_dir_all(folder)?;
    let mut list = csv::Writer::from_path(folder.join(LIST))?;
    for (machine, sources) in machines {
        let recordings = || sources.iter().flat_map(|source| &source.recording);
        let unit = recordings().next().map_or("", |recording| recording.units.x.as_str());
        let waves = machine.known.iter().filter(|known| known.of == Some(Kind::Cogging) && known.symbol == "n");
        let waves: Vec<String> = waves.map(|known| known.from.to_string()).collect();
        list.serialize(Listed { machine: machine.name, unit, waves: waves.join(";") })?;
        let mut samples = csv::Writer::from_path(folder.join(machine.name).with_extension("csv"))?;
        for (recording, of) in recordings().enumerate() {
            for (piece, range) in of.pieces().into_iter().enumerate() {
                for k in range {
                    samples.serialize(Sample { recording, piece, t: of.t[k], u: of.u[k], x: of.x[k] })?;
                }
            }
        }
        samples.flush()?;
    }
    Ok(list.flush()?)
}

#[cfg(test)]
mod tests {
    use breakaway::recording::Recording;

    use super::super::catalogue::LAAS_SINE;
    use super::*;

    /// The samples on both sides of a gap are of different pieces; the list knows the slots.
    #[test]
    fn a_machine_is_a_table_of_samples() {
        let recording = Recording {
            t: vec![0.0, 0.5, 3.0, 3.5],
            u: vec![1.0; 4],
            x: vec![0.0, 0.25, 0.5, 1.0],
            gaps: vec![2],
            ..Recording::default()
        };
        let source = Source { file: "a.csv".into(), recording: Some(recording), remark: None };
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &[(&LAAS_SINE, vec![source])]).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(read(LIST), "machine,unit,waves\nlaas-sine,x,72\n");
        assert_eq!(
            read("laas-sine.csv"),
            "recording,piece,t,u,x\n0,0,0.0,1.0,0.0\n0,0,0.5,1.0,0.25\n0,1,3.0,1.0,0.5\n0,1,3.5,1.0,1.0\n"
        );
    }
}
