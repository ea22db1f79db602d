"""Errors of files and folders that a command met where no code expects them."""

from __future__ import annotations

import errno

_ADVICE = {
    errno.ENOSPC: "free space there, or name another place",
    errno.EDQUOT: "free space there, or name another place",
    errno.EROFS: "name another place",
    errno.EACCES: "name another place, or have its owner allow it",
    errno.EPERM: "name another place, or have its owner allow it",
    errno.EISDIR: "name a file",
    errno.ENOTDIR: "name another place",
    errno.ENOENT: "name one that exists",
}
"""What helps with faults that users can mend."""


def describe_file_error(error: OSError) -> str:
    """Returns the message for a file that cannot be used; "" if the error is of another kind."""
    advice = _ADVICE.get(error.errno or 0, "")
    if not advice:
        return ""
    # Writing to a file that is open does not say which one it is.
    place = f"{error.filename} cannot be used" if error.filename else "a file cannot be written"
    return f"{place}: {error.strerror}; {advice}"
