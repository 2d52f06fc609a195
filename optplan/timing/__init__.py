"""Speed profiles."""
