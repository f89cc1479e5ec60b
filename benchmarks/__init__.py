"""Speed and memory, with the bounds that the project promises."""
