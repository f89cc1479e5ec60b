"""How large what comes over the graph may be; enough for anything that makes sense.

Whatever is larger is refused before it is built, so that no message costs more than a
little memory or ends in a number that the rest of the program cannot hold.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

MOST_CHARACTERS = 100_000
"""Of a whole JSON text; the longest payload of ours has about 2,000."""

MOST_TICKS = 10**12
"""Control ticks: 63 years, and their stamp still fits into 32-bit seconds."""
Count = Annotated[int, Meta(ge=0, le=MOST_TICKS)]
Seed = Annotated[int, Meta(ge=0, le=2**63 - 1)]
Name = Annotated[str, Meta(max_length=200)]
Digest = Annotated[str, Meta(max_length=64)]
"""A SHA-256 in hexadecimal digits, or nothing."""
