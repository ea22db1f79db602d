"""The ego follows another vehicle too closely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.leaders import Leaders, leaders
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.oracles.verdict import (
    Severity,
    Verdict,
    not_applicable,
    not_started,
    passed,
    violated,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tailgating:
    """Violated where the ego follows a vehicle more closely than RSS allows for a long time.

    The safe distance is definition 1 of Shalev-Shwartz, Shammah and Shashua, "On a formal model of
    safe and scalable self-driving cars" (2017): the distance for an ego that reacts after the
    response time and then brakes, while the vehicle ahead brakes as hard as it can. Parameters are
    those of UNECE's competent driver rather than the cautious ones of the metric
    ``rss_violation_share``, under which an ego with a headway of two seconds tailgates.

    Attributes:
        duration: Seconds for which the distance must be too short.
        response_time: Seconds.
        acceleration: m/s² of the ego during the response time.
        own_braking: m/s² with which the ego brakes.
        other_braking: m/s² with which the vehicle ahead brakes.
        reach: Metres within which a vehicle ahead is followed; without one, there is nothing to
            judge.
    """

    duration: float = 2.0
    response_time: float = 0.75
    acceleration: float = 0.0
    own_braking: float = 6.43
    other_braking: float = 7.59
    reach: float = 100.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "tailgating"

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Returns a verdict for every time that an ego was too close for too long."""
        return tuple(verdict for ego in run.egos for verdict in self._judge(ego))

    def safe_distance(self, speed: FloatArray, lead: FloatArray) -> FloatArray:
        """Returns the (n,) safe distances in metres between the ego and the vehicle ahead.

        Args:
            speed: (n,) speed of the ego, m/s, not negative.
            lead: (n,) speed of the vehicle ahead, m/s, not negative.
        """
        reached = speed + self.response_time * self.acceleration
        needed: FloatArray = (
            speed * self.response_time
            + 0.5 * self.acceleration * self.response_time**2
            + reached**2 / (2.0 * self.own_braking)
            - lead**2 / (2.0 * self.other_braking)
        )
        return np.maximum(needed, 0.0)

    def measure(self, ego: EgoView) -> tuple[Leaders, FloatArray]:
        """Returns the vehicles ahead of an ego, and the (n,) safe distances to them, metres."""
        ahead = leaders(ego, vehicles_only=True)
        speed = np.maximum(ego.forward_speed, 0.0)
        return ahead, self.safe_distance(speed, np.nan_to_num(np.maximum(ahead.speed, 0.0)))

    def _judge(self, ego: EgoView) -> list[Verdict]:
        if not ego.count:
            return [not_started(self.name, ego)]
        ahead, needed = self.measure(ego)
        speed = np.maximum(ego.forward_speed, 0.0)
        verdicts = []
        longest = 0.0
        for first, last in stretches((ahead.room < needed) & ahead.same_way):
            seconds = float((last - first) * ego.step_length)
            longest = max(longest, seconds)
            if seconds < self.duration - 1e-9:
                continue
            k = first + int(np.argmin(ahead.room[first:last] - needed[first:last]))
            leader = ego.trace.actors[ahead.actor[k]].id
            verdicts.append(
                violated(
                    self.name,
                    ego,
                    first,
                    f"{ahead.room[k]:.1f} m behind {leader} at {speed[k]:.1f} m/s, where "
                    f"{needed[k]:.1f} m are safe; too close for {seconds:.1f} s.",
                    severity=Severity.OBSERVATION,
                    counterpart=leader,
                    duration=seconds,
                    until=float(ego.times[last - 1]),
                    distance=float(ahead.room[k]),
                    safe_distance=float(needed[k]),
                    speed=float(speed[k]),
                )
            )
        if verdicts:
            return verdicts
        if longest > 0.0:
            message = f"Too close for {longest:.1f} s at most; {self.duration:g} s count."
        elif (ahead.same_way & (ahead.room <= self.reach)).any():
            message = "Kept its distance."
        else:
            message = f"No vehicle ahead within {self.reach:g} m that goes the same way."
            return [not_applicable(self.name, ego, message)]
        return [passed(self.name, ego, message)]
