//! Machines side by side, each on its share of the cores.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use anyhow::Context;
use serde_json::Value;

use super::machine::{Inputs, Machine};
use super::page;
use super::result::{Found, Place, made_of, write};
use super::row::Row;
use super::table::write_csv;
use crate::file::make_folder;

/// Reason of a machine whose turn has not come yet; it stands in the table of a run that was cut off.
pub const NOT_YET: &str = "not worked on yet: the run was cut off; run the same command again";

/// What to do.
#[derive(Debug)]
pub struct Job<'a> {
    /// The machines.
    pub machines: &'a [Machine],
    /// Folder for results and tables.
    pub output: &'a Path,
    /// Machines worked on at a time, ≥ 1.
    pub workers: usize,
    /// What beside the inputs decides a result.
    pub options: Value,
    /// Model of the machines that have none of their own.
    pub model: Option<&'a Path>,
    /// Whether to work on machines again whose result is there.
    pub again: bool,
}

impl Job<'_> {
    /// Works on all machines by `discover`; `done` is told after each one. The tables (`summary.csv`, `summary.html`) are
    /// written anew after each machine, so that a run that is cut off leaves them whole.
    ///
    /// # Errors
    /// A table that cannot be written. What is wrong with one machine is its row.
    pub fn run<D>(&self, discover: D, done: &(dyn Fn(&Row) + Sync)) -> anyhow::Result<Vec<Row>>
    where
        D: Fn(&Inputs) -> anyhow::Result<Found> + Sync,
    {
        make_folder(self.output)?;
        let waiting = self.machines.iter().map(|machine| Row::failed(&machine.name, NOT_YET)).collect();
        let rows: Mutex<Vec<Row>> = Mutex::new(waiting);
        // Before hours of work, not after them.
        self.write_tables(&rows.lock().unwrap_or_else(PoisonError::into_inner))?;
        let workers = self.workers.clamp(1, self.machines.len().max(1));
        let threads = (rayon::current_num_threads() / workers).max(1);
        let next = AtomicUsize::new(0);
        let work = || -> anyhow::Result<()> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads")?;
            while let Some((index, machine)) = {
                let index = next.fetch_add(1, Ordering::Relaxed);
                self.machines.get(index).map(|machine| (index, machine))
            } {
                let row = pool.install(|| self.one(machine, &discover));
                done(&row);
                let mut rows = rows.lock().unwrap_or_else(PoisonError::into_inner);
                rows[index] = row;
                self.write_tables(&rows)?;
            }
            Ok(())
        };
        thread::scope(|scope| {
            let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
            // A worker that failed has written why; the others have taken its machines over.
            let results: Vec<anyhow::Result<()>> = handles
                .into_iter()
                .map(|handle| {
                    handle.join().unwrap_or_else(|panic| Err(anyhow::anyhow!(said(panic.as_ref()).to_owned())))
                })
                .collect();
            results.into_iter().collect::<anyhow::Result<()>>()
        })?;
        Ok(rows.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// One machine, whatever happens.
    fn one<D>(&self, machine: &Machine, discover: &D) -> Row
    where
        D: Fn(&Inputs) -> anyhow::Result<Found>,
    {
        // Nothing of what a panic may leave half done is looked at again.
        let result = catch_unwind(AssertUnwindSafe(|| self.result(machine, discover)))
            .unwrap_or_else(|panic| Err(anyhow::anyhow!("the program itself failed: {}", said(panic.as_ref()))));
        result.unwrap_or_else(|error| {
            // Whatever is there is of other inputs. If it cannot be removed, the reason is still that of the failure.
            let _ = Place::new(self.output, &machine.name).clear();
            Row::failed(&machine.name, format!("{error:#}"))
        })
    }

    fn result<D>(&self, machine: &Machine, discover: &D) -> anyhow::Result<Row>
    where
        D: Fn(&Inputs) -> anyhow::Result<Found>,
    {
        let mut inputs = machine.inputs()?;
        inputs.model = inputs.model.or_else(|| self.model.map(Path::to_path_buf));
        let made_of = made_of(&inputs, &self.options)?;
        let place = Place::new(self.output, &machine.name);
        if let Some(document) = place.kept(&made_of).filter(|_| !self.again) {
            return Ok(Row::of(&machine.name, &document, true));
        }
        let document = place.keep(&discover(&inputs)?, &made_of)?;
        Ok(Row::of(&machine.name, &document, false))
    }

    fn write_tables(&self, rows: &[Row]) -> anyhow::Result<()> {
        write_csv(&self.output.join("summary.csv"), rows)?;
        write(&self.output.join("summary.html"), &page::html(rows))
    }
}

/// What a panic said.
fn said(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("it does not say why")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A defect that ends one machine's discovery ends neither the run nor the other machine's row.
    #[test]
    fn a_panic_is_a_row() {
        let folder = tempfile::tempdir().unwrap();
        let machines: Vec<Machine> = ["a", "b"]
            .map(|name| Machine { name: name.to_owned(), folder: folder.path().join(name) })
            .into_iter()
            .collect();
        std::fs::create_dir(folder.path().join("a")).unwrap();
        std::fs::write(folder.path().join("a/x.csv"), "t,u,x\n").unwrap();
        let output = folder.path().join("out");
        let job =
            Job { machines: &machines, output: &output, workers: 2, options: Value::Null, model: None, again: false };
        let rows = job.run(|_| panic!("a defect"), &|_| {}).unwrap();
        assert_eq!(rows[0].reason.as_deref(), Some("the program itself failed: a defect"));
        assert!(rows[1].reason.as_deref().unwrap().contains("cannot be read"), "{rows:?}");
    }
}
