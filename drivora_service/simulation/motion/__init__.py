"""The kernels that move egos and advance a step."""
