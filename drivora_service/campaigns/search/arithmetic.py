"""Linear algebra in the processes that search: one thread."""

from __future__ import annotations

import os

_VARIABLES = ("MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def use_one_thread() -> None:
    """Limits linear algebra to one thread in this process, for good.

    For the small arrays of testers, several threads cost more than they bring. They would take the
    cores of the workers, and add in an order that depends on their number. NumPy and SciPy load a
    library each, SciPy when a tester first needs it.
    """
    # Imported here: commands that search nothing do not need it.
    from threadpoolctl import ThreadpoolController

    # For libraries that are loaded later; those that are loaded have read their variables.
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))
    ThreadpoolController().limit(limits=1)
