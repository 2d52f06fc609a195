"""The mathematics of optplan: one optimisation model a module, numbers in and out."""
