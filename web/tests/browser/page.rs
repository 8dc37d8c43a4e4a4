//! The page under test, and what a user does with it.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::chromium::{Chromium, PATIENCE};
use super::server::serve;

/// Cargo's target folder: that from which this program runs.
pub fn target_folder() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    program.ancestors().nth(3).unwrap().to_path_buf()
}

/// The folder that `cargo xtask web` has made; `None` where it has not.
pub fn folder() -> Option<PathBuf> {
    let folder = target_folder().join("web");
    if folder.join("breakaway_bg.wasm").is_file() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "no page in {}", folder.display());
    println!("NOT RUN: no page in {}; `cargo xtask web` builds it", folder.display());
    None
}

/// The page in a browser.
pub struct Page {
    pub browser: Chromium,
    pub address: String,
}

impl Page {
    /// Loads it; `None` where there is no page or no Chromium.
    pub fn open() -> Option<Self> {
        let address = serve(&folder()?);
        let mut browser = Chromium::start()?;
        // The worker's requests are seen too: it waits until its log is switched on.
        browser.call(
            "Target.setAutoAttach",
            json!({ "autoAttach": true, "waitForDebuggerOnStart": true, "flatten": true }),
        );
        browser.call("Page.navigate", json!({ "url": format!("{address}/") }));
        let mut page = Self { browser, address };
        page.until("document.readyState === 'complete' && document.querySelector('#run')?.onclick != null");
        Some(page)
    }

    /// Waits until a condition holds in the page. Where it does not in time, the test fails with what the page shows.
    pub fn until(&mut self, condition: &str) {
        let (patience_ms, shown) = (PATIENCE.as_millis(), "(document.body?.innerText ?? '').slice(0, 2000)");
        let wait = format!(
            "new Promise((resolve) => {{ const end = performance.now() + {patience_ms}; const look = () => \
             ({condition}) ? resolve(null) : performance.now() > end ? resolve({shown}) : setTimeout(look, 20); look(); }})"
        );
        let shown = self.browser.value(&wait);
        assert!(shown.is_null(), "`{condition}` does not come; the page shows:\n{shown}");
    }

    /// Chooses files, and waits until the page has looked at the first one. Nothing may be wrong with it.
    pub fn choose(&mut self, input: &str, files: &[&Path]) {
        self.offer(input, files);
        assert_eq!(self.message(), "", "{files:?}");
    }

    /// Chooses files, and waits until the page has looked at the first one, or says what is wrong with it.
    pub fn offer(&mut self, input: &str, files: &[&Path]) {
        let document = self.browser.call("DOM.getDocument", json!({}));
        let selector = json!({ "nodeId": document["root"]["nodeId"], "selector": input });
        let node = self.browser.call("DOM.querySelector", selector);
        self.browser.call("DOM.setFileInputFiles", json!({ "nodeId": node["nodeId"], "files": files }));
        self.until("!document.querySelector('#columns').hidden || !document.querySelector('#message').hidden");
    }

    /// Chooses a column.
    pub fn column(&mut self, role: &str, name: &str) {
        let set = format!(
            "(() => {{ const own = document.querySelector('#{role}'); own.value = '{name}'; return own.value }})()"
        );
        assert_eq!(self.browser.value(&set), name, "{role}");
    }

    /// Presses a button.
    pub fn press(&mut self, button: &str) {
        self.browser.value(&format!("document.querySelector('{button}').click()"));
    }

    /// What the page says is wrong; empty for nothing.
    pub fn message(&mut self) -> String {
        self.browser.value("document.querySelector('#message').textContent").as_str().unwrap_or_default().to_owned()
    }

    /// Waits for the middle of a run: the page itself says `loading`, and the WebAssembly reports every step after that. One
    /// step may be over before it is looked for, so any will do.
    pub fn until_working(&mut self) {
        let (step, over) = ("document.querySelector('#step').textContent", "document.querySelector('#work').hidden");
        // A run that ends before its first step is not waited for.
        self.until(&format!("{over} || !['', 'loading'].includes({step})"));
        assert_eq!(self.browser.value(over), false, "the run ended: {}", self.message());
    }

    /// Discovers and waits for the end. Gives what came out, or what the page says is wrong.
    pub fn discover(&mut self) -> Result<Value, String> {
        self.press("#run");
        self.until("document.querySelector('#work').hidden");
        let message = self.message();
        if message.is_empty() { Ok(self.browser.value("window.breakaway")) } else { Err(message) }
    }

    /// The addresses that the page asked for, and its worker too.
    pub fn requests(&self) -> Vec<String> {
        let sent = self.browser.events.iter().filter(|event| event["method"] == "Network.requestWillBeSent");
        sent.filter_map(|event| event["params"]["request"]["url"].as_str().map(str::to_owned)).collect()
    }
}
