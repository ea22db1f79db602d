"""The models and the names by which documents may call them."""

from __future__ import annotations

import math

import pytest

from drivora_service.errors import UnknownName
from drivora_service.scenario.models.actor_models import (
    ActorKind,
    VehicleClass,
    actor_model,
    model_names,
    resize_model,
)


@pytest.mark.parametrize(
    "name",
    [
        "vehicle.lincoln.mkz_2017",
        "vehicle.lincoln.mkz2017",
        "lincoln.mkz2017",
        "mkz_2017",
        "Vehicle.Lincoln.MKZ-2017",
    ],
)
def test_spellings_of_a_vehicle(name: str) -> None:
    model = actor_model(ActorKind.VEHICLE, name)
    assert model.name == "vehicle.lincoln.mkz_2017"
    assert (model.length, model.width) == (4.90, 2.13)


def test_names_of_other_carla_versions() -> None:
    assert actor_model(ActorKind.VEHICLE, "vehicle.mustang.mustang").name == "vehicle.ford.mustang"
    assert actor_model(ActorKind.VEHICLE, "vehicle.lincoln.mkz").name == "vehicle.lincoln.mkz_2020"


def test_spellings_of_walkers_and_obstacles() -> None:
    assert actor_model(ActorKind.WALKER, "0009").name == "walker.pedestrian.0009"
    cone = actor_model(ActorKind.OBSTACLE, "trafficcone01")
    assert cone == actor_model(ActorKind.OBSTACLE, "static.prop.trafficcone01")


def test_a_vehicle_may_stand_as_an_obstacle() -> None:
    wreck = actor_model(ActorKind.OBSTACLE, "vehicle.tesla.model3")
    assert wreck.kind is ActorKind.OBSTACLE
    assert wreck.length == actor_model(ActorKind.VEHICLE, "vehicle.tesla.model3").length


def test_unknown_models_name_close_ones() -> None:
    with pytest.raises(UnknownName, match=r"vehicle\.tesla\.model3"):
        actor_model(ActorKind.VEHICLE, "vehicle.tesla.model4")
    with pytest.raises(UnknownName):
        actor_model(ActorKind.WALKER, "vehicle.tesla.model3")


@pytest.mark.parametrize("name", model_names(ActorKind.VEHICLE))
def test_vehicles_are_plausible(name: str) -> None:
    model = actor_model(ActorKind.VEHICLE, name)
    assert model.kind is ActorKind.VEHICLE
    assert model.vehicle_class is not None
    assert 1.0 < model.length < 12.0
    assert 0.4 < model.width < 4.0
    assert 0.4 * model.length < model.wheelbase < 0.75 * model.length
    assert 50.0 < model.mass < 20_000.0
    assert 1.0 <= model.max_acceleration < model.max_deceleration < 10.0
    # It can turn round on a road: the middle of the rear axle within 9 m.
    assert model.wheelbase / math.tan(model.max_steer) < 9.0
    two_wheeled = model.vehicle_class in (VehicleClass.MOTORCYCLE, VehicleClass.BICYCLE)
    assert (model.mass < 500.0) == two_wheeled


@pytest.mark.parametrize("kind", [ActorKind.WALKER, ActorKind.OBSTACLE])
def test_others_have_a_size(kind: ActorKind) -> None:
    assert len(model_names(kind)) > 50
    for name in model_names(kind):
        model = actor_model(kind, name)
        assert model.kind is kind
        assert 0.1 < model.length < 11.0
        assert 0.1 < model.width < 11.0
        assert (model.max_speed > 0.0) == (kind is ActorKind.WALKER)


def test_every_name_finds_itself() -> None:
    for kind in ActorKind:
        for name in model_names(kind):
            assert actor_model(kind, name).name == name


def test_resized() -> None:
    cone = actor_model(ActorKind.OBSTACLE, "trafficcone01")
    assert resize_model(cone, 2.0, None).length == 2.0
    assert resize_model(cone, None, None) == cone
