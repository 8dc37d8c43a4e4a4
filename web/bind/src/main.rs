//! `breakaway-web-bind WASM FOLDER`: writes the WebAssembly and the JavaScript module that calls it into a folder.
#![forbid(unsafe_code)]

use std::env::args_os;
use std::path::PathBuf;

use anyhow::Context;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> anyhow::Result<()> {
    let mut arguments = args_os().skip(1).map(PathBuf::from);
    let wasm = arguments.next().context("give the WebAssembly")?;
    let folder = arguments.next().context("give the folder to write to")?;
    let mut bindgen = Bindgen::new();
    bindgen.web(true)?.typescript(false).omit_default_module_path(false).remove_name_section(true);
    bindgen.remove_producers_section(true).input_path(wasm).out_name("breakaway").generate(folder)
}
