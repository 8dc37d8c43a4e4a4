//! `breakaway completions`.

use clap::CommandFactory;
use clap_complete::Shell;
use schemars::JsonSchema;
use serde::Serialize;

use super::Cli;
use super::output::Output;

/// Write the completions of a shell to standard output
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:
  breakaway completions bash > ~/.local/share/bash-completion/completions/breakaway
  breakaway completions zsh > \"${fpath[1]}/_breakaway\"
  breakaway completions fish > ~/.config/fish/completions/breakaway.fish

JSON: shell, script.")]
pub struct Args {
    /// The shell
    pub shell: Shell,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    shell: String,
    script: String,
}

impl Args {
    /// Prints the script.
    ///
    /// # Errors
    /// What standard output reports.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "breakaway", &mut script);
        let document =
            Document { shell: self.shell.to_string(), script: String::from_utf8_lossy(&script).into_owned() };
        output.print(&document, |document| document.script.clone())
    }
}
