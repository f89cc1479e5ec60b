"""What is small on the disk and endless in memory is refused within 512 MB.

Each file is read in a process of its own, whose memory is limited.
"""

import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC as MAGIC
from mcap.writer import CompressionType, Writer
from tests.biped_bag.bags import record
from tests.biped_common.test_plain_yaml import ALIAS_BOMB

BOUND_BYTES = 512 * 2**20
TIMEOUT_S = 60
GIGABYTE = 2**30
PIECE = bytes(2**24)
READ = f"""
import resource, sys
from biped_bringup.cli.main import main
resource.setrlimit(resource.RLIMIT_DATA, ({BOUND_BYTES}, {BOUND_BYTES}))
sys.exit(main(sys.argv[1:]))
"""


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a verb of `biped` within its bounds."""
    return subprocess.run(
        [sys.executable, "-c", READ, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )


def zeros_in_zstd(size: int) -> bytes:
    """Zeros, with a frame that tells how many."""
    packer = zstandard.ZstdCompressor().compressobj(size=size)
    data = [packer.compress(PIECE) for _ in range(size // len(PIECE))]
    return b"".join(data) + packer.flush()


def zeros_in_lz4(size: int) -> bytes:
    """Zeros, with a frame that does not tell how many."""
    packer = lz4.frame.LZ4FrameCompressor()
    head = packer.begin()
    data = [packer.compress(PIECE) for _ in range(size // len(PIECE))]
    return head + b"".join(data) + packer.flush()


def write_chunk(file: Path, compression: str, data: bytes, claimed: int) -> None:
    """Write a bag of one chunk, with all the checksums that it should have."""
    name = compression.encode()
    body = struct.pack("<QQQII", 0, 1, claimed, 0, len(name)) + name
    body += struct.pack("<Q", len(data)) + data
    header = struct.pack("<BQ", Opcode.HEADER, 8) + bytes(8)
    chunk = struct.pack("<BQ", Opcode.CHUNK, len(body)) + body
    before = MAGIC + header + chunk
    end = struct.pack("<BQI", Opcode.DATA_END, 4, zlib.crc32(before))
    index = struct.pack("<QQQQIQ", 0, 1, len(MAGIC + header), len(chunk), 0, 0)
    index += (
        struct.pack("<I", len(name)) + name + struct.pack("<QQ", len(data), claimed)
    )
    told = struct.pack("<QHIIIIQQI", 1, 0, 0, 0, 0, 1, 0, 1, 0)
    summary = b"".join(
        struct.pack("<BQ", code, len(record)) + record
        for code, record in ((Opcode.STATISTICS, told), (Opcode.CHUNK_INDEX, index))
    )
    footer = struct.pack("<BQQQ", Opcode.FOOTER, 20, len(before + end), 0)
    crc = struct.pack("<I", zlib.crc32(summary + footer))
    file.write_bytes(before + end + summary + footer + crc + MAGIC)


def written_chunk(compression: str, pack: Callable[[int], bytes]):
    def write(folder: Path) -> None:
        write_chunk(folder / "bomb.mcap", compression, pack(GIGABYTE), claimed=100)

    return write


def many_that_overlap(folder: Path) -> None:
    """1 GB of messages of one moment."""
    with (folder / "bomb.mcap").open("wb") as stream:
        writer = Writer(stream, chunk_size=2**22, compression=CompressionType.ZSTD)
        writer.start()
        schema = writer.register_schema(
            "std_msgs/msg/String", "ros2msg", b"string data"
        )
        channel = writer.register_channel("/zeros", "cdr", schema)
        for _ in range(250):
            writer.add_message(channel, 5, bytes(2**22), 5)
        writer.finish()


def metadata_of_aliases(folder: Path) -> None:
    record(folder / "bomb.mcap", ticks=1)
    (folder / "bomb.mcap" / "metadata.yaml").write_text(ALIAS_BOMB)


def qos_of_aliases(folder: Path) -> None:
    with (folder / "bomb.mcap").open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema(
            "std_msgs/msg/String", "ros2msg", b"string data"
        )
        qos = {"offered_qos_profiles": ALIAS_BOMB.replace("a0:", "-", 1)}
        channel = writer.register_channel("/text", "cdr", schema, qos)
        writer.add_message(channel, 5, b"\0\1\0\0\1\0\0\0\0", 5)
        writer.finish()


def settings_of_aliases(folder: Path) -> None:
    (folder / "bomb.yaml").write_text(ALIAS_BOMB)


CUT = "bag cut bomb.mcap out --start 0"
RECOVER = "bag recover bomb.mcap out"
INFO = "bag info bomb.mcap"
BOMBS = {
    "zstd": (
        written_chunk("zstd", zeros_in_zstd),
        CUT,
        2,
        "a chunk of 1073741824 byte",
    ),
    "zstd, to be mended": (
        written_chunk("zstd", zeros_in_zstd),
        RECOVER,
        1,
        "no message",
    ),
    "lz4": (written_chunk("lz4", zeros_in_lz4), CUT, 2, "33554432 bytes at most"),
    "one moment": (many_that_overlap, CUT, 2, "too many to be put in order"),
    "metadata": (metadata_of_aliases, INFO, 2, "aliases are not read"),
    "metadata, to be mended": (metadata_of_aliases, RECOVER, 0, ""),
    "quality of service": (qos_of_aliases, INFO, 0, ""),
    "settings": (settings_of_aliases, "check --config bomb.yaml", 2, "aliases"),
}


@pytest.mark.parametrize("what", BOMBS)
def test_it_takes_neither_memory_nor_time(tmp_path, what):
    write, words, status, reason = BOMBS[what]
    write(tmp_path)
    done = run(tmp_path, *words.split())
    assert (done.returncode, done.stderr.count("\n")) == (status, int(status > 0))
    assert reason in done.stderr
