"""Every built-in oracle keeps the contract."""

from __future__ import annotations

from drivora_service.oracles.blocked import Blocked
from drivora_service.oracles.built_in import default_oracles
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.deadlock import Deadlock
from drivora_service.oracles.destination import Destination
from drivora_service.oracles.discomfort import Discomfort
from drivora_service.oracles.failure_to_yield import FailureToYield
from drivora_service.oracles.junction_blocking import JunctionBlocking
from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.minimum_speed import MinimumSpeed
from drivora_service.oracles.near_miss import NearMiss
from drivora_service.oracles.non_optimal_decision import NonOptimalDecision
from drivora_service.oracles.off_road import OffRoad
from drivora_service.oracles.red_light import RedLight
from drivora_service.oracles.route_deviation import RouteDeviation
from drivora_service.oracles.speeding import Speeding
from drivora_service.oracles.stop_sign import StopSign
from drivora_service.oracles.tailgating import Tailgating
from drivora_service.oracles.verdict import Oracle
from drivora_service.oracles.wrong_way import WrongWay
from drivora_service.testing.oracle_contract import OracleContract


class TestCollision(OracleContract):
    def make_oracle(self) -> Oracle:
        return Collision()


class TestRedLight(OracleContract):
    def make_oracle(self) -> Oracle:
        return RedLight()


class TestOffRoad(OracleContract):
    def make_oracle(self) -> Oracle:
        return OffRoad()


class TestWrongWay(OracleContract):
    def make_oracle(self) -> Oracle:
        return WrongWay()


class TestLaneKeeping(OracleContract):
    def make_oracle(self) -> Oracle:
        return LaneKeeping()


class TestRouteDeviation(OracleContract):
    def make_oracle(self) -> Oracle:
        return RouteDeviation()


class TestNonOptimalDecision(OracleContract):
    def make_oracle(self) -> Oracle:
        return NonOptimalDecision()


class TestSpeeding(OracleContract):
    def make_oracle(self) -> Oracle:
        return Speeding()


class TestBlocked(OracleContract):
    def make_oracle(self) -> Oracle:
        return Blocked()


class TestJunctionBlocking(OracleContract):
    def make_oracle(self) -> Oracle:
        return JunctionBlocking()


class TestDeadlock(OracleContract):
    def make_oracle(self) -> Oracle:
        return Deadlock()


class TestDestination(OracleContract):
    def make_oracle(self) -> Oracle:
        return Destination()


class TestDiscomfort(OracleContract):
    def make_oracle(self) -> Oracle:
        return Discomfort()


class TestStopSign(OracleContract):
    def make_oracle(self) -> Oracle:
        return StopSign()


class TestFailureToYield(OracleContract):
    def make_oracle(self) -> Oracle:
        return FailureToYield()


class TestNearMiss(OracleContract):
    def make_oracle(self) -> Oracle:
        return NearMiss()


class TestTailgating(OracleContract):
    def make_oracle(self) -> Oracle:
        return Tailgating()


class TestMinimumSpeed(OracleContract):
    def make_oracle(self) -> Oracle:
        return MinimumSpeed()


def test_every_built_in_oracle_is_under_contract() -> None:
    under_contract = {contract().make_oracle().name for contract in OracleContract.__subclasses__()}
    assert {oracle.name for oracle in default_oracles()} <= under_contract
