//! What `device` prints with `--json`, against host/schema.

use std::sync::Mutex;

use breakaway_core::link::*;

use super::peer::{Peer, Then, breakaway, frame, reply};
use crate::json_schema::valid;

/// A board that has everything to tell: a fault, the model it was given, an identification with load and sine.
fn talkative() -> Peer {
    let loaded = Mutex::new(None);
    let estimate = |value: f32| Estimate { value, se: 0.01 * value };
    let sine = Sine { amplitude: estimate(1.0), omega: estimate(8.0), cycles: 5.5, ..Sine::default() };
    let identified = Identified {
        verdict: IdentificationVerdict::Determined,
        b: estimate(0.027),
        c: estimate(0.11),
        f1: estimate(0.5),
        load: Some(estimate(0.02)),
        residual: 0.01,
        condition: 30.0,
        windows: 80,
        sine: Some(sine),
    };
    let fault = FaultRecord {
        cause: FaultCause::EncoderJump,
        mode: Mode::Relay,
        tick: 90,
        count: 12,
        drive_code: -5,
        value: 70,
        limit: 50,
    };
    Peer::new(Vec::new(), move |Request { id, command }| {
        let answer = match &command {
            Command::GetFault => Reply::Fault(Some(fault)),
            Command::Identify => Reply::Identified(identified),
            Command::GetModel => Reply::Model(loaded.lock().unwrap().clone()),
            other => reply(other),
        };
        let mut bytes = frame(&Message::Reply { id, reply: answer });
        match command {
            Command::LoadModel(model) => *loaded.lock().unwrap() = Some(model),
            Command::Jog(_) => {
                let ended = Ended { mode: Mode::Drive, ending: Ending::TimeUp, tick: 9, ticks: 5, saturated: 0 };
                bytes.extend(frame(&Message::Event(Event::ExperimentEnded(ended))));
            }
            _ => {}
        }
        (bytes, Then::Stay)
    })
}

/// Every answer is valid by its schema, and has the numbers of the board.
#[test]
fn answers_are_documents() {
    let peer = talkative();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.toml");
    let model = "base = { b = 0.027, c = 0.11, f1 = 0.5 }\nunits = { u = \"V\", x = \"rad\" }\n[[effect]]\n\
                 name = \"constant_load\"\nf0 = 0.25\n";
    std::fs::write(&file, model).unwrap();
    let file = file.to_str().unwrap();
    // The schema, the words of the line, and a number or word of the document.
    for (schema, line, at, expected) in [
        ("device-info", "info", "/tick_hz", serde_json::json!(1000)),
        ("device-status", "status", "/mode", "idle".into()),
        ("device-settings", "settings get", "/position_unit", "rad".into()),
        ("device-settings", "settings get jump_counts", "/schema_version", 1.into()),
        ("device-done", "settings set jump_counts=50", "/done", "set; `save` keeps it across resets".into()),
        ("device-fault", "fault", "/fault/limit", 50.into()),
        ("device-done", "model load FILE", "/done", "loaded; `save` keeps it across resets".into()),
        ("device-model", "model get", "/effects/0/parameters/f0", 0.25.into()),
        ("device-identify", "identify", "/load/value", 0.02.into()),
        ("device-identify", "identify", "/sine/cycles", 5.5.into()),
        ("device-zero", "zero --at 0.5", "/position", 0.5.into()),
        ("device-moved", "jog --drive 1", "/done", "jogged".into()),
        ("device-stop", "stop", "/way", "port".into()),
    ] {
        let line = line.replace("FILE", file);
        let words: Vec<&str> = ["device", "--port", &peer.port, "--json"].into_iter().chain(line.split(' ')).collect();
        let run = breakaway(&words);
        assert!(run.status.success(), "{line}: {}", String::from_utf8_lossy(&run.stderr));
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        valid(schema, &document);
        assert_eq!(document.pointer(at), Some(&expected), "{line}: {document}");
    }
}
