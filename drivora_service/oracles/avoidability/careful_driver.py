"""The careful and competent driver of UN Regulation No. 157, and the grip available to it.

Source of the figures: UN Regulation No. 157 (automated lane keeping systems), Annex 4, Appendix 3
of the original series of amendments (Annex 3 from the 01 series on), "Guidance on traffic
disturbance critical scenarios for ALKS", performance model of the careful and competent human
driver. The open implementations of the European Commission's Joint Research Centre (JRC-FSM,
``CC_human_driver``) and of esmini (``ControllerALKS_R157SM``) use the same figures.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

from drivora_service.geometry.array_shapes import FloatArray

GRAVITY = 9.81

Number = TypeVar("Number", float, FloatArray)


@dataclass(frozen=True, slots=True, kw_only=True)
class CarefulDriver:
    """Parameters of the driver: those of the regulation, and those that it leaves open.

    Attributes:
        evaluation_time: Seconds from the risk perception point until the risk is evaluated.
        braking_delay: Seconds from then until deceleration begins.
        jerking_time: Seconds from then to the full deceleration on a dry road.
        deceleration: m/s², the full deceleration.
        wander: Metres by which a vehicle may move sideways in its lane before it is cutting in.
        leader_braking: m/s² from which on the braking of the vehicle in front is a risk.
        headway: Seconds behind the vehicle in front within which its braking is a risk.
        foresight: Seconds for which the motion of others is predicted (ours; UN Regulation No.
            152 on emergency braking begins its tests at a time to collision of 4 s).
        margin: Factor on the braking time for which the motion of others is predicted where that is
            longer than ``foresight`` (ours).
    """

    evaluation_time: float = 0.4
    braking_delay: float = 0.75
    jerking_time: float = 0.6
    deceleration: float = 0.774 * GRAVITY
    wander: float = 0.375
    leader_braking: float = 5.0
    headway: float = 2.0
    foresight: float = 4.0
    margin: float = 1.5

    @property
    def delay(self) -> float:
        """Seconds from the risk perception point until deceleration begins."""
        return self.evaluation_time + self.braking_delay

    @property
    def jerk(self) -> float:
        """m/s³ with which the deceleration grows."""
        return self.deceleration / self.jerking_time

    def full_braking(self, grip: float, brakes: float) -> float:
        """Returns the deceleration that a road's grip and a vehicle's brakes allow, all m/s²."""
        return min(self.deceleration, grip, brakes)

    def time_for(self, closing: Number, grip: float) -> Number:
        """Returns the approximate seconds before a meeting at which braking has to begin.

        Args:
            closing: Closing speed to be braked off, m/s; a number or an array.
            grip: Friction times gravity, m/s².
        """
        full = self.full_braking(grip, math.inf)
        return self.delay + 0.5 * full / self.jerk + 0.5 * closing / full

    def stopping_distance(self, speed: float, grip: float, brakes: float = math.inf) -> float:
        """Returns the metres from the risk perception point to standstill on a straight road.

        Args:
            speed: m/s.
            grip: Friction times gravity, m/s².
            brakes: Full deceleration of the vehicle, m/s².
        """
        full = self.full_braking(grip, brakes)
        ramp = full / self.jerk
        distance = speed * self.delay
        lost = 0.5 * self.jerk * ramp**2
        if lost >= speed:
            ramp = math.sqrt(2.0 * speed / self.jerk)
            return distance + speed * ramp - self.jerk * ramp**3 / 6.0
        distance += speed * ramp - self.jerk * ramp**3 / 6.0
        return distance + (speed - lost) ** 2 / (2.0 * full)
