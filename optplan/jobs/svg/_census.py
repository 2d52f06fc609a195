"""One walk over the whole file: ids for everything, and a list of what is never drawn."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

from lxml import etree

from optplan.jobs.svg._report import Report, local_name
from optplan.jobs.svg._tree import SVG

XLINK = "http://www.w3.org/1999/xlink"
INKSCAPE = "http://www.inkscape.org/namespaces/inkscape"
_HOME = frozenset({"", SVG})
_KNOWN_ATTRIBUTES = frozenset({"", SVG, XLINK, "http://www.w3.org/XML/1998/namespace"})
_LAYERS = frozenset({f"{{{INKSCAPE}}}label", f"{{{INKSCAPE}}}groupmode"})
_ANIMATION = frozenset({"animate", "animateColor", "animateMotion", "animateTransform", "set", "discard"})
_WORDS = frozenset({"title", "desc", "metadata"})


class Census(NamedTuple):
    """What the walk found.

    Parameters
    ----------
    ids : for every SVG element, unique and the same each time the file is read
    targets : the element that a reference to an id means
    """

    ids: dict[etree._Element, str]
    targets: dict[str, etree._Element]


def namespace_of(name: str) -> str:
    """The namespace of a tag or attribute, "" for none."""
    return name[1:].partition("}")[0] if name.startswith("{") else ""


def is_element(node: object) -> bool:
    """Whether it is an element; comments and processing instructions have no tag that is text."""
    return isinstance(getattr(node, "tag", None), str)


def is_svg(element: etree._Element) -> bool:
    """Whether it is an SVG element, not a comment or of another namespace."""
    return is_element(element) and namespace_of(str(element.tag)) in _HOME


def take_census(root: etree._Element, report: Report) -> Census:
    """Name every element; tell `report` about other namespaces, scripts, animations and remarks."""
    targets: dict[str, etree._Element] = {}
    foreign: Counter[str] = Counter()
    others: Counter[str] = Counter()
    elements: list[etree._Element] = []
    for element in root.iter():
        if not is_element(element):
            if isinstance(element, etree._ProcessingInstruction):
                others["processing instruction"] += 1
            continue
        _count(element, foreign, others)
        id = element.get("id")
        if id:
            targets.setdefault(id, element)
        if is_svg(element):
            elements.append(element)
    for sibling in root.itersiblings(preceding=True):
        others["processing instruction"] += isinstance(sibling, etree._ProcessingInstruction)
    for namespace, times in foreign.items():
        report.add("ignored", f"elements and attributes of the namespace {namespace}", times=times)
    for text, times in others.items():
        if times:
            report.add("ignored", text, times=times)
    return Census(_ids(elements, targets), targets)


def _count(element: etree._Element, foreign: Counter[str], others: Counter[str]) -> None:
    tag = str(element.tag)
    namespace = namespace_of(tag)
    if namespace not in _HOME:
        foreign[namespace] += 1
    name = local_name(element)
    if namespace in _HOME:
        if name == "script":
            others["script"] += 1
        elif name in _ANIMATION:
            others["animation: drawn as it is without"] += 1
        elif name in _WORDS:
            others["title, description or metadata"] += 1
    for key in element.attrib:
        attribute = str(key)
        if attribute.startswith("{"):
            home = namespace_of(attribute)
            if home not in _KNOWN_ATTRIBUTES and attribute not in _LAYERS:
                foreign[home] += 1
        elif attribute.startswith("on"):
            others["script in an attribute"] += 1


def _ids(elements: list[etree._Element], targets: dict[str, etree._Element]) -> dict[etree._Element, str]:
    ids: dict[etree._Element, str] = {}
    taken = set(targets)
    running: Counter[str] = Counter()
    for element in elements:
        kind = local_name(element)
        running[kind] += 1
        own = element.get("id")
        if own and targets[own] is element:
            ids[element] = own
        else:
            ids[element] = unique(own or f"{kind}{running[kind]}", taken)
            taken.add(ids[element])
    return ids


def unique(wish: str, taken: set[str]) -> str:
    """`wish`, with a number behind it when it is taken."""
    if wish not in taken:
        return wish
    number = 2
    while f"{wish}-{number}" in taken:
        number += 1
    return f"{wish}-{number}"
