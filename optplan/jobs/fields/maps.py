"""Occupancy maps, as mobile robots keep them: a picture of what is in the way, and a YAML file that says where."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_PIXELS = 50_000_000
"""Of a map."""
MAX_OBSTACLES = 500
"""Polygons that one map may give."""
MAX_RUNS = 100_000
"""Rows of occupied pixels side by side in a map: uniting so many takes seconds."""


def obstacles(file: Path) -> tuple[FloatArray, ...]:
    """Polygons (n, 2) m around what a map of the ROS map server calls occupied, in its frame.

    A pixel is occupied when its darkness is above `occupied_thresh` (brightness, with `negate`); what is unknown is no
    obstacle. Outlines are simplified by half a pixel at most, outwards. What is free inside a wall stays free: a ring
    is cut into polygons without holes.

    Raises
    ------
    InputError : a file that is no such map, or a map with more than `MAX_OBSTACLES` obstacles or `MAX_RUNS` runs
    """
    from PIL import Image, UnidentifiedImageError

    entries = _entries(file)
    picture = file.parent / entries["image"]
    try:
        with Image.open(picture) as image:
            if image.width * image.height > MAX_PIXELS:
                size = f"{image.width} x {image.height}"
                raise LimitError(f"has {size} pixels; expected at most {MAX_PIXELS}", str(picture))
            bright = _brightness(image, str(picture))
    except (OSError, UnidentifiedImageError, Image.DecompressionBombError) as error:
        raise InputError(f"is no picture of a map: {error}", str(picture)) from None
    shade = bright if entries["negate"] else 1 - bright
    occupied = shade > entries["occupied_thresh"]
    return _polygons(occupied, entries["resolution"], entries["origin"], str(file))


def _brightness(image: Image, where: str) -> FloatArray:
    """(rows, columns) 0 for black, 1 for white. Pillow cuts 16 bits off at 255 instead of scaling them."""
    if image.mode == "I" or image.mode.startswith("I;16"):
        values = np.asarray(image, dtype=np.float64)
        if values.size and not 0 <= values.min() <= values.max() <= 65535:
            raise InputError("has pixels of more than 16 bits; expected 8 or 16", where)
        return values / 65535
    if image.mode == "F":
        raise InputError("has pixels that are real numbers; expected 8 or 16 bits", where)
    return np.asarray(image.convert("L"), dtype=np.float64) / 255


def _entries(file: Path) -> dict[str, Any]:
    from optplan.schema.files import read_text

    try:
        import yaml
    except ImportError:
        raise InputError("maps need PyYAML: install optplan[geo]", str(file)) from None
    try:
        found = yaml.safe_load(read_text(file))
    except yaml.YAMLError as error:
        raise InputError(f"is not YAML: {' '.join(str(error).split())}", str(file)) from None
    if not isinstance(found, dict) or "image" not in found:
        raise InputError("is no map; expected image, resolution and origin", str(file))
    if not isinstance(found["image"], str):
        raise InputError("its image is no name of a file; expected one, such as map.pgm", str(file))
    made: dict[str, Any] = {"image": found["image"]}
    try:
        made["resolution"] = float(found["resolution"])
        made["origin"] = [float(value) for value in found["origin"]]
        made["negate"] = bool(int(found.get("negate", 0)))
        made["occupied_thresh"] = float(found.get("occupied_thresh", 0.65))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"is no map: {error}; expected resolution, origin [x, y, yaw] and numbers", str(file)
        ) from None
    good = made["resolution"] > 0 and len(made["origin"]) in (2, 3)
    if not (good and all(map(math.isfinite, (made["resolution"], *made["origin"])))):
        raise InputError(
            "resolution or origin are out of range; expected metres a pixel above 0, and a pose", str(file)
        )
    if not 0 <= made["occupied_thresh"] <= 1:
        raise InputError(f"occupied_thresh is {made['occupied_thresh']:g}; expected 0..1", str(file))
    return made


def _polygons(occupied: Any, resolution: float, origin: list[float], where: str) -> tuple[FloatArray, ...]:
    import shapely

    rows, columns = np.nonzero(occupied)
    if len(rows) == 0:
        return ()
    # runs of pixels in a row become boxes: fewer shapes to unite
    breaks = np.flatnonzero((np.diff(rows) != 0) | (np.diff(columns) != 1))
    first, last = np.append(0, breaks + 1), np.append(breaks, len(rows) - 1)
    if len(first) > MAX_RUNS:
        raise LimitError(
            f"its occupied pixels are {len(first)} runs; expected at most {MAX_RUNS}: a coarser map, or no noise",
            where,
        )
    height = occupied.shape[0]
    low = height - 1 - rows[first]
    boxes = shapely.box(columns[first], low, columns[last] + 1, low + 1)
    whole = shapely.union_all(boxes).buffer(0.5, join_style="mitre").simplify(0.5)
    parts: list[Any] = []
    todo = shapely.get_parts(whole).tolist()
    while todo:
        part = todo.pop()
        if len(parts) + len(todo) >= MAX_OBSTACLES:
            raise LimitError(f"holds more than {MAX_OBSTACLES} obstacles; expected fewer: a coarser map", where)
        if len(part.interiors):
            todo += _halves(part)
        else:
            parts.append(part)
    yaw = origin[2] if len(origin) == 3 else 0.0
    turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
    return tuple(resolution * np.array(part.exterior.coords)[:-1] @ turn + np.array(origin[:2]) for part in parts)


def _halves(polygon: Any) -> list[Any]:
    """A polygon with holes, cut upright through the middle one: that is no hole any more."""
    import shapely

    low_x, low_y, high_x, high_y = polygon.bounds
    middles = sorted(sum(hole.bounds[::2]) / 2 for hole in polygon.interiors)
    cut = middles[len(middles) // 2]
    sides = [shapely.box(low_x, low_y, cut, high_y), shapely.box(cut, low_y, high_x, high_y)]
    found = shapely.get_parts(shapely.intersection(polygon, sides)).tolist()
    return [part for part in found if part.geom_type == "Polygon" and part.area > 0]
