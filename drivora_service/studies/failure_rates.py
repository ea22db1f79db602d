"""How often simulations fail, and whether methods can be told apart by that.

The interval is that of Clopper and Pearson 1934 ("The use of confidence or fiducial limits
illustrated in the case of the binomial"). It holds the true rate in at least 95 of 100 cases, also
for none or all of a few simulations, where approximations by a normal distribution do not.
"""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import computed_field

from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_warnings import upper_bound

TOO_RARE = 0.005
"""Rate of random failures below which campaigns hardly differ: 200 simulations, as many as most
campaigns make, find one failure or none then, by whichever method, and repetitions that find none
are ties."""

TOO_FREQUENT = 0.5
"""Rate of random failures above which campaigns hardly differ: the first or second simulation fails
by any method, and none can find more than twice as many failures as another."""

_CONFIDENCE = 0.95
_WIDE = 0.05
"""Upper end of the interval above which a rate of about 0 is hardly known: of some 70 simulations
or fewer."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureRate(Shape):
    """The share of simulations that fail.

    Attributes:
        failing: Number of simulations with a failure.
        simulations: Number of all simulations.
    """

    failing: int
    simulations: int

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def rate(self) -> float | None:
        """The share; null without a simulation."""
        return self.failing / self.simulations if self.simulations else None

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def low(self) -> float:
        """Lower end of the 95 % confidence interval."""
        return self._interval()[0]

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def high(self) -> float:
        """Upper end of the 95 % confidence interval."""
        return self._interval()[1]

    @property
    def is_too_rare(self) -> bool:
        """Whether too few simulations fail for a comparison."""
        return self.rate is not None and self.rate < TOO_RARE

    @property
    def is_too_frequent(self) -> bool:
        """Whether too many simulations fail for a comparison."""
        return self.rate is not None and self.rate > TOO_FREQUENT

    def __str__(self) -> str:
        """Returns the numbers in words."""
        if self.rate is None:
            return "no simulation"
        return (
            f"{self.failing} of {self.simulations} simulations ({percent(self.rate)}; 95 % "
            f"interval {percent(self.low)} to {percent(self.high)})"
        )

    def _interval(self) -> tuple[float, float]:
        if not self.simulations:
            return 0.0, 1.0
        # Imported here: importing it takes half a second, which the service's start skips.
        from scipy import special

        failing, passing = self.failing, self.simulations - self.failing
        tail = 0.5 * (1.0 - _CONFIDENCE)
        # The rates at which so many failures, or so few, have the probability of a tail; by the
        # relation of the binomial distribution to the beta distribution.
        low = float(special.betaincinv(failing, passing + 1, tail)) if failing else 0.0
        high = float(special.betaincinv(failing + 1, passing, 1.0 - tail)) if passing else 1.0
        return low, high


def _bound(rate: FailureRate) -> float:
    """Returns the rate above which it hardly is; of none that fail, the bound has one side."""
    return rate.high if rate.failing else upper_bound(rate.simulations)


def percent(share: float) -> str:
    """Writes a share in percent, with two digits that count at most."""
    value = 100.0 * share
    return f"{value:.0f} %" if value >= 10.0 or value == 0.0 else f"{value:.2g} %"


def describe_rate(rate: FailureRate) -> str:
    """Says what the rate at which random scenarios fail means for a comparison of methods."""
    if rate.rate is None:
        return "No simulation has a result: nothing is known of the rate."
    told = f"{rate.failing} of {rate.simulations} fail"
    if rate.is_too_frequent:
        meaning = (
            "about every second or more fails by chance, so that a comparison of methods tells "
            "little. Search a harder task for a method: another scene, fewer actors, or fewer "
            "failures that count (`counts`, `oracles`)."
        )
    elif rate.is_too_rare:
        meaning = (
            f"a rate above {percent(_bound(rate))} is unlikely; below {percent(TOO_RARE)} methods "
            "hardly differ. Try another scene or a space with more actors, or give campaigns "
            "thousands of simulations."
        )
        if rate.high > _WIDE:
            meaning += " So few simulations tell little of the rate: make more."
    else:
        meaning = (
            f"between {percent(TOO_RARE)} and {percent(TOO_FREQUENT)}, methods can differ here; "
            f"random search needs about {1.0 / rate.rate:.0f} simulations to a failure."
        )
    return f"{told} ({percent(rate.rate)}): {meaning}"
