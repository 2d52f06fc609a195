"""Style sheets: which declarations apply to which element, in what order."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import cssselect2
import tinycss2
from lxml import etree

from optplan.domain.errors import LimitError
from optplan.jobs.svg._report import Report, place_of
from optplan.jobs.svg.limits import MAX_STYLE_CHARS, MAX_STYLE_RULES, MAX_STYLE_STEPS

MAX_SELECTOR_TOKENS = 300
"""tokens of one rule's selectors; no drawing program writes as many"""

_MEDIA = re.compile(r"\s*(?:(?:only\s+)?(?:all|screen))?\s*", re.IGNORECASE)
_CALM = r"[^\"'\\/{}\[\]@!();]*+"
_PLAIN = re.compile(rf"(?:[^\"'\\/{{}}\[\]@!()]++|\({_CALM}\)|'{_CALM}'|\"{_CALM}\")*+")


class Declaration(NamedTuple):
    """One property with its value as text."""

    name: str
    value: str
    important: bool = False


class _Budget:
    """Counts comparisons, so that no combination of rules and elements takes forever."""

    def __init__(self) -> None:
        self.left = MAX_STYLE_STEPS

    def spend(self, steps: int) -> None:
        self.left -= steps
        if self.left < 0:
            raise LimitError(f"the style sheet needs more than {MAX_STYLE_STEPS} comparisons, which is the limit")


class _Node(cssselect2.ElementWrapper):  # type: ignore[misc]
    """An element as the selectors see it; everything that walks over others is charged."""

    budget: _Budget

    def __init__(
        self,
        etree_element: etree._Element,
        parent: _Node | None,
        index: int,
        previous: _Node | None,
        in_html_document: bool,
        content_language: str | None = None,
    ) -> None:
        super().__init__(etree_element, parent, index, previous, in_html_document, content_language)
        if parent is not None:
            self.budget = parent.budget

    @property
    def ancestors(self) -> Iterator[_Node]:
        node = self.parent
        while node is not None:
            self.budget.spend(1)
            yield node
            node = node.parent

    @property
    def previous_siblings(self) -> Iterator[_Node]:
        node = self.previous
        while node is not None:
            self.budget.spend(1)
            yield node
            node = node.previous

    @property
    def etree_siblings(self) -> list[etree._Element]:
        if self.parent is not None:
            self.budget.spend(len(self._siblings))
        return self._siblings

    @etree_siblings.setter
    def etree_siblings(self, siblings: list[etree._Element]) -> None:
        self._siblings = siblings

    def iter_children(self) -> Iterator[_Node]:
        for child in super().iter_children():
            self.budget.spend(1)
            yield child


class _Matcher(cssselect2.Matcher):  # type: ignore[misc]
    @staticmethod
    def add_relevant_selectors(element: _Node, selectors: list[Any], relevant_selectors: list[Any]) -> None:
        element.budget.spend(len(selectors))
        cssselect2.Matcher.add_relevant_selectors(element, selectors, relevant_selectors)


class StyleSheets:
    """All `<style>` elements of a drawing.

    Parameters
    ----------
    root : of the drawing
    report : is told what cannot be used

    Raises
    ------
    LimitError : more rules or characters than the limits
    """

    def __init__(self, root: etree._Element, report: Report) -> None:
        self._report = report
        self._matcher = _Matcher()
        self._count = 0
        self._nodes: dict[etree._Element, _Node] = {}
        self._read(root)
        if self._count:
            self._wrap(root)

    def matching(self, element: etree._Element) -> list[Declaration]:
        """Declarations that apply to `element`, the weakest first (importance not yet counted)."""
        if not self._count:
            return []
        return [
            declaration
            for _, _, pseudo, declarations in self._matcher.match(self._nodes[element])
            if pseudo is None
            for declaration in declarations
        ]

    def _wrap(self, root: etree._Element) -> None:
        node = _Node(root, None, 0, None, False)
        node.budget = _Budget()
        stack = [node]
        while stack:
            node = stack.pop()
            self._nodes[node.etree_element] = node
            # building the tree is not charged: it happens once
            stack.extend(cssselect2.ElementWrapper.iter_children(node))

    def _read(self, root: etree._Element) -> None:
        characters = 0
        for element in root.iter("{*}style"):
            place = place_of(element)
            kind = (element.get("type") or "text/css").strip().lower()
            if kind != "text/css" or not _MEDIA.fullmatch(element.get("media") or ""):
                self._report.add("ignored", "style sheet of another type or for another medium", place)
                continue
            text = "".join(map(str, element.itertext()))
            characters += len(text)
            if characters > MAX_STYLE_CHARS:
                raise LimitError(f"{place}: the style sheets hold more than {MAX_STYLE_CHARS} characters, the limit")
            self._rules(tinycss2.parse_stylesheet(text, skip_comments=True, skip_whitespace=True), place, {})

    def _rules(self, rules: Iterable[Any], place: str, namespaces: dict[str | None, str]) -> None:
        for rule in rules:
            if rule.type == "qualified-rule":
                self._rule(rule, place, namespaces)
            elif rule.type == "at-rule" and rule.lower_at_keyword == "namespace":
                _namespace(rule, namespaces)
            elif (
                rule.type == "at-rule"
                and rule.lower_at_keyword == "media"
                and rule.content is not None
                and _MEDIA.fullmatch(tinycss2.serialize(rule.prelude))
            ):
                inner = tinycss2.parse_rule_list(rule.content, skip_comments=True, skip_whitespace=True)
                self._rules((item for item in inner if item.type != "at-rule"), place, namespaces)
            elif rule.type == "at-rule":
                if rule.lower_at_keyword != "charset":
                    self._report.add("ignored", f"style rule @{rule.at_keyword[:40]}", place)
            else:
                self._report.add("ignored", "style rule that cannot be understood", place)

    def _rule(self, rule: Any, place: str, namespaces: dict[str | None, str]) -> None:
        declarations = _declarations(rule.content)
        if len(rule.prelude) > MAX_SELECTOR_TOKENS:
            self._report.add("ignored", "style rule whose selectors are too long", place)
            return
        try:
            selectors = cssselect2.compile_selector_list(rule.prelude, namespaces)
        except (cssselect2.SelectorError, RecursionError, SyntaxError, MemoryError, ValueError, NotImplementedError):
            self._report.add("ignored", "style rule whose selector cannot be understood", place)
            return
        self._count += len(selectors)
        if self._count > MAX_STYLE_RULES:
            raise LimitError(
                f"{place}: the style sheets have more than {MAX_STYLE_RULES} selectors, which is the limit"
            )
        for selector in selectors:
            self._matcher.add_selector(selector, declarations)


def _namespace(rule: Any, namespaces: dict[str | None, str]) -> None:
    tokens = [token for token in rule.prelude if token.type not in ("whitespace", "comment")]
    prefix = tokens[0].value if len(tokens) == 2 and tokens[0].type == "ident" else None
    if tokens:
        namespaces[prefix] = str(getattr(tokens[-1], "value", ""))


def _declarations(content: Any) -> list[Declaration]:
    return [
        Declaration(item.lower_name, tinycss2.serialize(item.value).strip(), item.important)
        for item in tinycss2.parse_blocks_contents(content, skip_comments=True, skip_whitespace=True)
        if item.type == "declaration"
    ]


def is_plain(text: str) -> bool:
    """Whether a `style` attribute holds nothing that needs a tokenizer, as what drawing programs repeat everywhere."""
    return _PLAIN.fullmatch(text) is not None


def inline_declarations(text: str) -> list[Declaration]:
    """Declarations of a `style` attribute, in order."""
    if not is_plain(text):
        return _declarations(text)
    pairs = (part.partition(":") for part in text.split(";"))
    return [Declaration(name.strip().lower(), value.strip()) for name, colon, value in pairs if colon]
