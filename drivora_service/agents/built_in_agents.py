"""The built-in agents, without those that need their own environments.

The code of an agent is imported when the agent is made: reading a catalogue and checking documents
need its entry and parameters alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.idm.parameters import IdmParameters
from drivora_service.agents.idm_mobil.parameters import MobilParameters
from drivora_service.agents.metadrive_ppo.weights import WEIGHTS_FILE as METADRIVE_WEIGHTS
from drivora_service.agents.nmpc.casadi_files import CASADI_FILES
from drivora_service.agents.nmpc.parameters import NmpcParameters
from drivora_service.agents.pdm_closed.parameters import PdmParameters
from drivora_service.agents.plugin import (
    AgentPlugin,
    FetchedAgentPlugin,
    NoParameters,
    agent_plugin,
)
from drivora_service.agents.puffer_drive.parameters import PufferDriveParameters
from drivora_service.agents.puffer_drive.weights import WEIGHTS_FILE as PUFFER_WEIGHTS
from drivora_service.agents.scripted.parameters import ScriptedParameters
from drivora_service.agents.sumo_driver import SumoDriver, SumoDriverParameters

if TYPE_CHECKING:
    from drivora_service.agents.interface import Agent


def import_agents() -> None:
    """Imports the code of all agents that need no files of other packages, before any is made."""
    import drivora_service.agents.ad_mlp.network
    import drivora_service.agents.ad_mlp.view
    import drivora_service.agents.idm.agent
    import drivora_service.agents.idm_mobil.agent
    import drivora_service.agents.imitation.agent
    import drivora_service.agents.pdm_closed.agent
    import drivora_service.agents.plant_lite.network
    import drivora_service.agents.plant_lite.view
    import drivora_service.agents.scripted.agent  # noqa: F401 # importing is all that is wanted


def _idm(parameters: IdmParameters) -> Agent:
    from drivora_service.agents.idm.agent import IdmAgent

    return IdmAgent(parameters.speed_factor, parameters.reaction_time)


def _idm_mobil(parameters: MobilParameters) -> Agent:
    from drivora_service.agents.idm_mobil.agent import MobilAgent

    return MobilAgent(parameters)


def _pdm_closed(parameters: PdmParameters) -> Agent:
    from drivora_service.agents.pdm_closed.agent import PdmClosedAgent

    return PdmClosedAgent(parameters)


def _plant_lite(_: NoParameters) -> Agent:
    from drivora_service.agents.imitation.agent import WaypointAgent
    from drivora_service.agents.imitation.weights import load_weights
    from drivora_service.agents.plant_lite.network import PlantNetwork, PlantWeights
    from drivora_service.agents.plant_lite.view import PlantView

    return WaypointAgent(PlantView(), PlantNetwork(load_weights(PlantWeights)))


def _ad_mlp(_: NoParameters) -> Agent:
    from drivora_service.agents.ad_mlp.network import AdMlpNetwork, AdMlpWeights
    from drivora_service.agents.ad_mlp.view import AdMlpView
    from drivora_service.agents.imitation.agent import WaypointAgent
    from drivora_service.agents.imitation.weights import load_weights

    return WaypointAgent(AdMlpView(), AdMlpNetwork(load_weights(AdMlpWeights)))


def _scripted(parameters: ScriptedParameters) -> Agent:
    from drivora_service.agents.scripted.agent import ScriptedAgent

    return ScriptedAgent(parameters)


def _metadrive_ppo(written: Mapping[str, Any], folder: Path) -> Agent:
    from drivora_service.agents.metadrive_ppo.agent import create

    return create(written, folder)


def _puffer_drive(written: Mapping[str, Any], folder: Path) -> Agent:
    from drivora_service.agents.puffer_drive.agent import create

    return create(written, folder)


def _nmpc(written: Mapping[str, Any], folder: Path) -> Agent:
    from drivora_service.agents.nmpc.agent import create

    return create(written, folder)


def _sumo_plugin(name: str, model: str, car_following: str) -> AgentPlugin:
    return agent_plugin(
        AgentEntry(
            name=name,
            kind=AgentKind.BASELINE,
            description=f"SUMO's own driver: {model}, lane changes by LC2013 or SL2015",
            source="Eclipse SUMO",
            licence="EPL-2.0",
            privileged=True,
        ),
        SumoDriverParameters,
        lambda parameters: SumoDriver(
            car_following=car_following, lane_change_model=parameters.lane_change_model
        ),
    )


BUILT_IN: tuple[AgentPlugin, ...] = (
    agent_plugin(
        AgentEntry(
            name="idm",
            kind=AgentKind.MODULE_BASED,
            description=(
                "intelligent driver model and pure pursuit along the route; obeys lights and right "
                "of way, changes lanes where the route needs it"
            ),
            source="written here after Treiber, Hennecke, Helbing 2000 and Coulter 1992",
            licence="Apache-2.0",
        ),
        IdmParameters,
        _idm,
    ),
    agent_plugin(
        AgentEntry(
            name="idm-mobil",
            kind=AgentKind.MODULE_BASED,
            description=(
                "`idm` that overtakes: lane changes where they pay off and cost others little, "
                "and back in time for its route"
            ),
            source="written here after Kesting, Treiber, Helbing 2007",
            licence="Apache-2.0",
        ),
        MobilParameters,
        _idm_mobil,
    ),
    agent_plugin(
        AgentEntry(
            name="pdm-closed",
            kind=AgentKind.MODULE_BASED,
            description=(
                "drives the best of fifteen simulated proposals: three lateral offsets and five "
                "speeds, scored by nuPlan's terms"
            ),
            source="written here after Dauner, Hallgarten, Geiger, Chitta 2023",
            licence="Apache-2.0",
        ),
        PdmParameters,
        _pdm_closed,
    ),
    agent_plugin(
        AgentEntry(
            name="plant-lite",
            kind=AgentKind.END_TO_END,
            description=(
                "transformer over others and pieces of the way as boxes, to waypoints; trained "
                "here by imitation of `idm`, shown lights and right of way"
            ),
            source="written and trained here after Renz et al. 2022 (PlanT)",
            licence="Apache-2.0",
        ),
        NoParameters,
        _plant_lite,
    ),
    agent_plugin(
        AgentEntry(
            name="ad-mlp",
            kind=AgentKind.END_TO_END,
            description=(
                "perceptron from its own history, its way and the light to waypoints; trained here "
                "by imitation of `idm`; perceives no actors, so it hits those ahead"
            ),
            source="written and trained here after Zhai et al. 2023 (AD-MLP)",
            licence="Apache-2.0",
        ),
        NoParameters,
        _ad_mlp,
    ),
    agent_plugin(
        AgentEntry(
            name="scripted",
            kind=AgentKind.BASELINE,
            description=(
                "no ADS: follows the trajectory of its parameters, regardless of other actors; for "
                "scenarios with a known answer"
            ),
            source="written here",
            licence="Apache-2.0",
        ),
        ScriptedParameters,
        _scripted,
    ),
    _sumo_plugin("sumo-krauss", "Krauss car following", "krauss"),
    _sumo_plugin("sumo-idm", "IDM car following", "idm"),
    _sumo_plugin("sumo-eidm", "EIDM car following", "eidm"),
    _sumo_plugin("sumo-acc", "adaptive cruise control", "acc"),
    _sumo_plugin("sumo-cacc", "cooperative adaptive cruise control", "cacc"),
)

FETCHED: tuple[FetchedAgentPlugin, ...] = (
    FetchedAgentPlugin(
        entry=AgentEntry(
            name="metadrive-ppo",
            kind=AgentKind.END_TO_END,
            description=(
                "expert policy trained by PPO in MetaDrive, from rays and the nearest vehicles to "
                "steering and throttle; knows neither lights nor right of way nor limits: its "
                "adapter brakes for lights and holds back at the limit"
            ),
            source="metadrive-simulator 0.4.3 (Li et al. 2022)",
            licence="Apache-2.0",
        ),
        parameters=NoParameters,
        files=(METADRIVE_WEIGHTS,),
        create=_metadrive_ppo,
    ),
    FetchedAgentPlugin(
        entry=AgentEntry(
            name="puffer-drive",
            kind=AgentKind.END_TO_END,
            description=(
                "self-play policy trained on recorded city scenes, from roads and vehicles to a "
                "choice of acceleration and steering; reckless; knows neither lights nor right of "
                "way nor limits: its adapter brakes for lights and holds back at the limit"
            ),
            source="pufferlib 3.0.0 (Suarez 2024; scenes of GPUDrive, Kazemkhani et al. 2024)",
            licence="MIT",
        ),
        parameters=PufferDriveParameters,
        files=(PUFFER_WEIGHTS,),
        create=_puffer_drive,
    ),
    FetchedAgentPlugin(
        entry=AgentEntry(
            name="nmpc",
            kind=AgentKind.MODULE_BASED,
            description=(
                "nonlinear model-predictive control: the best of all ways to track its route over "
                "2.8 s, out of the boxes where others are foreseen; obeys lights and right of way"
            ),
            source="written here, with CasADi 3.8.2 (Andersson et al. 2019) and FATROP",
            licence="Apache-2.0; CasADi LGPL-3.0-or-later, FATROP BSD-2-Clause and EPL-2.0",
        ),
        parameters=NmpcParameters,
        files=(CASADI_FILES,),
        create=_nmpc,
    ),
)
