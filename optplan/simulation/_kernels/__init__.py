"""What is compiled of the simulation."""
