"""Clothoids, paths, polygons: geometry that knows no job and no robot."""
