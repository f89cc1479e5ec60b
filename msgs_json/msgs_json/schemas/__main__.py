"""Write the JSON Schema files anew: `python -m msgs_json.schemas`."""

from __future__ import annotations

from pathlib import Path

from msgs_json.schemas import PAYLOADS, file_name, schema_text

FOLDER = Path(__file__).parent


def main() -> None:
    """Write one file per payload beside this module."""
    for payload in PAYLOADS:
        file = FOLDER / file_name(payload)
        file.write_text(schema_text(payload))
        print(file)


if __name__ == "__main__":
    main()
