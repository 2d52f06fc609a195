"""Compiled kernels of geometry."""
