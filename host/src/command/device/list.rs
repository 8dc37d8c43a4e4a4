//! `breakaway device list`.

use std::fmt::Write as _;

use super::documents::Entry;
use crate::command::output::Output;
use crate::device::list::{Listed, list};

/// Lists the ports, and which of them answer.
///
/// # Errors
/// What standard output reports.
pub fn run(baud: u32, output: Output) -> anyhow::Result<()> {
    let ports = list(baud);
    let document: Vec<Entry<'_>> = ports.iter().map(Entry::from).collect();
    output.print(&document, |_| text(&ports))
}

fn text(ports: &[Listed]) -> String {
    if ports.is_empty() {
        return "no serial ports".to_owned();
    }
    let mut text = String::new();
    for Listed { port, device, answer } in ports {
        let said = match answer {
            Ok(answer) => {
                let held = if answer.held { ", held by another breakaway process" } else { "" };
                format!("{}, firmware {} ({}){held}", answer.board, answer.firmware, answer.build)
            }
            Err(reason) => format!("no board: {reason}"),
        };
        let device = device.as_ref().map_or(String::new(), |device| format!("  [{device}]"));
        let _ = writeln!(text, "{port}{device}\n  {said}");
    }
    text
}
