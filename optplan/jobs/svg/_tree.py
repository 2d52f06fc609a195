"""From a file, bytes or text to an XML tree, within limits and without trusting what it says."""

from __future__ import annotations

import gzip
import io
import os
import stat
import zlib
from pathlib import Path
from typing import NamedTuple, cast
from xml.parsers import expat

from lxml import etree

from optplan.domain.errors import InputError, LimitError, located
from optplan.jobs.svg.limits import (
    MAX_ATTRIBUTES,
    MAX_BYTES,
    MAX_DEPTH,
    MAX_ENTITIES,
    MAX_ENTITY_CHARS,
    MAX_NODES,
    MAX_OWN_ATTRIBUTES,
)

SVG = "http://www.w3.org/2000/svg"
_CHUNK = 65536
_TOO_DEEP = f"elements are nested more than {MAX_DEPTH} deep, the limit"


class Source(NamedTuple):
    """What was given to read.

    Parameters
    ----------
    name : of the file, or of what stands for it in messages
    stem : name for people, "" when there was no file
    data : contents, decompressed
    encoding : of the data where it is known without looking into it
    """

    name: str
    stem: str
    data: bytes
    encoding: str | None = None


def open_source(source: str | bytes | os.PathLike[str]) -> Source:
    """Read a path, bytes, or text that starts with "<".

    Raises
    ------
    InputError : no such file, not a file, not readable, empty, broken compression
    LimitError : more bytes than the limit
    """
    if isinstance(source, bytes | bytearray | memoryview):
        opened = Source("<bytes>", "", bytes(source[: MAX_BYTES + 1]))
    elif isinstance(source, str) and source.lstrip("\ufeff \t\r\n").startswith("<"):
        try:
            opened = Source("<text>", "", source.lstrip("\ufeff").encode()[: MAX_BYTES + 1], "utf-8")
        except UnicodeEncodeError as error:
            raise InputError(f"is not valid text ({error.reason})", "<text>") from None
    else:
        opened = _open_file(os.fspath(source))
    with located(opened.name):
        if opened.data.startswith(b"\x1f\x8b"):
            opened = opened._replace(data=_decompress(opened.data))
        if len(opened.data) > MAX_BYTES:
            raise LimitError(f"is larger than the limit of {MAX_BYTES} bytes")
        if not opened.data.strip():
            raise InputError("is empty; expected an SVG drawing")
    return opened


def _open_file(path: str) -> Source:
    try:
        with located(path or "<empty path>"):
            state = Path(path).stat()
            if stat.S_ISDIR(state.st_mode):
                raise InputError("is a folder; expected an SVG file")
            if not stat.S_ISREG(state.st_mode):
                raise InputError("is not an ordinary file; expected an SVG file")
            if state.st_size > MAX_BYTES:
                raise LimitError(f"has {state.st_size} bytes; the limit is {MAX_BYTES} bytes")
            with Path(path).open("rb") as file:
                data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise InputError("there is no such file; expected an SVG file", path) from None
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", path[:200]) from None
    # bytes of a name that are no text cannot be written into a plan
    stem = os.fsencode(Path(path).stem).decode("utf-8", "replace")
    return Source(path, stem, data)


def _decompress(data: bytes) -> bytes:
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as file:
            return file.read(MAX_BYTES + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"is compressed, but the compression is broken ({error})") from None


def parse_tree(source: Source) -> etree._Element:
    """The root element.

    Raises
    ------
    InputError : not XML, not SVG, entities other than short plain text
    LimitError : nested deeper or holding more than the limits
    """
    quotes = source.data.count(b'"') + source.data.count(b"'")
    if quotes // 2 > MAX_ATTRIBUTES:
        raise LimitError(f"has {quotes // 2} quoted values; the limit is {MAX_ATTRIBUTES} attributes")
    entities = _check_prolog(source)
    # libxml2 guards the growth of entities itself, but then also refuses attributes above 10 MB: large embedded images
    parser = etree.XMLPullParser(
        events=("start", "end"),
        no_network=True,
        load_dtd=False,
        resolve_entities="internal",  # type: ignore[arg-type] # the stubs know only bool
        huge_tree=not entities,
        encoding=source.encoding,
    )
    try:
        root = _feed(parser, source.data)
    except etree.XMLSyntaxError as error:
        if "Excessive depth" in error.msg:
            # the parser's own limit lies higher, but it looks ahead of what it hands over
            raise LimitError(_TOO_DEEP, f"line {error.lineno}") from None
        message = " ".join(error.msg.split())
        raise InputError(f"is not well-formed XML: {message}") from None
    except LookupError as error:
        raise InputError(f"has an encoding that is not known ({error})") from None
    if etree.QName(root).localname != "svg" or etree.QName(root).namespace not in (SVG, None):
        raise InputError(f"the root element is <{root.tag}>; expected <svg>")
    return root


def _feed(parser: etree.XMLPullParser, data: bytes) -> etree._Element:
    depth = count = 0
    root: etree._Element | None = None
    for at in range(0, len(data), _CHUNK):
        parser.feed(data[at : at + _CHUNK])
        for event, item in parser.read_events():
            element = cast(etree._Element, item)
            if event == "end":
                depth -= 1
                continue
            root = element if root is None else root
            depth, count = depth + 1, count + 1
            if depth > MAX_DEPTH:
                raise LimitError(_TOO_DEEP, f"line {element.sourceline}")
            if count > MAX_NODES:
                raise LimitError(f"there are more than {MAX_NODES} elements, the limit", f"line {element.sourceline}")
            if len(element.attrib) > MAX_OWN_ATTRIBUTES:
                raise LimitError(
                    f"an element has more than {MAX_OWN_ATTRIBUTES} attributes, the limit", f"line {element.sourceline}"
                )
    parser.close()
    if root is None:
        raise InputError("has no root element; expected <svg>")
    return root


class _PrologEnd(Exception):
    """The root element begins: nothing can be declared any more."""


def _check_prolog(source: Source) -> int:
    """Count the entities that are declared; refuse all but short plain text, before any of them is used.

    Drawing programs declare such names for namespaces. Nested, external and parameter entities serve attacks.
    """
    count = 0

    def declared(
        name: str,
        parameter: bool,
        value: str | None,
        _base: str | None,
        system: str | None,
        public: str | None,
        _notation: str | None,
    ) -> None:
        nonlocal count
        count += 1
        place = f"line {parser.CurrentLineNumber}"
        if parameter or value is None or system is not None or public is not None:
            kind = "a parameter entity" if parameter else "external"
            raise InputError(f"the entity {name[:50]!r} is {kind}; expected plain text only", place)
        if "&" in value or "<" in value or "%" in value:
            raise InputError(f"the entity {name[:50]!r} is nested or holds markup; expected plain text only", place)
        if len(value) > MAX_ENTITY_CHARS:
            raise LimitError(
                f"the entity {name[:50]!r} is longer than the limit of {MAX_ENTITY_CHARS} characters", place
            )
        if count > MAX_ENTITIES:
            raise LimitError(f"more than {MAX_ENTITIES} entities are declared, which is the limit", place)

    def started(*_: object) -> None:
        raise _PrologEnd

    try:
        parser = expat.ParserCreate(source.encoding)
        parser.EntityDeclHandler = declared
        parser.StartElementHandler = started
        parser.EndDoctypeDeclHandler = started
        for at in range(0, len(source.data), _CHUNK):
            parser.Parse(source.data[at : at + _CHUNK], False)
        parser.Parse(b"", True)
    except _PrologEnd:
        pass
    except expat.ExpatError as error:
        raise InputError(f"is not XML: {error}") from None
    except (LookupError, ValueError) as error:
        raise InputError(f"has an encoding that is not known ({error})") from None
    return count
