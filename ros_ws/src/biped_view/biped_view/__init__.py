"""The live page and the walk report: what there is to see of a walk."""
