#!/usr/bin/env python3
"""Start the graph: the same as `biped up`, with the same options."""

import sys

from biped_bringup.cli.main import main

if __name__ == "__main__":
    sys.exit(main(["up", *sys.argv[1:]]))
