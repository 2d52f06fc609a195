"""Models of the ordering problem: a path through one node of each cluster."""
