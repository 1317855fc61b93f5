"""HTML pages from templates; all share one style, and none needs a file beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

TEMPLATES = Path(__file__).parent / "templates"


def sources(template: str) -> list[str]:
    """Texts that a page of this template is made of, apart from its values."""
    return [(TEMPLATES / name).read_text(encoding="utf-8") for name in (template, "style.css")]


def page(template: str, **values: Any) -> str:
    """HTML text of a template with values; texts among them are escaped.

    Raises
    ------
    jinja2.UndefinedError
        If the template asks for a value that is not given.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    from workflows.progress import duration
    from workflows.tables import number, parameter

    environment = Environment(
        loader=FileSystemLoader(TEMPLATES, encoding="utf-8"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "parameter": parameter, "duration": duration}
    return environment.get_template(template).render(**values)
