"""Make the pictures of the documentation: `.venv/bin/python -m docs.pictures`, or with `convergence` only that one."""

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


def main() -> None:
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


if __name__ == "__main__":
    convergence()
    if sys.argv[1:] != ["convergence"]:
        main()
