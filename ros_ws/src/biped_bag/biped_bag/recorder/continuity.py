"""Whether anything was lost: the publishers' own numbering has gaps, or it has none.

Every publisher numbers its messages 1, 2, 3, ... on the wire. A number that is skipped
is a message that was sent and did not reach the recorder, wherever it got lost; the
middleware's own "message lost" event is silent about messages overwritten in the
receiver's queue. What this cannot see: messages lost after the last one received.
"""

from __future__ import annotations


class Continuity:
    """The numbers of one topic; its publishers are told apart by their counts.

    Messages do not say which publisher they are from. A number continues the publisher
    that stands one below it; where there is none, it is the first of another publisher,
    if more of them are known than have been heard, or else a gap.
    """

    def __init__(self) -> None:
        """Start before the first message."""
        self.publishers = 1
        """Publishers ever seen on the topic."""
        self.lost = 0
        """Messages skipped."""
        self.earlier = 0
        """Messages that were sent before the first one received of each publisher."""
        self._last: list[int] = []

    def take(self, number: int) -> None:
        """Take note of a message."""
        last = self._last
        for i, before in enumerate(last):
            if before == number - 1:
                last[i] = number
                return
        below = [before for before in last if before < number]
        if number == 1 or len(last) < self.publishers or not below:
            last.append(number)
            self.earlier += number - 1
        else:
            nearest = max(below)
            self.lost += number - 1 - nearest
            last[last.index(nearest)] = number
