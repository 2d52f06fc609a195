"""Curves, paths and polygons; knows no job and no robot."""
