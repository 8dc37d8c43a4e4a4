//! What a file is that is not what was asked for: a model given as a recording, a page, a program.

/// What a file with this content seems to be, in words with an article, or `None`. Asked only when its reader refuses it.
pub fn seems(content: &[u8]) -> Option<&'static str> {
    let text = std::str::from_utf8(content).ok();
    let binary = |byte: &u8| *byte < b' ' && !b"\t\n\r".contains(byte);
    // A recording in an old code page is not UTF-8 either, but has no control characters.
    let Some(text) = text.filter(|text| !text.bytes().any(|byte| binary(&byte))) else {
        return content.iter().any(binary).then_some("binary data");
    };
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.clone().next()?;
    if first.starts_with('<') {
        return Some("a page (HTML or XML)");
    }
    if first.starts_with('{') {
        return Some("a JSON file");
    }
    let has = |section: &str| lines.clone().any(|line| line.starts_with(section));
    // Neither a header row of units, `[s],[V]`, nor one with an equals sign in a name.
    let single = |part: &str| !part.contains([',', ';', '\t']);
    if first.starts_with('[') && single(first) || first.split_once('=').is_some_and(|(key, _)| single(key)) {
        return Some(match () {
            () if has("[controller]") || has("[pid]") => "a controller (TOML)",
            () if has("[excitation") => "an experiment (TOML)",
            () if has("[base]") => "a model (TOML)",
            () => "a TOML file",
        });
    }
    let columns = |line: &str| line.split([',', ';', '\t']).count();
    let second = lines.nth(1)?;
    (columns(first) > 1 && columns(first) == columns(second)).then_some("a recording (CSV)")
}

#[cfg(test)]
mod tests {
    use super::seems;

    #[test]
    fn each_kind_of_file_is_known() {
        for (content, expected) in [
            (&b"# tick: 0.001 s\nt,u,x\n0,1,2\n"[..], Some("a recording (CSV)")),
            (b"[base]\nb = 1\n", Some("a model (TOML)")),
            (b"# by\n\nname = \"relay\"\n[excitation]\n", Some("an experiment (TOML)")),
            (b"[controller]\n[pid]\n", Some("a controller (TOML)")),
            (b"[base]\n[model]\n[pid]\n", Some("a controller (TOML)")),
            (b"a = 1\n", Some("a TOML file")),
            (b"<!DOCTYPE html>\n", Some("a page (HTML or XML)")),
            (b"{\"verdict\": 1}\n", Some("a JSON file")),
            (b"\x7fELF\x01\x00\x00", Some("binary data")),
            (b"[s],[V]\n0,1\n", Some("a recording (CSV)")),
            // Latin-1, no text that is known, nothing.
            (b"\xb5m,x\n1,2\n", None),
            (b"hello\nworld\n", None),
            (b"", None),
        ] {
            assert_eq!(seems(content), expected, "{:?}", String::from_utf8_lossy(content));
        }
    }
}
