"""Compiled inner loops of the ordering solvers: arrays in, arrays out. Import only inside functions: numba is heavy."""
