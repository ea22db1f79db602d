"""CasADi for one agent: the used files of the package, and their import.

The package unpacks to 280 MB, most of it solvers that are not used here; the files below are 25 MB.
"""

from __future__ import annotations

import importlib.util
import sys
import warnings
from pathlib import Path
from types import ModuleType

from drivora_service.agents.package_files import PackageFile
from drivora_service.errors import AgentError

_MODULE = "casadi"

CASADI_FILES = PackageFile(
    package="casadi",
    version="3.8.2",
    file="casadi-3.8.2-cp311-abi3-manylinux_2_28_x86_64.whl",
    sha256="118df1a9ae944a80989849ea5cfa76c20b28e95d6f568c9f989e8c16a66ab1db",
    members={
        f"casadi/{name}": name
        for name in (
            "__init__.py",
            "casadi.py",
            "_casadi.so",
            "libcasadi.so.3.7",
            "libcasadi_nlpsol_fatrop.so",
            "libfatrop.so.1.1.8",
            "libblasfeo.so.0",
        )
    },
)
"""CasADi with the solver FATROP and the linear algebra BLASFEO."""


def load_casadi(folder: Path) -> ModuleType:
    """Imports CasADi from an agent's folder, or returns the one that is loaded already.

    Raises:
        AgentError: If it is missing, or cannot be loaded on this system.
    """
    known = sys.modules.get(_MODULE)
    if known is not None:
        return known
    spec = importlib.util.spec_from_file_location(
        _MODULE, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    if spec is None or spec.loader is None:
        raise _unusable(f"{folder} holds no package")
    module = importlib.util.module_from_spec(spec)
    sys.modules[_MODULE] = module
    try:
        with warnings.catch_warnings():
            # SWIG's generated types lack a module name, about which Python warns from 3.12 on.
            warnings.simplefilter("ignore", DeprecationWarning)
            spec.loader.exec_module(module)
    except (ImportError, OSError) as error:
        for name in [name for name in sys.modules if name.partition(".")[0] == _MODULE]:
            del sys.modules[name]
        raise _unusable(f"{type(error).__name__}: {error}") from error
    return module


def _unusable(why: str) -> AgentError:
    return AgentError(
        f"agent 'nmpc': CasADi cannot be used ({why}); fetch it again with "
        "`drivora agents install nmpc --again`",
        cause="agent_install",
    )
