"""Paint: colours and the other things that `fill` and `stroke` accept."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import NamedTuple

import tinycss2
from tinycss2.color4 import parse_color

_HEX = re.compile(r"#[0-9a-fA-F]{6}")
MAX_PAINT_CHARS = 500
"""characters of a paint that is looked at; no colour is as long"""


class Paint(NamedTuple):
    """What a stroke or an area is painted with.

    Parameters
    ----------
    kind : "none", "color", "current" (the property `color`), "reference" (a gradient or pattern) or "context"
    color : "#rrggbb" of a colour
    alpha : 0..1 of a colour
    reference : id that a reference names; empty when it is outside the file
    fallback : of a reference, when it names nothing
    """

    kind: str
    color: str = "#000000"
    alpha: float = 1.0
    reference: str = ""
    fallback: Paint | None = None


NO_PAINT = Paint("none")
BLACK = Paint("color")


@lru_cache(maxsize=4096)
def parse_paint(text: str) -> Paint | None:
    """The paint that `text` writes, or None when it writes none."""
    text = text.strip()
    if _HEX.fullmatch(text):
        return Paint("color", text.lower())
    if len(text) > MAX_PAINT_CHARS:
        return None
    tokens = [
        token
        for token in tinycss2.parse_component_value_list(text, skip_comments=True)
        if token.type not in ("whitespace", "comment")
    ]
    if not tokens:
        return None
    first, rest = tokens[0], tokens[1:]
    target = _reference(first)
    if target is not None:
        fallback = parse_paint(tinycss2.serialize(rest)) if rest else None
        if rest and fallback is None:
            return None
        return Paint("reference", reference=target, fallback=fallback)
    if rest and not (rest[0].type == "function" and rest[0].lower_name in ("icc-color", "device-cmyk")):
        return None
    if first.type == "ident":
        keyword = first.lower_value
        if keyword == "none":
            return NO_PAINT
        if keyword in ("context-fill", "context-stroke"):
            return Paint("context")
    return _color(first)


def _reference(token: tinycss2.ast.Node) -> str | None:
    """The id that url(#id) names, "" for one outside the file, None when `token` is no url."""
    if token.type == "url":
        target = token.value
    elif token.type == "function" and token.lower_name == "url" and token.arguments:
        target = getattr(token.arguments[0], "value", "")
    else:
        return None
    target = str(target).strip()
    return target[1:] if target.startswith("#") else ""


def _color(token: tinycss2.ast.Node) -> Paint | None:
    try:
        parsed = parse_color(token)
        if parsed is None:
            return None
        if parsed == "currentcolor":
            return Paint("current")
        channels = [0.0 if value is None else value for value in parsed.to("srgb").coordinates]
    except (NotImplementedError, ValueError, ArithmeticError, AttributeError, TypeError):
        # spaces such as lab() that tinycss2 knows but does not convert
        return None
    if not all(abs(value) < 1e6 for value in channels):
        return None
    levels = [min(255, max(0, int(value * 255 + 0.5))) for value in channels]
    return Paint("color", "#" + "".join(f"{level:02x}" for level in levels), parsed.alpha)
