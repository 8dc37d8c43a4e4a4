//! A real recording gives the command's numbers, and nothing is asked of another machine.

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

/// EMPS, because its motion is not chaotic: a rotor that is simulated across its teeth makes another result of the last bit.
#[test]
fn a_real_recording_gives_the_commands_numbers() {
    let mut page = needs!(Page::open());
    let data = needs!(measured_data());
    let file = data.join("emps/emps_train.csv");
    page.choose("#fit-files", &[&file]);
    // As they are guessed.
    for (role, name) in [("time", "t_s"), ("input", "u_V"), ("position", "x_m")] {
        assert_eq!(page.browser.value(&format!("document.querySelector('#{role}').value")), name);
    }
    let found = page.discover().unwrap();

    let columns = |name: &str| Some(name.to_owned());
    let columns = RecordingArgs {
        time: columns("t_s"),
        input: columns("u_V"),
        position: columns("x_m"),
        ..RecordingArgs::default()
    };
    let session = columns.read_session(&[&file]).unwrap();
    let identified = estimate::identify(&session.recordings).unwrap();
    let identified = identify::Document::new(&identified, &session.recordings[0].units, session.remarks);
    let identified = versioned(&identified).unwrap();
    let inputs = Inputs { fit: vec![file.clone()], ..Inputs::default() };
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
    for (name, own) in [("identify", identified), ("discover", expected)] {
        let (own, other) = (comparable(own, &folder), comparable(found[name].clone(), &folder));
        differences(name, &own, &other, &mut differ);
    }
    assert!(differ.is_empty(), "{}", differ.join("\n"));

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
