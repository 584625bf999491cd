"""Command line: ``python -m kindyna COMMAND ...``, without images."""

from __future__ import annotations

import sys

from core.__main__ import main

if __name__ == "__main__":
    sys.exit(main(program="python -m kindyna"))
