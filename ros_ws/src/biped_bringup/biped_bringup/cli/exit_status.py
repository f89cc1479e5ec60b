"""What the commands end with."""

DONE = 0
NOT_ACHIEVED = 1
WRONG_INPUT = 2
NODE_FAILURE = 3
INTERRUPTED = 130
