"""Make the pictures of the documentation: `.venv/bin/python -m docs.pictures`, or only those that are named."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import optplan as op
from benchmarks.drawings import drawing

FOLDER = Path(__file__).parent / "pictures"
RUNS = (("beam", 30.0), ("auto", 30.0), ("cuts", 60.0))
"""Solvers of the picture of convergence, and the seconds each may take."""
GALLERY = ("shark", "emblem", "mask", "flower", "floral", "letters", "fish", "logo")


def convergence() -> None:
    """What solvers find and prove over time on a random drawing of 60 strokes."""
    for name, _ in RUNS:
        op.solve(drawing(20), name, op.StopRule(seconds=5))  # so that compiling is not in the picture
    runs = [op.solve(drawing(60), name, op.StopRule(seconds=seconds)) for name, seconds in RUNS]
    for run in runs:
        print(f"{run.solver}: {run.cost:.4f}, bound {run.bound:.4f} m, {run.seconds:.1f} s, {run.status.value}")
    title = "60 strokes: metres between them"
    op.draw_convergence(runs, FOLDER / "convergence.png", title=title, overwrite=True, dpi=100)


def square() -> None:
    """Four sides of 1 m one after the other, for a robot that can neither turn on the spot nor jerk its wheels."""
    import matplotlib as mpl
    import numpy as np

    mpl.use("agg")
    from matplotlib import pyplot as plt

    from optplan.geometry.cc import cc_path
    from optplan.geometry.curves import Curve, evaluate

    kappa, sigma = 1.125, 0.5
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=np.float64)
    steps = np.diff(corners, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    sheet, cells = plt.subplots(1, 2, figsize=(10, 5.2), sharex=True, sharey=True)
    families = (("published family", "reference"), ("all words", "full"))
    for cell, (title, family) in zip(cells, families, strict=True):
        total = 4.0
        for k in range(4):
            start = np.array([*corners[k + 1], headings[k], 0.0])
            end = np.array([*corners[k + 1], headings[(k + 1) % 4], 0.0])
            made = cc_path(start, end, kappa, sigma, "full" if family == "full" else "reference")
            curve = Curve(start[:3], made.curvatures, made.sharpnesses, made.lengths)
            total += curve.total
            cell.plot(*evaluate(curve, np.linspace(0, curve.total, 600)).points.T, color="#1f6f8b", lw=1.2)
        cell.plot(*corners.T, color="#8a6a3f", lw=5)
        cell.set_aspect("equal")
        cell.set_title(f"{title}: {total:.1f} m")
        cell.axis("off")
    sheet.tight_layout()
    sheet.savefig(FOLDER / "square.png", dpi=80)


def drawings() -> None:
    """Plan the shipped drawings and draw them."""
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot as plt

    from optplan.plot.picture import figure

    FOLDER.mkdir(exist_ok=True)
    op.draw(op.plan(op.read(op.instance("lion"))), FOLDER / "lion.png", overwrite=True, dpi=100)
    sheet, cells = plt.subplots(2, 4, figsize=(16, 8.6))
    for cell, name in zip(cells.flat, GALLERY, strict=True):
        options = op.Options(order=op.OrderOptions(seconds=10))
        image = io.BytesIO()
        figure(op.plan(op.read(op.instance(name)), options=options)).savefig(image, dpi=110)
        image.seek(0)
        cell.imshow(plt.imread(image))
        cell.axis("off")
    sheet.subplots_adjust(0, 0, 1, 1, 0.01, 0.01)
    sheet.savefig(FOLDER / "gallery.png", dpi=90)
    plotter = op.plan(op.read(op.instance("emblem")), "pen-plotter", op.Options(order=op.OrderOptions(seconds=10)))
    op.draw(plotter, FOLDER / "plotter.png", overwrite=True, dpi=80)


def film() -> None:
    """The beach robot rakes the lion, as its wheels drive the plan."""
    plan = op.plan(op.read(op.instance("lion")))
    op.animate(plan, FOLDER / "lion.gif", drive=op.simulate(plan), fps=12, size=6, overwrite=True)


def field() -> None:
    """A football pitch for the line marker, by time and off wet paint, and the robot marking it."""
    options = op.Options(
        order=op.OrderOptions(seconds=60, avoid=2.0), time=op.TimeOptions(work_speed=1.5, transit_speed=1.9)
    )
    plan = op.plan(op.template("football"), "line-marker", options)
    assert plan.ordering is not None
    print(plan.ordering.cost, plan.ordering.bound, plan.ordering.message)
    op.draw(plan, FOLDER / "field.png", overwrite=True, dpi=90)
    op.animate(plan, FOLDER / "field.gif", fps=12, size=6, overwrite=True)


def facade() -> None:
    """A facade with windows, and a house in space."""
    for name, file in (("windows", "facade.png"), ("house", "house.png")):
        options = op.Options(order=op.OrderOptions(seconds=20))
        plan = op.plan(op.read(op.instance(f"facades/{name}")), "boom-washer", options)
        op.draw(plan, FOLDER / file, overwrite=True, dpi=80, in_space=name == "house")


PICTURES = {
    "facade": facade,
    "convergence": convergence,
    "square": square,
    "drawings": drawings,
    "film": film,
    "field": field,
}

if __name__ == "__main__":
    for picture in sys.argv[1:] or PICTURES:
        PICTURES[picture]()
