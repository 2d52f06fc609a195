"""What is timed: `make bench` prints each figure, its target, and whether it is met."""
