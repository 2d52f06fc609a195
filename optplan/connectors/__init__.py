"""Movements between strokes, and the whole path."""
