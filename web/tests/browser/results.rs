//! A real recording gives the command's numbers, and nothing is asked of another machine.

use std::path::Path;

use breakaway::command::output::versioned;
use breakaway::command::recording_args::RecordingArgs;
use breakaway::command::{discover, identify};
use breakaway::fleet::machine::Inputs;
use breakaway::identify::estimate;
use breakaway::report::json::Document;
use serde_json::{Value, json};

use super::data::measured_data;
use super::page::Page;

/// Relative difference up to which two numbers are equal. Sums of products and exponentials of the two platforms differ in
/// the last bit, 1e-16, and a simulation adds thousands of them. On this recording 5e-10 was measured.
const ROUNDING: f64 = 1e-6;

/// Where two documents differ by more than rounding, with both values.
fn differences(path: &str, own: &Value, other: &Value, found: &mut Vec<String>) {
    match (own, other) {
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{path}: {:?} and {:?}", a.keys(), b.keys());
            a.iter().for_each(|(key, value)| differences(&format!("{path}/{key}"), value, &b[key], found));
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            a.iter().zip(b).enumerate().for_each(|(k, (a, b))| differences(&format!("{path}/{k}"), a, b, found));
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            if (a - b).abs() > ROUNDING * a.abs().max(b.abs()) {
                found.push(format!("{path}: {a:e} and {b:e}"));
            }
        }
        _ if own == other => (),
        _ => found.push(format!("{path}: {own} and {other}")),
    }
}

/// Without what must differ: the time it took, the command and the names of the files.
fn comparable(mut document: Value, folder: &str) -> Value {
    if let Some(fields) = document.as_object_mut() {
        fields.remove("seconds");
    }
    if !document["provenance"].is_null() {
        document["provenance"]["command"] = json!("");
    }
    serde_json::from_str(&document.to_string().replace(folder, "")).unwrap()
}

/// What page and command make of a recording, and where they differ by more than rounding.
struct Both {
    page: Value,
    command: Value,
    differ: Vec<String>,
}

/// Discovers a recording on the page, with the columns as they are guessed, and by the command.
fn discovered(page: &mut Page, file: &Path, [time, input, position]: [&str; 3]) -> Both {
    page.choose("#fit-files", &[file]);
    for (role, name) in [("time", time), ("input", input), ("position", position)] {
        assert_eq!(page.browser.value(&format!("document.querySelector('#{role}').value")), name);
    }
    let found = page.discover().unwrap();
    let columns = |name: &str| Some(name.to_owned());
    let columns = RecordingArgs {
        time: columns(time),
        input: columns(input),
        position: columns(position),
        ..RecordingArgs::default()
    };
    let session = columns.read_session(&[file]).unwrap();
    let identified = estimate::identify(&session.recordings).unwrap();
    let identified = identify::Document::new(&identified, &session.recordings[0].units, session.remarks);
    let identified = versioned(&identified).unwrap();
    let inputs = Inputs { fit: vec![file.to_owned()], ..Inputs::default() };
    let (expected, _) = discover::find(&columns, &inputs, &|_| ()).unwrap();
    let mut expected = versioned(&Document::from(&expected)).unwrap();
    // The recording was read a second time here, and its warnings were said twice.
    let mut said = Vec::new();
    expected["remarks"].as_array_mut().unwrap().retain(|remark| {
        let new = !said.contains(remark);
        said.push(remark.clone());
        new
    });
    let folder = format!("{}/", file.parent().unwrap().display());
    let mut differ = Vec::new();
    for (name, own) in [("identify", &identified), ("discover", &expected)] {
        let (own, other) = (comparable(own.clone(), &folder), comparable(found[name].clone(), &folder));
        differences(name, &own, &other, &mut differ);
    }
    Both { page: found, command: json!({ "identify": identified, "discover": expected }), differ }
}

/// A pendulum (AK80), because its motion is not chaotic: a rotor that is simulated across its teeth makes another result of
/// the last bit.
#[test]
fn a_real_recording_gives_the_commands_numbers() {
    let mut page = needs!(Page::open());
    let data = needs!(measured_data());
    let pendulum = data.join("machines/pendulum-ak80/ddp.csv");
    let Both { page: found, differ, .. } = discovered(&mut page, &pendulum, ["time", "torque", "position"]);
    assert!(differ.is_empty(), "{}", differ.join("\n"));
    assert_eq!(found["discover"]["effects"][0]["name"], "gravity_load");

    // The report is shown, and can be saved with the model.
    page.until("document.querySelector('#report').contentDocument?.querySelector('h1') != null");
    assert!(found["report"].as_str().unwrap().starts_with("<!DOCTYPE html>"));
    assert!(found["model"].as_str().unwrap().contains("[base]"));
    assert_eq!(page.browser.value("document.querySelector('#save-model').href.startsWith('blob:')"), true);

    // The page's requests and its worker's.
    let requests = page.requests();
    assert!(requests.iter().any(|address| address.ends_with("/breakaway_bg.wasm")), "{requests:?}");
    let own = format!("blob:{}", page.address);
    let stays = |address: &String| {
        address.starts_with(&page.address)
            || address.starts_with(&own)
            || ["data:", "about:"].iter().any(|kind| address.starts_with(kind))
    };
    assert!(requests.iter().all(stays), "{requests:?}");
}

/// The ball screw of EMPS: all numbers of a longer discovery.
#[test]
#[ignore = "40 s; docs/browser.md has the command"]
fn a_longer_recording_gives_the_commands_numbers() {
    let mut page = needs!(Page::open());
    let data = needs!(measured_data());
    let Both { differ, .. } = discovered(&mut page, &data.join("emps/emps_train.csv"), ["t_s", "u_V", "x_m"]);
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

/// A rotor across its teeth is chaotic, and the last bit grows. What the page names is named by the command, and what is not
/// simulated is equal to rounding.
#[test]
#[ignore = "100 s; docs/browser.md has the command, and how far the numbers differ"]
fn a_chaotic_recording_gives_the_commands_names() {
    let data = needs!(measured_data());
    for (file, drive) in [("current-sine-2hz.csv", "iq_A"), ("speed-control.csv", "u_cmd_A")] {
        // A page keeps the files that were chosen before.
        let mut page = needs!(Page::open());
        let Both { page: found, command, differ } =
            discovered(&mut page, &data.join("laas-motor").join(file), ["t_s", drive, "x_rad"]);
        println!("{file}: {} numbers differ\n{}", differ.len(), differ.join("\n"));
        let names = |document: &Value| -> Vec<Value> {
            document["discover"]["effects"].as_array().unwrap().iter().map(|effect| effect["name"].clone()).collect()
        };
        assert_eq!(names(&found), names(&command), "{file}");
        assert_eq!(found["discover"]["verdict"], command["discover"]["verdict"], "{file}");
        let by = |document: &Value| document["identify"]["estimator"].clone();
        assert_eq!(by(&found), by(&command), "{file}");
    }
}
