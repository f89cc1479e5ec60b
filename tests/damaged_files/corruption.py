"""What disks, transfers and people do to files, at random but from a seed."""

import numpy as np

LONGEST_RUN = 700


def corrupted(content: bytes, rng: np.random.Generator) -> bytes:
    """Return a copy that differs in one or two ways."""
    changed = content
    for _ in range(rng.integers(1, 3)):
        kind = KINDS[rng.integers(len(KINDS))]
        changed = kind(changed, rng)
    return changed


def _stretch(content: bytes, rng: np.random.Generator) -> tuple[int, int]:
    begin = int(rng.integers(len(content) + 1))
    return begin, min(len(content), begin + int(rng.integers(1, LONGEST_RUN)))


def _flip(content: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(content)
    for _ in range(rng.integers(1, 4)):
        if changed:
            changed[rng.integers(len(changed))] ^= 1 << rng.integers(8)
    return bytes(changed)


def _cut_off(content: bytes, rng: np.random.Generator) -> bytes:
    return content[: rng.integers(len(content) + 1)]


def _leave_out(content: bytes, rng: np.random.Generator) -> bytes:
    begin, end = _stretch(content, rng)
    return content[:begin] + content[end:]


def _blank(content: bytes, rng: np.random.Generator) -> bytes:
    begin, end = _stretch(content, rng)
    return content[:begin] + bytes(end - begin) + content[end:]


def _overwrite(content: bytes, rng: np.random.Generator) -> bytes:
    begin, end = _stretch(content, rng)
    return content[:begin] + rng.bytes(end - begin) + content[end:]


def _insert(content: bytes, rng: np.random.Generator) -> bytes:
    begin, end = _stretch(content, rng)
    return content[:begin] + rng.bytes(end - begin) + content[begin:]


def _repeat(content: bytes, rng: np.random.Generator) -> bytes:
    """Write a stretch, maybe a long one, a second time: behind it or elsewhere."""
    begin, end = _stretch(content, rng)
    if rng.integers(2):
        end = int(rng.integers(begin, len(content) + 1))
    place = end if rng.integers(2) else int(rng.integers(len(content) + 1))
    return content[:place] + content[begin:end] + content[place:]


def _copy_over(content: bytes, rng: np.random.Generator) -> bytes:
    begin, end = _stretch(content, rng)
    place = int(rng.integers(len(content) + 1))
    return content[:place] + content[begin:end] + content[place + end - begin :]


def _swap(content: bytes, rng: np.random.Generator) -> bytes:
    a, b, c = sorted(int(place) for place in rng.integers(len(content) + 1, size=3))
    return content[:a] + content[b:c] + content[a:b] + content[c:]


KINDS = (
    _flip,
    _cut_off,
    _leave_out,
    _blank,
    _overwrite,
    _insert,
    _repeat,
    _copy_over,
    _swap,
)
