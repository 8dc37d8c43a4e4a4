//! MATLAB's files of version 7.3, which are HDF5, and plain HDF5: numeric arrays, at the top and in groups.

use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use super::array::Array;
use super::fault::Fault;
use super::guard::guarded;
use super::log::{Channel, Log, MAX_VALUES};
use super::{Format, MAX_BYTES};

/// Deepest group within a group.
const MAX_DEPTH: usize = 16;
/// MATLAB's own group: the cells, which other arrays point to.
const REFERENCES: &str = "#refs#";

/// What is read.
#[derive(Default)]
struct Reader {
    channels: Vec<Channel>,
    passed_over: Vec<String>,
    values: usize,
}

/// Reads the file's arrays.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let damaged = Fault::Damaged { at: 0, what: "the file's groups and arrays are not whole" };
    let reader = guarded(|| arrays(bytes)).unwrap_or(Err(damaged))?;
    let mut log = Log::of_arrays(Format::Hdf5, reader.channels)?;
    log.passed_over = reader.passed_over;
    Ok(log)
}

fn arrays(bytes: &[u8]) -> Result<Reader, Fault> {
    let options = OpenOptions::default().with_max_chunk_bytes(MAX_BYTES).with_max_read_bytes(MAX_BYTES);
    let file = Hdf5File::from_bytes_with_options(bytes, options).map_err(|error| refused(&error))?;
    let mut reader = Reader::default();
    reader.group(&file.root_group().map_err(|error| refused(&error))?, "", 0)?;
    Ok(reader)
}

fn refused(error: &hdf5_reader::error::Error) -> Fault {
    match error {
        hdf5_reader::error::Error::ResourceLimit(_) => Fault::TooLarge { what: "bytes in an array", most: MAX_BYTES },
        _ => Fault::Damaged { at: 0, what: "the file's groups and arrays are not whole" },
    }
}

impl Reader {
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Fault> {
        if depth > MAX_DEPTH {
            self.passed_over.push(format!("`{path}`: groups within groups"));
            return Ok(());
        }
        let (groups, arrays) = group.members().map_err(|error| refused(&error))?;
        let named = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        for array in arrays {
            self.array(&array, &named(array.name()))?;
        }
        for inner in groups.iter().filter(|inner| inner.name() != REFERENCES) {
            self.group(inner, &named(inner.name()), depth + 1)?;
        }
        Ok(())
    }

    fn array(&mut self, array: &Dataset, name: &str) -> Result<(), Fault> {
        let text = |kind: &str| kind == "char" || kind == "cell";
        let class = array.attribute("MATLAB_class").ok().and_then(|class| class.read_string().ok());
        if class.as_deref().is_some_and(text) || array.attribute("MATLAB_empty").is_ok() {
            self.passed_over.push(format!("`{name}`: {}", class.as_deref().unwrap_or("empty")));
            return Ok(());
        }
        let count = array.num_elements().map_err(|error| refused(&error))?;
        if count > (MAX_VALUES - self.values) as u64 {
            return Err(Fault::TooLarge { what: "values", most: MAX_VALUES });
        }
        let Some(numbers) = numbers(array).map_err(|error| refused(&error))? else {
            self.passed_over.push(format!("`{name}`: not numbers"));
            return Ok(());
        };
        self.values += numbers.len();
        // MATLAB's first side is the last one here, so that rows are the order of the file.
        let shape: Vec<usize> = array.shape().iter().map(|side| *side as usize).collect();
        let array = Array { name, unit: None, shape: &shape, columns_first: false, numbers };
        array.push(&mut self.channels, &mut self.passed_over)
    }
}

/// The numbers of an array in the order of the file; `None` where it holds none.
fn numbers(array: &Dataset) -> Result<Option<Vec<f64>>, hdf5_reader::error::Error> {
    macro_rules! read {
        ($kind:ty) => {
            array.read_array::<$kind>()?.into_iter().map(|value| value as f64).collect()
        };
    }
    Ok(Some(match array.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => read!(f32),
        Datatype::FloatingPoint { size: 8, .. } => read!(f64),
        Datatype::FixedPoint { size: 1, signed: true, .. } => read!(i8),
        Datatype::FixedPoint { size: 1, .. } => read!(u8),
        Datatype::FixedPoint { size: 2, signed: true, .. } => read!(i16),
        Datatype::FixedPoint { size: 2, .. } => read!(u16),
        Datatype::FixedPoint { size: 4, signed: true, .. } => read!(i32),
        Datatype::FixedPoint { size: 4, .. } => read!(u32),
        Datatype::FixedPoint { size: 8, signed: true, .. } => read!(i64),
        Datatype::FixedPoint { size: 8, .. } => read!(u64),
        _ => return Ok(None),
    }))
}
