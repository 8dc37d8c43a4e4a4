//! Colours and strokes. The three model colours are those of Okabe and Ito. They are darkened or lightened until
//! lettering in them has a contrast of at least 4.5 : 1 on the paper.

/// The light palette, as CSS custom properties.
pub const LIGHT: &str = "--paper:#ffffff;--wash:#f4f6f8;--ink:#1a1e23;--muted:#59626d;--rule:#d9dee4;--measured:#b4bdc8;\
--before:#b84a00;--after:#00619f;--drive:#6a4c9c;--floor:#00735a";

/// The dark palette.
pub const DARK: &str = "--paper:#14181d;--wash:#1c2228;--ink:#e9edf2;--muted:#a4aeba;--rule:#333c46;--measured:#66717e;\
--before:#ff9d5c;--after:#6fbcff;--drive:#c3aaf4;--floor:#52d1aa";

/// The rules for figures.
pub const FIGURES: &str = "\
svg{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','DejaVu Sans',sans-serif;font-size:13px}
svg text{fill:var(--ink);font-variant-numeric:tabular-nums}
svg text.tick,svg text.unit{fill:var(--muted)}
svg text.tick{font-size:12px}
svg text.strong{font-weight:650}
svg text.t-before{fill:var(--before)} svg text.t-after{fill:var(--after)} svg text.t-drive{fill:var(--drive)} svg text.t-floor{fill:var(--floor)}
svg text.halo{paint-order:stroke;stroke:var(--paper);stroke-width:5px;stroke-linejoin:round}
svg path{fill:none;stroke-linejoin:round;stroke-linecap:round}
svg .grid{stroke:var(--rule);stroke-width:1;fill:none}
svg .axis{stroke:var(--muted);stroke-width:1;fill:none}
svg .measured{stroke:var(--measured);stroke-width:6}
svg .before{stroke:var(--before);stroke-width:1.8;stroke-dasharray:7 4;stroke-linecap:butt}
svg .error-before{stroke:var(--before);stroke-width:1.4}
svg .after{stroke:var(--after);stroke-width:2}
svg .drive{stroke:var(--drive);stroke-width:1.4;stroke-dasharray:2 0}
svg .floor{stroke:var(--floor);stroke-width:1.8;stroke-dasharray:1.5 4}
svg .edge{stroke:var(--floor);stroke-width:1;stroke-dasharray:1.5 4;fill:none}
svg .link-drive{stroke:var(--drive);stroke-width:1.6;stroke-dasharray:6 4;fill:none}
svg .link-muted{stroke:var(--muted);stroke-width:1.6;stroke-dasharray:2 4;fill:none}
svg .link-after{stroke:var(--after);stroke-width:2.6;fill:none}
svg .dot-after{fill:var(--after);stroke:var(--paper);stroke-width:1.5}
svg .dot-before{fill:var(--before);stroke:var(--paper);stroke-width:1.5}
svg .dot-drive{fill:var(--drive);stroke:var(--paper);stroke-width:1.5}
svg .dot-muted{fill:var(--paper);stroke:var(--muted);stroke-width:1.8}
svg .band-before{fill:var(--before);opacity:.2;stroke:none}
svg .band-after{fill:var(--after);opacity:.22;stroke:none}
svg .band-floor{fill:var(--floor);opacity:.14;stroke:none}
svg .bar-before{fill:var(--before);stroke:var(--before);stroke-width:1}
svg .bar-after{fill:var(--paper);stroke:var(--after);stroke-width:1.8}
svg .column{fill:var(--wash);stroke:none}
svg .pill{fill:var(--paper);stroke:var(--after);stroke-width:1.4}
svg .unseen{stroke:var(--before);stroke-opacity:0}
svg .cursor{stroke:var(--muted);stroke-width:1;stroke-dasharray:3 3}
svg .spot{stroke:var(--paper);stroke-width:1.5}
svg .chosen{fill:var(--after);opacity:.14;stroke:none}
svg .paper{fill:var(--paper)}
";
