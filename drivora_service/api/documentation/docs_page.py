"""The page of the API at ``/docs``: written from the OpenAPI document, without external resources.

It loads nothing, from here or from elsewhere, and needs no script.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

_STYLE = """
:root { --ink:#1c2733; --faint:#5f6c7b; --line:#dfe4ea; --soft:#f5f7f9; --accent:#0b6e8f;
  --good:#1f7a4d; --bad:#b3372f; --code:#f2f4f7; --page:#ffffff; }
@media (prefers-color-scheme: dark) { :root { --ink:#e3e8ee; --faint:#9aa7b5; --line:#313b47;
  --soft:#1a2129; --accent:#5cc0de; --good:#63c594; --bad:#ef8a80; --code:#202932;
  --page:#12171d; } }
* { box-sizing:border-box }
body { margin:0; background:var(--page); color:var(--ink);
  font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif; }
.layout { display:grid; grid-template-columns:17rem minmax(0,52rem); gap:3rem; max-width:76rem;
  margin:0 auto; padding:0 1.5rem; }
nav { position:sticky; top:0; height:100vh; overflow-y:auto; padding:2rem 0; font-size:.86rem; }
nav h2 { font-size:.75rem; letter-spacing:.06em; text-transform:uppercase; color:var(--faint);
  margin:1.4rem 0 .3rem; }
nav a { display:flex; gap:.5rem; padding:.14rem 0; color:var(--ink); text-decoration:none; }
a { color:var(--accent); }
nav a:hover span { text-decoration:underline; }
main { padding:2rem 0 5rem; }
h1 { font-size:1.9rem; margin:0 0 .2rem; letter-spacing:-.01em; }
.facts { color:var(--faint); margin:0 0 1.5rem; }
main > h2 { margin:3rem 0 .5rem; font-size:1.3rem; text-transform:capitalize;
  border-bottom:1px solid var(--line); padding-bottom:.35rem; }
section { padding:1.4rem 0 1.2rem; border-bottom:1px solid var(--line); }
section h3 { margin:0; font-size:1rem; font-weight:600; overflow-wrap:anywhere; }
section h3 a { color:inherit; text-decoration:none; }
section p { margin:.5rem 0 .8rem; }
.method { font:700 .72rem/1.5 ui-monospace,Menlo,Consolas,monospace; color:var(--accent);
  min-width:2.9rem; display:inline-block; letter-spacing:.02em; }
.method.post { color:var(--good); } .method.delete { color:var(--bad); }
code, pre { font:.85em/1.5 ui-monospace,Menlo,Consolas,"DejaVu Sans Mono",monospace; }
p code, td code { background:var(--code); border-radius:4px; padding:.08em .3em; }
table { border-collapse:collapse; width:100%; font-size:.9rem; margin:.3rem 0 .8rem; }
th { text-align:left; font-weight:600; color:var(--faint); font-size:.78rem; }
th, td { padding:.35rem .9rem .35rem 0; border-bottom:1px solid var(--line); vertical-align:top; }
td:first-child, td:nth-child(2) { white-space:nowrap; }
details { margin:.35rem 0; } summary { cursor:pointer; font-size:.9rem; color:var(--accent); }
pre { background:var(--soft); border:1px solid var(--line); border-radius:8px; padding:.8rem 1rem;
  overflow:auto; max-height:26rem; }
.errors { font-size:.86rem; color:var(--faint); }
@media (max-width: 820px) { .layout { grid-template-columns:minmax(0,1fr); gap:0; }
  nav { order:2; position:static; height:auto; } nav a { padding:.3rem 0 }
  td:first-child { white-space:normal; overflow-wrap:anywhere; }
  td:nth-child(2) { white-space:normal; } }
"""


def docs_page(document: Mapping[str, Any]) -> str:
    """Writes the page.

    Args:
        document: The OpenAPI document.
    """
    groups: dict[str, list[tuple[str, str, Mapping[str, Any]]]] = {}
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            tag = operation.get("tags", ["service"])[0]
            groups.setdefault(tag, []).append((method, path, operation))
    info = document["info"]
    intro = "".join(f"<p>{_text(part)}</p>" for part in info["description"].strip().split("\n\n"))
    title = f"{info['title']} API"
    root = document.get("servers", [{"url": ""}])[0]["url"]
    return (
        "<!doctype html>\n"
        '<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{escape(title)}</title><link rel="icon" href="data:,">'
        f"<style>{_STYLE}</style></head><body>"
        f'<div class="layout"><nav aria-label="Operations">{"".join(_menu(groups))}</nav><main>'
        f'<h1>{escape(title)}</h1><p class="facts">Version {escape(info["version"])} · '
        f'<a href="{escape(root)}/api/v1/openapi.json">OpenAPI document</a></p>'
        f"{intro}{''.join(_sections(groups, document, root))}</main></div></body></html>\n"
    )


def _menu(groups: Mapping[str, list[tuple[str, str, Mapping[str, Any]]]]) -> Iterator[str]:
    for tag, operations in groups.items():
        yield f"<h2>{escape(tag)}</h2>"
        for method, path, _ in operations:
            place = f"{_method(method)}<span>{_path(path)}</span>"
            yield f'<a href="#{_anchor(method, path)}">{place}</a>'


def _sections(
    groups: Mapping[str, list[tuple[str, str, Mapping[str, Any]]]],
    document: Mapping[str, Any],
    root: str,
) -> Iterator[str]:
    for tag, operations in groups.items():
        yield f"<h2>{escape(tag)}</h2>"
        for method, path, operation in operations:
            anchor = _anchor(method, path)
            yield (
                f'<section id="{anchor}"><h3><a href="#{anchor}">{_method(method)}'
                f"<code>{escape(root + path)}</code></a></h3>"
            )
            for part in operation.get("description", "").strip().split("\n\n"):
                yield f"<p>{_text(part)}</p>"
            yield _parameters(operation.get("parameters", ()), document)
            for media, content in operation.get("requestBody", {}).get("content", {}).items():
                yield _example(f"Request body, {media}", content)
            yield from _answers(operation["responses"])
            yield "</section>"


def _parameters(parameters: list[Mapping[str, Any]], document: Mapping[str, Any]) -> str:
    if not parameters:
        return ""
    rows = "".join(
        f"<tr><td><code>{escape(parameter['name'])}</code></td>"
        f"<td>{escape(_kind(parameter.get('schema', {}), document))}</td>"
        f"<td>{_text(parameter.get('description', ''))} "
        f"{_where(parameter)}</td></tr>"
        for parameter in parameters
    )
    return f"<table><thead><tr><th>parameter</th><th>type</th><th></th></tr></thead>{rows}</table>"


def _where(parameter: Mapping[str, Any]) -> str:
    words = {"path": "Part of the path.", "header": "A header."}.get(parameter["in"], "")
    default = parameter.get("schema", {}).get("default")
    if default not in (None, ""):
        words += f" Default: <code>{escape(json.dumps(default))}</code>."
    return words.strip()


def _kind(schema: Mapping[str, Any], document: Mapping[str, Any]) -> str:
    """Names the type of a parameter, with its choices where there are some."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return _kind(document["components"]["schemas"][name], document)
    if "enum" in schema:
        return ", ".join(map(str, schema["enum"]))
    if "anyOf" in schema:
        kinds = [_kind(choice, document) for choice in schema["anyOf"]]
        return " or ".join(kind for kind in kinds if kind != "null")
    if schema.get("type") == "array":
        return f"{_kind(schema.get('items', {}), document)}, repeatable"
    return str(schema.get("type", ""))


def _answers(responses: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    errors = []
    for status, answer in sorted(responses.items()):
        if status >= "400":
            errors.append(f"{escape(status)} {escape(answer['description'])}")
            continue
        for media, content in answer.get("content", {}).items():
            yield _example(f"Answer {status}, {media}", content)
    if errors:
        yield f'<p class="errors">Errors: {"; ".join(errors)}.</p>'


def _example(title: str, content: Mapping[str, Any]) -> str:
    example = content.get("example")
    if example is None:
        return f'<p class="errors">{escape(title)}</p>'
    shown = example if isinstance(example, str) else json.dumps(example, indent=2)
    return f"<details><summary>{escape(title)}</summary><pre>{escape(shown)}</pre></details>"


def _method(method: str) -> str:
    return f'<span class="method {escape(method)}">{escape(method.upper())}</span> '


def _path(path: str) -> str:
    # May be broken before a part, and not within one.
    short = escape(path.removeprefix("/api/v1"))
    return short.replace("/", "<wbr>/").replace(":", "<wbr>:")


def _anchor(method: str, path: str) -> str:
    return "-".join((method, *"".join(c if c.isalnum() else " " for c in path).split()))


def _text(text: str) -> str:
    """Writes prose whose backquotes mark code."""
    parts = escape(" ".join(text.split())).split("`")
    return "".join(f"<code>{part}</code>" if i % 2 else part for i, part in enumerate(parts))
