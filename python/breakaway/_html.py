"""How results show themselves in a notebook."""

from __future__ import annotations

import html
from typing import Any, Iterable

#: Height of a report in a notebook, pixels: its sentence, its numbers and its first figure.
HEIGHT = 720


def framed(page: str) -> str:
    """A whole page in a frame of its own, so that its style and the notebook's do not meet."""
    return (
        f'<iframe srcdoc="{html.escape(page)}" sandbox="" title="Breakaway report" loading="lazy"'
        f' style="width:100%;height:{HEIGHT}px;border:0"></iframe>'
    )


def table(rows: Iterable[tuple[str, Any]], notes: Iterable[str]) -> str:
    """Rows of a name and what it is, with notes below."""
    cells = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>" for name, value in rows)
    below = "".join(f"<li>{html.escape(note)}</li>" for note in notes)
    return f"<table><tbody>{cells}</tbody></table><ul>{below}</ul>"
