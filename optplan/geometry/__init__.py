"""Geometry that knows no job and no robot: curves, paths, Dubins words, polygons."""
