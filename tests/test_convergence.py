"""Pictures of runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from optplan.domain.errors import InputError
from optplan.domain.stop import StopRule
from optplan.ordering import solve
from optplan.plot import draw_convergence
from optplan.plot.convergence import convergence_figure
from optplan.plot.picture import _labels
from tests.ordering_cases import strokes


def test_curves_end_at_what_was_found_and_proved() -> None:
    answers = [solve(strokes(9), name, StopRule(seconds=5)) for name in ("nn", "brute")]
    axes = convergence_figure(answers, "nine").axes[0]
    ends = [float(line.get_ydata()[-1]) for line in axes.lines]  # type: ignore[index,arg-type,unused-ignore]
    assert ends == pytest.approx([answers[0].cost, answers[1].cost, answers[1].bound])
    assert axes.get_title() == "nine"
    low, high = axes.get_ylim()
    assert low < min(ends)
    assert high > max(ends)
    texts = [text.get_text() for text in axes.get_legend().get_texts()]  # type: ignore[union-attr]
    assert any(text.startswith("brute") and "gap 0.00 %" in text for text in texts)


def test_pictures_are_written(tmp_path: Path) -> None:
    answer = solve(strokes(6), "brute")
    for name in ("a.png", "a.svg", "a.pdf"):
        draw_convergence(answer, tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    with pytest.raises(InputError, match="exists"):
        draw_convergence([answer], tmp_path / "a.png")
    with pytest.raises(InputError, match="ending"):
        draw_convergence(answer, tmp_path / "a.gif")


def test_nothing_to_draw(tmp_path: Path) -> None:
    problem = strokes(3)
    unknown = solve(problem, "brute", StopRule(cancelled=lambda: True))
    if not len(unknown.nodes) and not np.isfinite(unknown.bound):
        with pytest.raises(InputError, match="nothing to draw"):
            draw_convergence(unknown, tmp_path / "a.png")


def test_numbers_at_one_place_share_a_label() -> None:
    places = np.array([[0.0, 0.0], [40.0, 0.0], [2.0, 3.0], [0.0, 20.0], [41.0, 1.0]])
    assert [text for text, _ in _labels(places)] == ["1, 3", "2, 5", "4"]
