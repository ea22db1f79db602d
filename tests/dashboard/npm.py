"""npm with the Node that the package's build uses, in the page's sources: ``python -m …``.

Passes its arguments to npm. Its programs find the Python that started it in ``DRIVORA_PYTHON``.
"""

from __future__ import annotations

import subprocess
import sys

from drivora_service.dashboard.build import npm_command
from tests.dashboard.write_types import WEB


def main(arguments: list[str]) -> int:
    """Runs npm, and returns its exit code."""
    command, environment = npm_command(*arguments)
    environment["DRIVORA_PYTHON"] = sys.executable
    code = subprocess.run(command, cwd=WEB, env=environment, check=False).returncode
    if code and arguments[:1] == ["ci"]:
        print(
            "The page's development tools could not be installed. They come from the npm registry "
            "(or npm's cache); NPM_CONFIG_REGISTRY names another registry.",
            file=sys.stderr,
        )
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
