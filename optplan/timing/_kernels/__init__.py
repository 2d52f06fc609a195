"""Compiled kernels of timing."""
