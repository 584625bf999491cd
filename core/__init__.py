"""KINDYNA core: cam motion, linkage, shape, dynamics. Never imports Qt."""

import os

# Matrices are small here and come in batches: BLAS would spend its threads waiting for each other. It reads this once,
# when numpy is first imported; whoever has set it otherwise is left alone.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

__version__ = "0.1.0"
