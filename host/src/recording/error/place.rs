//! Where in a file something is wrong.

/// A place in a recording's file.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Place {
    /// The file's name as it was given.
    pub file: String,
    /// Line, from 1, comments and header row counted.
    pub line: u64,
    /// Name of the column.
    pub column: String,
}

impl std::fmt::Display for Place {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}:{}: column `{}`", self.file, self.line, self.column)
    }
}
