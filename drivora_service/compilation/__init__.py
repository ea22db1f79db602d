"""Compiling the numeric kernels of the step loop to machine code, and keeping it on disk.

The compiler takes half a second to import, so a process has it only after its first call of a
kernel: the modules of oracles and agents are light to import for those that only need their names.
"""

from drivora_service.compilation.kernel import (
    Kernel,
    compiled,
    interpreted_kernels,
    is_compiler_loaded,
    load_compiler,
    specialize,
    worth_loading,
)

__all__ = [
    "Kernel",
    "compiled",
    "interpreted_kernels",
    "is_compiler_loaded",
    "load_compiler",
    "specialize",
    "worth_loading",
]
