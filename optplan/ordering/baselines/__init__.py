"""Solvers as the literature of the four jobs describes them, plain and named so: what better ones are compared with."""
