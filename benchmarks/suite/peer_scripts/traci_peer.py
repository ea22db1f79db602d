"""SUMO over a socket: one round for every line of the input.

The argument is a file of JSON with SUMO's arguments and the calls of a run, a list for each step.
They are those that a run within one process makes. Each round answers with a line of JSON; starting
SUMO is not timed.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

import sumo
import traci

_TICKS = os.sysconf("SC_CLK_TCK")


def processor_time(pid: int) -> float:
    """Returns the processor seconds of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS


def main() -> None:
    """Answers every line of the input."""
    # TraCI prints while it connects; the answers have the output for themselves.
    answers, sys.stdout = sys.stdout, sys.stderr
    taped = json.loads(Path(sys.argv[1]).read_text())
    program = str(Path(sumo.SUMO_HOME) / "bin" / "sumo")
    for _ in sys.stdin:
        traci.start([program, *taped["arguments"]], stdout=sys.stderr)
        connection = traci.getConnection()
        server = connection._process.pid
        begun = time.process_time() + processor_time(server)
        for calls in taped["steps"]:
            for domain, name, args, kwargs in calls:
                getattr(getattr(connection, domain), name)(*args, **kwargs)
            connection.simulationStep()
        needed = time.process_time() + processor_time(server) - begun
        traci.close()
        answer = {
            "simulated": taped["step_length"] * len(taped["steps"]),
            "needed": needed,
            "vehicles": taped["vehicles"],
        }
        print(json.dumps(answer), file=answers, flush=True)


main()
