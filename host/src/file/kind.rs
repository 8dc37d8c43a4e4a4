//! The kinds of files that are written, and the marks by which breakaway knows its own.

/// Bytes at the beginning of a file in which its mark stands.
pub(super) const HEAD_BYTES: usize = 8192;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FileKind {
    /// A recording: CSV, MCAP or Parquet.
    Recording,
    /// A model, TOML.
    Model,
    /// A controller, TOML.
    Controller,
    /// A report or another page, HTML.
    Page,
    /// A figure, SVG.
    Figure,
    /// A figure, PNG.
    Picture,
    /// The numbers of a figure, CSV.
    FigureTable,
    /// A manual page.
    Manual,
    /// The table over the machines of a fleet, CSV.
    FleetTable,
    /// The result of one machine of a fleet, JSON.
    FleetResult,
    /// A model for another program.
    Export,
    /// A card of the motor library, TOML.
    Card,
}

impl FileKind {
    /// In words, with an article.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Recording => "a recording",
            Self::Model => "a model",
            Self::Controller => "a controller",
            Self::Page => "a report",
            Self::Figure => "a figure",
            Self::Picture => "a picture of a figure",
            Self::FigureTable => "a figure's table",
            Self::Manual => "a manual page",
            Self::FleetTable => "a table over a fleet",
            Self::FleetResult => "a result of a fleet",
            Self::Export => "an export",
            Self::Card => "a motor card",
        }
    }

    /// Whether a file that begins with `head` is of this kind, and breakaway wrote it. What a person wrote, or another
    /// program, has no mark.
    pub fn is_of(self, head: &[u8]) -> bool {
        let text = String::from_utf8_lossy(head);
        // Comment lines at the top, and the first line below them.
        let comments = || text.lines().take_while(|line| line.starts_with('#'));
        let below = || text.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
        let starts = |mark: &str| text.starts_with(mark);
        match self {
            Self::Recording => {
                let of_words = || comments().any(|line| line.starts_with("# units: ")) && below().starts_with("t,u,x");
                LOG_MARKS.iter().any(|mark| head.starts_with(mark)) && text.contains("breakaway ") || of_words()
            }
            Self::Model => comments().any(|line| {
                let on_a_board = line.starts_with("# read from ") && line.contains(", firmware ");
                on_a_board || MODEL_MARKS.iter().any(|mark| line.starts_with(mark))
            }),
            Self::Controller => starts("# Tuned by breakaway "),
            Self::Page => starts("<!DOCTYPE html>") && text.contains(PAGE_MARK),
            Self::Figure => starts("<svg ") && text.contains(FIGURE_MARK),
            Self::Picture => {
                head.starts_with(PICTURE) && head.windows(PICTURE_MARK.len()).any(|part| part == PICTURE_MARK)
            }
            Self::FigureTable => starts(TABLE_MARK),
            Self::Manual => text.contains(".TH breakaway"),
            Self::FleetTable => starts("machine,verdict,effects,"),
            Self::FleetResult => starts("{") && text.contains("\"base\""),
            Self::Export => text.contains(EXPORT_MARK),
            Self::Card => starts(CARD_MARK),
        }
    }
}

/// How log files begin that hold a recording; the program that wrote them stands at their beginning or at their end.
pub(super) const LOG_MARKS: [&[u8]; 2] = [b"\x89MCAP", b"PAR1"];
/// How a comment of a model begins that was identified or discovered.
const MODEL_MARKS: [&str; 2] = ["# identified by breakaway ", "# discovered by breakaway "];
/// What stands at the top of a model for another program.
pub const EXPORT_MARK: &str = "exported by breakaway ";
/// How a motor card begins.
pub const CARD_MARK: &str = "# Made by `breakaway models add`";
/// What stands in the head of a page.
pub const PAGE_MARK: &str = "<meta name=\"generator\" content=\"breakaway\">";
/// What stands in the first tag of a figure that is a file of its own.
pub const FIGURE_MARK: &str = "data-by=\"breakaway\"";
/// How a PNG begins, and its text that says who made it.
const PICTURE: &[u8] = b"\x89PNG";
const PICTURE_MARK: &[u8] = b"Software\0breakaway";
/// How the table of a figure begins.
pub const TABLE_MARK: &str = "# figure by breakaway: ";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_knows_its_own_files_and_no_others() {
        let own = [
            (FileKind::Recording, "# tick: 0.001 s\n# units: t=s, u=V, x=rad\nt,u,x\n0.0,1.0,0.0\n"),
            (FileKind::Recording, "# units: u=V, x=rad, r=rad\nt,u,x,r,mode\n0,1,2,3,idle\n"),
            (FileKind::Model, "# identified by breakaway 0.1.0 (output_error)\n# from a.csv\n\n[base]\n"),
            (FileKind::Controller, "# Tuned by breakaway 0.1.0.\n\n[controller]\n"),
            (FileKind::Page, "<!DOCTYPE html>\n<head>\n<meta name=\"generator\" content=\"breakaway\">\n"),
            (FileKind::Figure, "<svg xmlns=\"\" data-by=\"breakaway\" width=\"1\">\n"),
            (FileKind::FigureTable, "# figure by breakaway: The ladder\neffects added,rms error (rad)\n"),
            (FileKind::Manual, ".ie \\n(.g .ds Aq \\(aq\n.TH breakaway-run 1\n"),
            (FileKind::FleetTable, "machine,verdict,effects,tied\n"),
            (FileKind::FleetResult, "{\n  \"base\": {}\n"),
            (FileKind::Export, "<mujoco model=\"axis\">\n  <!-- exported by breakaway 0.1.0, for MuJoCo 3.7 -->\n"),
            (FileKind::Card, "# Made by `breakaway models add`, breakaway 0.1.0.\n[card]\n"),
        ];
        let strange = [
            "t,u,x\n0,1,2\n",
            "# my log\nt,u,x\n0,1,2\n",
            "[base]\nb = 1\n",
            "# the axis in hall 3\n[base]\nb = 1\n",
            "<!DOCTYPE html>\n<p>no</p>\n",
            "<svg>\n",
            "{\"b\": 1}\n",
            "",
        ];
        for (k, (kind, text)) in own.iter().enumerate() {
            for (other, (_, text)) in own.iter().enumerate() {
                let same = own[k].0 == own[other].0;
                assert_eq!(kind.is_of(text.as_bytes()), same, "{kind:?}: {text}");
            }
            assert!(strange.iter().all(|text| !kind.is_of(text.as_bytes())), "{kind:?} {text}");
        }
    }
}
