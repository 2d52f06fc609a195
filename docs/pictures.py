"""Make the pictures of the documentation: `.venv/bin/python docs/pictures.py`."""

from __future__ import annotations

import io
from pathlib import Path

import optplan as op

FOLDER = Path(__file__).parent / "pictures"
GALLERY = ("shark", "emblem", "mask", "flower", "floral", "letters", "fish", "logo")


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
    main()
