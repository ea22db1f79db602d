"""The driver in a process of its own, which Drivora starts as ``agent.yaml`` says."""

from __future__ import annotations

from image_driver import ImageDriver

from drivora_service.agents.remote.serving import serve

if __name__ == "__main__":
    serve(ImageDriver, name="image-agent")
