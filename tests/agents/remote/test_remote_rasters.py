"""Images of ADSs in processes of their own: as in process, and requested in time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from drivora_service.agents.interface import Observation
from drivora_service.agents.log import AgentLog
from drivora_service.agents.raster.raster_settings import Channel, RasterSettings
from drivora_service.agents.remote import agent_pb2 as pb
from drivora_service.agents.remote.adapter_messages import (
    context_view,
    observation_view,
    raster_request,
)
from drivora_service.agents.remote.protocol import MAX_RASTERS
from drivora_service.agents.remote.remote_messages import (
    requested_rasters,
    setup_request,
    step_request,
)
from drivora_service.agents.remote.requested_rasters import RequestedRasters
from drivora_service.errors import AgentError
from tests.agents.raster.scenes import context_on, on_route, seen_from
from tests.simulation.episodes import network

WANTED = (
    RasterSettings(),
    RasterSettings(
        height=60,
        width=90,
        metres_per_pixel=0.7,
        ego_from_top=0.4,
        ego_from_left=0.9,
        channels=(Channel.EGO, Channel.ROUTE, Channel.WALKERS),
        history=(0.25, 2.0),
    ),
)
ALL = [channel.label for channel in Channel]


def over_the_wire(step: int, observation: Observation, images: list[bytes]) -> pb.StepRequest:
    observation.step = step
    return pb.StepRequest.FromString(step_request(observation, "r", images).SerializeToString())


def test_images_arrive_as_they_are_drawn_in_process() -> None:
    context = context_on(network("roundabout"))
    request = pb.SetupRequest.FromString(setup_request(context, "r").SerializeToString())
    received = RequestedRasters(request.raster_channels)
    view = context_view(request, AgentLog(), received)
    there = [view.raster(settings) for settings in WANTED]
    reply = pb.SetupReply(rasters=map(raster_request, received.close()))
    asked = requested_rasters(pb.SetupReply.FromString(reply.SerializeToString()))
    assert asked == WANTED
    here = [context.raster(settings) for settings in WANTED]
    for step, s in enumerate((10.0, 50.0, 90.0)):
        observation = seen_from(*on_route(context.route, s), route_s=s, time=0.25 * step)
        images = [raster.draw(observation) for raster in here]
        message = over_the_wire(step, observation, [image.tobytes() for image in images])
        received.receive(message.step, message.rasters)
        seen = observation_view(message)
        for raster, image in zip(there, images, strict=True):
            found = raster.draw(seen)
            assert np.array_equal(found, image)
            assert found.flags.writeable
            out = np.zeros_like(found)
            assert raster.draw(seen, out) is out
            assert np.array_equal(out, image)


def test_a_drivora_that_draws_nothing_is_reported_at_the_request() -> None:
    request = pb.SetupRequest(run="r")
    view = context_view(request, AgentLog())
    with pytest.raises(AgentError, match=r"cannot draw drivable, .*; it draws: no rasters at all"):
        view.raster()
    some = context_view(pb.SetupRequest(raster_channels=["ego", "route"]), AgentLog())
    some.raster(RasterSettings(channels=(Channel.EGO,)))
    with pytest.raises(AgentError, match="cannot draw red; it draws: ego, route"):
        some.raster(RasterSettings(channels=(Channel.RED, Channel.ROUTE)))


def test_requests_are_made_in_setup_and_few() -> None:
    rasters = RequestedRasters(ALL)
    for _ in range(MAX_RASTERS):
        rasters.request(RasterSettings())
    with pytest.raises(AgentError, match="more than 4 rasters"):
        rasters.request(RasterSettings())
    rasters.close()
    with pytest.raises(AgentError, match="after setup_env"):
        rasters.request(RasterSettings())


@pytest.mark.parametrize(
    ("step", "images", "message"),
    [
        (6, [b"\0" * 3], "no image of step 7: Drivora sends those of the current step, which is 6"),
        (7, [], "Drivora sent 0 images; needed: 1"),
        (7, [b"\0" * 3], r"an image of 3 bytes; needed: \(1, 2, 2\)"),
    ],
)
def test_images_of_other_steps_and_sizes_are_refused(
    step: int, images: list[bytes], message: str
) -> None:
    rasters = RequestedRasters(ALL)
    raster = rasters.request(RasterSettings(height=2, width=2, channels=(Channel.EGO,)))
    rasters.receive(step, images)
    observation = seen_from(0.0, 0.0, 0.0, step=7)
    with pytest.raises(AgentError, match=message):
        raster.draw(observation)


def spoilt(change: Callable[[pb.RasterRequest], object], count: int = 1) -> pb.SetupReply:
    request = raster_request(RasterSettings())
    change(request)
    return pb.SetupReply(rasters=[request] * count)


@pytest.mark.parametrize(
    ("reply", "message"),
    [
        (spoilt(lambda r: r.channels.append("lidar")), "the channel 'lidar'; allowed: drivable, "),
        (spoilt(lambda r: r.channels.append("ego")), "each once"),
        (spoilt(lambda r: r.history.append(-1.0)), "cannot be drawn: .*history"),
        (spoilt(lambda r: r.ClearField("width")), "width is 0; allowed: 1 to 1024"),
        (spoilt(lambda r: None, 5), "requests 5 rasters; allowed: at most 4"),
    ],
)
def test_requests_that_cannot_be_drawn_are_the_fault_of_the_ads(
    reply: pb.SetupReply, message: str
) -> None:
    with pytest.raises(AgentError, match=message) as caught:
        requested_rasters(reply)
    assert caught.value.cause == "agent_invalid_control"
