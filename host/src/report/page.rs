//! A page: one HTML file that needs nothing else.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

use super::figure::{DARK, FIGURES, LIGHT};
use super::text::escape;
use crate::file::PAGE_MARK;

/// A part of a page under its own heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// The content, HTML.
    pub body: String,
}

impl Section {
    /// A section; `body` is HTML.
    pub fn new(heading: impl Into<String>, body: impl Into<String>) -> Self {
        Self { heading: heading.into(), body: body.into() }
    }
}

/// A page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Name of the browser's tab, and above the sentence.
    pub title: String,
    /// A word in a badge above the sentence; empty for none.
    pub badge: String,
    /// Class of the badge.
    pub badge_class: &'static str,
    /// What the page says, in one sentence.
    pub sentence: String,
    /// A few numbers with what they are, under the sentence.
    pub facts: Vec<(String, String)>,
    /// What comes before the first heading, HTML.
    pub lead: String,
    /// The rest.
    pub sections: Vec<Section>,
}

/// Zoom and read-out of the figures. Without it they are as they are drawn.
const SCRIPT: &str = include_str!("zoom.js");

const PAGE: &str = "\
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','DejaVu Sans',sans-serif}
main{max-width:864px;margin:0 auto;padding:28px 32px 56px}
.kicker{display:flex;flex-wrap:wrap;gap:6px 12px;align-items:center;color:var(--muted);margin:0 0 10px}
.badge{font-weight:650;border:1.5px solid currentColor;border-radius:999px;padding:1px 12px}
.badge.good{color:var(--floor)} .badge.part{color:var(--after)} .badge.open{color:var(--before)}
h1{font-size:27px;line-height:1.28;font-weight:680;margin:0 0 18px;letter-spacing:-.01em;text-wrap:balance;overflow-wrap:break-word}
h2{font-size:20px;margin:44px 0 10px;padding-top:12px;border-top:1px solid var(--rule)}
h3{font-size:17px;margin:26px 0 6px}
p,ul,ol{margin:8px 0} li{margin:4px 0}
dl.facts{display:flex;flex-wrap:wrap;gap:10px 32px;margin:0 0 26px}
dl.facts dt{color:var(--muted);font-size:13.5px} dl.facts dd{margin:0;font-size:18px;font-weight:620;font-variant-numeric:tabular-nums}
figure>div>svg{display:block;width:100%;height:auto}
figure{margin:22px 0 30px} figcaption{color:var(--muted);font-size:14.5px;margin-top:8px;max-width:72ch} figcaption b{color:var(--ink)}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums;font-size:15px;margin:8px 0}
th,td{text-align:left;padding:6px 14px 6px 0;border-bottom:1px solid var(--rule);vertical-align:top}
th{color:var(--muted);font-weight:600;font-size:13.5px} td.n,th.n{text-align:right;white-space:nowrap} td.q{white-space:nowrap} td.w{min-width:12em} tr.on td{font-weight:640}
code,pre{font:13.5px/1.5 ui-monospace,'SF Mono',Menlo,Consolas,'DejaVu Sans Mono',monospace}
pre{background:var(--wash);border-radius:8px;padding:12px 14px;overflow-x:auto;margin:10px 0}
code.hash{overflow-wrap:anywhere;color:var(--muted)}
.law{background:var(--wash);border-left:3px solid var(--after);padding:8px 14px;margin:10px 0;font-size:17px;overflow-wrap:anywhere}
.law+.scroll{margin-bottom:22px}
details>summary{cursor:pointer;color:var(--after);margin:10px 0}
.note{color:var(--muted);font-size:15px}
figure>div{position:relative}
figure svg[tabindex]{user-select:none;-webkit-user-select:none;outline:none} figure svg[tabindex]:focus-visible{outline:2px solid var(--after);outline-offset:6px}
.readout{position:absolute;z-index:1;pointer-events:none;max-width:60%;background:var(--paper);border:1px solid var(--rule);border-radius:6px;padding:5px 9px;font-size:13px;line-height:1.45;font-variant-numeric:tabular-nums;box-shadow:0 2px 8px #0003;opacity:.94}
.readout .row:not(:has(i)){font-weight:640} .readout i{display:inline-block;width:9px;height:9px;border-radius:50%;margin-right:6px}
button.whole{position:absolute;right:0;top:0;font:inherit;font-size:13px;color:var(--after);background:var(--paper);border:1px solid var(--after);border-radius:6px;padding:2px 9px;cursor:pointer}
.narrow .whole{top:-28px}
[hidden]{display:none!important}
.narrow{display:none}
@media (max-width:640px){main{padding:18px 16px 40px}h1{font-size:22px}.wide{display:none}.narrow{display:block}dl.facts{gap:10px 22px}table{font-size:14px}th,td{padding-right:10px}th.n{white-space:normal}td:first-child{min-width:6.5em}td.w{min-width:11em}}
@media print{.readout,.whole,.hint,svg .cursor,svg .spot,svg .chosen{display:none}body{font-size:11pt}main{max-width:none;padding:0}.wide{display:block}.narrow{display:none}figure,table,pre{break-inside:avoid}pre{white-space:pre-wrap;overflow-wrap:anywhere}h2,h3{break-after:avoid}h2{margin-top:26px}*{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
";

impl Page {
    /// The whole file.
    pub fn html(&self) -> String {
        // Here and below, writing to a String cannot fail.
        let mut out = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
        // The policy makes a browser refuse whatever a page without network must not ask for.
        let script = self.has_figures();
        // The script is named by its hash: no other runs, whatever a recording's name has in it.
        let allowed =
            if script { format!("; script-src 'sha256-{}'", base64(&Sha256::digest(SCRIPT))) } else { String::new() };
        let _ = writeln!(
            out,
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'{allowed}\">"
        );
        out.push_str(
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n",
        );
        let _ = writeln!(out, "{PAGE_MARK}");
        // Paper is light, whatever the screen was.
        let _ = writeln!(
            out,
            "<title>{}</title>\n<style>\n:root{{color-scheme:light dark;{LIGHT}}}\n\
             @media screen and (prefers-color-scheme:dark){{:root{{{DARK}}}}}\n{PAGE}{FIGURES}</style>\n</head>\n<body>\n<main>",
            escape(&self.title)
        );
        let badge = if self.badge.is_empty() {
            String::new()
        } else {
            format!("<span class=\"badge {}\">{}</span>", self.badge_class, escape(&self.badge))
        };
        let _ = writeln!(out, "<p class=\"kicker\">{badge}<span>{}</span></p>", escape(&self.title));
        let _ = writeln!(out, "<h1>{}</h1>", escape(&self.sentence));
        if !self.facts.is_empty() {
            out.push_str("<dl class=\"facts\">\n");
            for (what, value) in &self.facts {
                let _ = writeln!(out, "<div><dt>{}</dt><dd>{}</dd></div>", escape(what), escape(value));
            }
            out.push_str("</dl>\n");
        }
        out.push_str(&self.lead);
        for section in &self.sections {
            let _ = writeln!(out, "<section>\n<h2>{}</h2>\n{}</section>", escape(&section.heading), section.body);
        }
        let script = if script { format!("\n<script>{SCRIPT}</script>") } else { String::new() };
        let _ = writeln!(out, "</main>{script}\n</body>\n</html>");
        out
    }

    fn has_figures(&self) -> bool {
        std::iter::once(&self.lead)
            .chain(self.sections.iter().map(|section| &section.body))
            .any(|html| html.contains("<figure>"))
    }
}

/// Bytes as Base64 (RFC 4648, section 4), as the policy has a hash.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |group: &[u8]| {
        let bits = group.iter().chain([0, 0].iter()).take(3).fold(0_usize, |bits, byte| bits << 8 | usize::from(*byte));
        let letters: Vec<char> = (0..=group.len()).map(|k| char::from(LETTERS[bits >> (18 - 6 * k) & 63])).collect();
        letters.into_iter().chain(std::iter::repeat_n('=', 3 - group.len())).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

/// A table; cells of the columns marked `n` in `columns` (name, class) are numbers. Cells are HTML; rows may be marked.
pub fn table(columns: &[(&str, &str)], rows: &[(bool, Vec<String>)]) -> String {
    let mut out = String::from("<div class=\"scroll\"><table>\n<thead><tr>");
    for (name, class) in columns {
        let _ = write!(out, "<th class=\"{class}\" scope=\"col\">{}</th>", escape(name));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for (marked, cells) in rows {
        out.push_str(if *marked { "<tr class=\"on\">" } else { "<tr>" });
        for (cell, (_, class)) in cells.iter().zip(columns) {
            let _ = write!(out, "<td class=\"{class}\">{cell}</td>");
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table></div>\n");
    out
}

/// A list; items are plain text.
pub fn list<T: AsRef<str>>(items: &[T]) -> String {
    let mut out = String::from("<ul>\n");
    for item in items {
        let _ = writeln!(out, "<li>{}</li>", escape(item.as_ref()));
    }
    out + "</ul>\n"
}

#[cfg(test)]
mod tests {
    use super::base64;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_rfc() {
        let vectors =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in vectors {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
