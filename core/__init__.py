"""KINDYNA core: cam motion, linkage, shape, dynamics. Never imports Qt."""

import os

# The matrices are small and come in batches, so that threads of BLAS would mostly wait for each other. BLAS reads this once,
# when numpy is first imported; a value that the user has set stays.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

__version__ = "0.1.0"
