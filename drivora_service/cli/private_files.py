"""Files that only their owner may read."""

from __future__ import annotations

import os


def keep_files_private() -> None:
    """Makes every file that this process and its children create from now on private.

    Files get mode 0600 and folders 0700: what a data folder holds, scenarios, results, logs and
    hashes of tokens, is of no concern to the other users of a machine. Called before the first
    child is started.
    """
    os.umask(0o077)
