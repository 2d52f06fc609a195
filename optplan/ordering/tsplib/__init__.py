"""Files of the travelling-salesman libraries: TSPLIB, SOPLIB, GTSPLIB, PCGTSPLIB, and tours."""

from __future__ import annotations

from optplan.ordering.tsplib.instance import Instance
from optplan.ordering.tsplib.reading import SUFFIXES, read_tsplib
from optplan.ordering.tsplib.tours import read_tour, tour_text, write_tour
from optplan.ordering.tsplib.writing import instance_of, instance_text, write_tsplib

__all__ = [
    "SUFFIXES",
    "Instance",
    "instance_of",
    "instance_text",
    "read_tour",
    "read_tsplib",
    "tour_text",
    "write_tour",
    "write_tsplib",
]
