"""Run time against true error, of every kernel and of what a user could take instead.

make bench                        out/bench/bench.csv, bench.md, targets.csv, speed.png
make bench ARGS=--quick           fewer settings
make bench ARGS=--readme          also puts the table and the picture into the help
make bench-check                  fails where our time by that of a rival of the same run is above its limit (limits.json)
"""

import os
import sys
from pathlib import Path

if __name__ == "__main__":
    root = Path(__file__).parents[2]
    sys.path[:0] = [str(root / "tests"), str(root)]
    for pool in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(pool, "1")  # one thread for everyone, before numpy is loaded
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from benchmarks import check, measuring

    words = sys.argv[1:]
    sys.exit(check.main(words[1:]) if words[:1] == ["--check"] else measuring.main(words))
