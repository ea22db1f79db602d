"""An ADS that does what its argument says; run in a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import grpc

from drivora_service.agents.interface import (
    AccelerationControl,
    Control,
    Observation,
    PedalControl,
    PoseControl,
    TrajectoryControl,
)
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote import serving
from drivora_service.agents.remote.protocol import ADDRESS_VARIABLE, VERSION
from drivora_service.agents.remote.views import ContextView

FAULT_STEP = 10


class Ads:
    """Drives straight on until ``FAULT_STEP``; then does what it is told."""

    def __init__(self, what: str) -> None:
        print(f"ready to do: {what}", flush=True)
        self.what = what

    def setup_env(self, context: ContextView) -> None:
        self.context = context
        context.log.declare("time", "seldom")
        context.log.event(f"set up for {context.ego_id}")
        if self.what == "setup-raises":
            raise ValueError("no way in setup")
        if self.what == "setup-hangs":
            time.sleep(3600)

    def run_step(self, observation: Observation) -> Control:
        self.context.log.row[0] = observation.time
        if observation.step >= FAULT_STEP:
            self.context.log.row[1] = 1.0
            self.context.log.event("acts")
            return self.act()
        return AccelerationControl(1.0, 0.0)

    def act(self) -> Control:
        match self.what:
            case "dies" | "is-killed":
                print("about to be killed", flush=True)
                os.kill(os.getpid(), signal.SIGSEGV if self.what == "dies" else signal.SIGKILL)
            case "exits":
                os._exit(3)
            case "hangs":
                print("about to hang", flush=True)
                time.sleep(3600)
            case "hangs-with-a-child":
                subprocess.Popen([sys.executable, "-c", "import time; time.sleep(3600)"])
                time.sleep(3600)
            case "raises":
                raise KeyError("lost the way")
            case "raises-in-chinese":
                raise ValueError("路" * 2000 + os.fsdecode(b"\xff"))
            case "answers-nothing":
                return None  # type: ignore[return-value] # what authors do
            case "answers-nan":
                return AccelerationControl(float("nan"), 0.0)
            case "pedals":
                return PedalControl(0.5, 0.0, 0.0)
            case "pose":
                return PoseControl(*self.place(0.1), 3.0)
            case "trajectory":
                x, y, _ = self.place(0.1)
                x2, y2, _ = self.place(5.0)
                return TrajectoryControl([[0.05, x, y, 3.0], [1.0, x2, y2, 3.0]])  # type: ignore[arg-type] # as authors write it
            case "plans":
                self.context.log.plan([self.place(s)[:2] for s in (0.0, 5.0, 9.0)])
            case "floods":
                print("x" * 3_000_000, flush=True)
                print("last words", flush=True)
                os._exit(3)
        return AccelerationControl(1.0, 0.0)

    def place(self, s: float) -> tuple[float, float, float]:
        x, y = self.context.route.line[int(s)]
        return float(x), float(y), 0.0


class Garbled(grpc.GenericRpcHandler):
    """Answers the protocol's calls with bytes of its own choice."""

    def __init__(self, answers: dict[str, bytes]) -> None:
        self.answers = answers

    def service(self, details: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler[Any, Any] | None:
        answer = self.answers.get(str(details.method).rpartition("/")[2])
        if answer is None:
            return None
        return grpc.unary_unary_rpc_method_handler(lambda request, context: answer)


def serve_answers(answers: dict[str, bytes]) -> None:
    server = grpc.server(ThreadPoolExecutor(1), handlers=[Garbled(answers)])
    server.add_insecure_port(os.environ[ADDRESS_VARIABLE])
    server.start()
    server.wait_for_termination()


def main(what: str) -> None:
    described = pb.Description(protocol=VERSION).SerializeToString()
    match what:
        case "does-not-start":
            sys.exit("cannot find my weights")
        case "never-answers":
            print("dreaming", flush=True)
            time.sleep(3600)
        case "old-protocol":
            serve_answers({"Describe": pb.Description(protocol=VERSION + 1).SerializeToString()})
        case "garbled-description":
            serve_answers({"Describe": b"\xff\xff\xff"})
        case "garbled-step":
            serve_answers({"Describe": described, "SetupEnv": b"", "RunStep": b"\xff\xff\xff"})
        case "undeclared-value":
            reply = pb.StepReply(values={"surprise": 1.0})
            reply.acceleration.acceleration = 1.0
            serve_answers(
                {"Describe": described, "SetupEnv": b"", "RunStep": reply.SerializeToString()}
            )
        case "half-a-point":
            reply = pb.StepReply(plan=[1.0, 2.0, 3.0])
            reply.acceleration.acceleration = 1.0
            serve_answers(
                {"Describe": described, "SetupEnv": b"", "RunStep": reply.SerializeToString()}
            )
        case "declares-twice":
            answer = pb.SetupReply(log_names=["speed", "speed"]).SerializeToString()
            serve_answers({"Describe": described, "SetupEnv": answer})
        case "declares-too-much":
            answer = pb.SetupReply(log_names=map(str, range(1001))).SerializeToString()
            serve_answers({"Describe": described, "SetupEnv": answer})
        case "talks-too-much":
            talk = pb.StepReply(text="x\n" * 1_000_000)
            talk.acceleration.acceleration = 1.0
            serve_answers(
                {"Describe": described, "SetupEnv": b"", "RunStep": talk.SerializeToString()}
            )
        case "offers-nothing":
            serve_answers({})
        case "offers-no-step":
            serve_answers({"Describe": described, "SetupEnv": b""})
        case _:
            serving.serve(lambda: Ads(what))


if __name__ == "__main__":
    main(sys.argv[1])
