//! A headless Chromium, driven by its DevTools protocol over two pipes: JSON messages, each ended by a zero byte.

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// An answer that takes longer will not come. A discovery in the page takes 8 s on a quiet machine. No result depends on it.
pub const PATIENCE: Duration = Duration::from_secs(180);
/// So much longer than the page's own deadlines, for their message to come first.
const GRACE: Duration = Duration::from_secs(20);

/// Where `cargo xtask web` and `cargo xtask test` leave what they fetch, and what is installed.
fn program() -> Option<PathBuf> {
    let unpacked = super::page::target_folder().join("images/chromium-headless-shell");
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "google-chrome", "chromium-browser", "chromium-headless-shell"];
    let installed = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let named = std::env::var_os("BREAKAWAY_CHROMIUM").map(PathBuf::from);
    named.into_iter().chain(installed).chain([unpacked]).find(|file| file.is_file())
}

/// A running browser with one page; it ends with this value.
pub struct Chromium {
    process: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    session: Option<String>,
    last: u64,
    /// Messages that came between the answers.
    pub events: Vec<Value>,
    _profile: tempfile::TempDir,
}

impl Chromium {
    /// Starts it with an empty page; `None` where there is none.
    pub fn start() -> Option<Self> {
        let Some(program) = program() else {
            assert!(std::env::var_os("CI").is_none(), "no Chromium");
            println!("NOT RUN: no Chromium; `cargo xtask test` fetches one");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        // Chromium reads its commands from file 3 and answers on file 4.
        let mut process = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 0</dev/null 1>/dev/null 2>&1"])
            .arg(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .arg("--disable-dev-shm-usage")
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let to = process.stdin.take().unwrap();
        let mut out = BufReader::new(process.stdout.take().unwrap());
        let (send, from) = channel();
        thread::spawn(move || {
            let mut message = Vec::new();
            while out.read_until(0, &mut message).is_ok_and(|read| read > 0) {
                let Ok(value) = serde_json::from_slice(&message[..message.len() - 1]) else { break };
                if send.send(value).is_err() {
                    break;
                }
                message.clear();
            }
        });
        let mut own = Self { process, to, from, session: None, last: 0, events: Vec::new(), _profile: profile };
        let target = own.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        own.session = own.call("Target.attachToTarget", attach)["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page.enable", "Runtime.enable", "DOM.enable", "Network.enable"] {
            own.call(domain, json!({}));
        }
        Some(own)
    }

    /// Calls a method and waits for its answer, whatever else comes meanwhile.
    #[allow(clippy::needless_pass_by_value, reason = "parameters are written where they are given")]
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        let id = self.send(method, &parameters, self.session.clone());
        let latest = Instant::now() + PATIENCE + GRACE;
        loop {
            let left = latest.saturating_duration_since(Instant::now());
            let answer = self.from.recv_timeout(left).unwrap_or_else(|error| panic!("{method}: {error}"));
            if answer["id"] == id {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            if answer["method"] == "Target.attachedToTarget" {
                let worker = answer["params"]["sessionId"].as_str().map(str::to_owned);
                for method in ["Network.enable", "Runtime.runIfWaitingForDebugger"] {
                    self.send(method, &json!({}), worker.clone());
                }
            }
            self.events.push(answer);
        }
    }

    fn send(&mut self, method: &str, parameters: &Value, session: Option<String>) -> u64 {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": parameters });
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        self.to.write_all(format!("{message}\0").as_bytes()).unwrap();
        self.last
    }

    /// The value of an expression in the page; a promise is waited for.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", parameters);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // It ends its own children with it.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
