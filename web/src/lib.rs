//! Identify and discover in a browser: what a page's worker calls.
//!
//! Files come in as bytes and results go out as JSON. Nothing here reads a file or a network. Numbers, words and documents
//! are those of the command, because the same functions make them.
#![forbid(unsafe_code)]

pub mod columns;
pub mod work;

use breakaway::discover::progress::Progress;
use wasm_bindgen::prelude::wasm_bindgen;

use columns::Columns;
use work::File;

#[wasm_bindgen]
extern "C" {
    /// Is told of each step, as JSON; the worker has a function of this name.
    #[wasm_bindgen(js_name = onStep)]
    fn on_step(json: &str);
    /// Is told what a panic says, before the WebAssembly stops.
    #[wasm_bindgen(js_name = onPanic)]
    fn on_panic(text: &str);
}

/// Sees to it that a panic's words reach the page.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| on_panic(&panic.to_string())));
}

/// What is in a file: the document of `breakaway look`, with its guesses of time, drive and position.
///
/// # Errors
/// The words of the command for a file that cannot be read as a log at all.
#[wasm_bindgen]
pub fn look(name: &str, bytes: &[u8]) -> Result<String, String> {
    work::look(name, bytes).map_err(|error| format!("{error:#}"))
}

/// Files and columns of one run.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Job(work::Work);

#[wasm_bindgen]
impl Job {
    /// Of columns, as JSON: `time`, `time_unit`, `input`, `position`, `wrap`, each a text or null.
    ///
    /// # Errors
    /// A unit or a wrap that the command would not take either.
    #[wasm_bindgen(constructor)]
    pub fn new(columns: &str) -> Result<Self, String> {
        let columns: Columns = serde_json::from_str(columns).map_err(|error| error.to_string())?;
        Ok(Self(work::Work { columns: columns.arguments()?, ..work::Work::default() }))
    }

    /// Adds a recording to fit, or one to judge by.
    pub fn add(&mut self, name: String, bytes: Vec<u8>, holdout: bool) {
        let list = if holdout { &mut self.0.holdout } else { &mut self.0.fit };
        list.push(File { name, bytes });
    }

    /// Identifies and discovers; the result as JSON ([`work::Outcome`]).
    ///
    /// # Errors
    /// The words of the command.
    pub fn run(&self) -> Result<String, String> {
        let outcome = self.0.run(&|progress| on_step(&step(progress))).map_err(|error| format!("{error:#}"))?;
        serde_json::to_string(&outcome).map_err(|error| error.to_string())
    }
}

/// A step as JSON.
fn step(progress: Progress<'_>) -> String {
    match progress {
        Progress::Step(what) => serde_json::json!({ "step": what }),
        Progress::Round { effect, candidates } => serde_json::json!({ "round": effect, "candidates": candidates }),
        Progress::Compared => serde_json::json!({ "compared": 1 }),
    }
    .to_string()
}
