"""Hooks of the documentation site: formulas as MathML, and tables of the message schemas."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path
from typing import Any

from griffe import Docstring, DocstringSectionKind
from latex2mathml.converter import convert

from igrip import Observation

DOCS = Path(__file__).parent
IN_ROOT = ("CHANGELOG.md", "CONTRIBUTING.md")  # whose pages of the site have the name in lower case
_SCHEMA = re.compile(r"^\{\{ schema (\w+) \}\}$", re.MULTILINE)
_INLINE = re.compile(r"(?<![\w\\$])\$([^$\n]+)\$(?!\w)")
_INCLUDED = re.compile(r'^--8<-- "(\w+\.md)"$', re.MULTILINE)
_CODE = re.compile(r"(```.*?^```|`[^`\n]*`)", re.DOTALL | re.MULTILINE)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Fill in whole files and the tables of schemas, and set inline formulas."""
    markdown = _INCLUDED.sub(lambda found: included_file(found[1]), markdown)
    for name in IN_ROOT:  # right on GitHub, and on the site
        markdown = markdown.replace(f"](../{name}", f"]({name.lower()}")
    markdown = _SCHEMA.sub(lambda found: schema_table(found[1]), markdown)
    pieces = _CODE.split(markdown)
    pieces[::2] = [_INLINE.sub(lambda found: convert(found[1]), text) for text in pieces[::2]]
    return "".join(pieces)


def included_file(name: str) -> str:
    """Return a Markdown file of the root, with links to pages of the site."""
    text = (DOCS.parent / name).read_text(encoding="utf-8").replace("](docs/", "](")
    for other in IN_ROOT:
        text = text.replace(f"]({other}", f"]({other.lower()}")
    return text


def format_math(source: str, *_: Any, **__: Any) -> str:
    """Return a block of LaTeX as MathML, which browsers draw without a script."""
    return f'<div class="formula">{convert(source, display="block")}</div>'


def schema_table(name: str) -> str:
    """Return the fields of a message, with their types and defaults, as a table."""
    schema = json.loads((DOCS / "schemas" / f"{name}.json").read_text(encoding="utf-8"))
    definitions = schema["$defs"]
    own = schema["$ref"].rpartition("/")[2]
    lines = []
    for title in [own, *sorted(definitions.keys() - {own})]:
        definition = definitions[title]
        if definition.get("type") != "object":
            continue
        required = definition.get("required", [])
        text = Observation.__doc__ if title == "Message" else definition.get("description")
        meaning = _meanings(text or "")
        lines += ["", *([] if title == own else [f"### {title}", ""])]
        lines += ["| field | type | default | meaning |", f"|{' --- |' * 4}"]
        for field, kind in definition["properties"].items():
            default = "required" if field in required else json.dumps(kind.get("default"))
            cells = (f"`{field}`", _type(kind), default, meaning.get(field, ""))
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _meanings(docstring: str) -> dict[str, str]:
    """Return the description of each field in the docstring of a message."""
    return {
        name.strip(): " ".join(one.description.split())
        for section in Docstring(inspect.cleandoc(docstring)).parse("numpy", warnings=False)
        if section.kind in (DocstringSectionKind.parameters, DocstringSectionKind.attributes)
        for one in section.value
        for name in one.name.split(",")
    }


def _type(kind: dict[str, Any]) -> str:
    """Return a JSON schema's type in a few words."""
    if "$ref" in kind:
        return f"[{(title := kind['$ref'].rpartition('/')[2])}](#{title.lower()})"
    if "anyOf" in kind:
        return " or ".join(dict.fromkeys(_type(one) for one in kind["anyOf"]))
    if "enum" in kind:
        return ", ".join(f"`{value}`" for value in kind["enum"])
    if kind.get("type") == "array":
        prefix = kind.get("prefixItems")
        return f"{len(prefix)} numbers" if prefix else f"array of {_type(kind.get('items', {}))}"
    if kind.get("type") == "object":
        values = kind.get("additionalProperties")
        return f"object of {_type(values)}" if isinstance(values, dict) else "object"
    return str(kind.get("type", "any"))
