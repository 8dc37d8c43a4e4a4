//! `breakaway device list`.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::command::output::Output;
use crate::device::list::{Listed, list};

/// Lists the ports, and which of them answer.
///
/// # Errors
/// What standard output reports.
pub fn run(baud: u32, output: Output) -> anyhow::Result<()> {
    let ports = list(baud);
    let document: Vec<Value> = ports.iter().map(as_json).collect();
    output.print(&document, |_| text(&ports))
}

fn as_json(listed: &Listed) -> Value {
    let Listed { port, device, answer } = listed;
    match answer {
        Ok(answer) => json!({
            "port": port, "device": device, "answers": true, "board": answer.board, "firmware": answer.firmware,
            "build": answer.build, "held": answer.held,
        }),
        Err(reason) => json!({ "port": port, "device": device, "answers": false, "reason": reason }),
    }
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
