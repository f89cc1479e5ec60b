"""What there is to see of a walk: the walk report."""
