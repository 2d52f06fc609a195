"""Compiled kernels of connectors."""
