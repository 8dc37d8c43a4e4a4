//! `breakaway man`.

use std::path::PathBuf;

use anyhow::Context;
use clap::CommandFactory;
use clap_mangen::Man;
use schemars::JsonSchema;
use serde::Serialize;

use super::Cli;
use super::output::Output;
use crate::file::{FileKind, make_folder, write_whole};

/// Write the manual page to standard output, or all of them to a folder
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway man | man -l -
  breakaway man -o ~/.local/share/man/man1

With -o there is one page per command: breakaway.1, breakaway-run.1, …

JSON: page (without -o), files (with it).")]
pub struct Args {
    /// Write all pages to this folder
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    #[serde(skip_serializing_if = "Option::is_none")]
    page: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    files: Option<Vec<String>>,
}

impl Args {
    /// Prints one page or writes all.
    ///
    /// # Errors
    /// A folder or file that cannot be written.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let mut command = Cli::command();
        // Gives the subcommands their full names (`breakaway-run`) and the global options.
        command.build();
        let Some(folder) = self.output else {
            let mut page = Vec::new();
            Man::new(command).render(&mut page)?;
            let document = Document { page: Some(String::from_utf8_lossy(&page).into_owned()), files: None };
            return output.print(&document, |document| document.page.clone().unwrap_or_default());
        };
        make_folder(output.folder(&folder, "a folder")?)?;
        let mut pages = Vec::new();
        collect(&command, &mut pages);
        let mut files = Vec::new();
        for man in pages {
            let file = folder.join(man.get_filename());
            output.may_write(&file, FileKind::Manual, &[])?;
            write_whole(&file, |out| man.render(out)).with_context(|| format!("cannot write {}", file.display()))?;
            files.push(file.display().to_string());
        }
        let document = Document { page: None, files: Some(files) };
        output.print(&document, |document| {
            document.files.iter().flatten().map(String::as_str).collect::<Vec<_>>().join("\n")
        })
    }
}

/// A command's page and those of its subcommands, but for clap's own `help`.
fn collect(command: &clap::Command, pages: &mut Vec<Man>) {
    pages.push(Man::new(command.clone()));
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help" && !sub.is_hide_set()) {
        collect(sub, pages);
    }
}
