"""Colours of the pictures, also distinguishable with the common colour vision deficiencies."""

from __future__ import annotations

from drivora_service.observations.trace import Light, Role

GROUND = "#f6f5f1"
ROAD = "#d3d6da"
ROAD_EDGE = "#9aa1a9"
LANE_MARK = "#ffffff"
LANE_ARROW = "#b3b9c0"
SIDEWALK = "#e9e4d8"
PATCH = "#cfe8f3"
PATCH_EDGE = "#5aa3c0"
INK = "#1f2933"
FAINT_INK = "#616e7c"
VERDICT = "#c1121f"

EGOS = ("#0b5fa5", "#e07a00", "#0f8a5f", "#8f3fa8", "#b8860b", "#00868b")
"""Colours of the egos in turn (blue, orange, green, purple, ochre, teal)."""

METHODS = (*EGOS, "#c2478c", "#7a4b1e")
"""Colours of compared methods in turn (then pink, brown)."""

ROLES = {
    Role.NPC_VEHICLE: "#5b6b7b",
    Role.NPC_WALKER: "#c2478c",
    Role.NPC_OBSTACLE: "#7a4b1e",
    Role.BACKGROUND: "#a4afba",
}

LIGHTS = {
    Light.NONE: "#8a9199",
    Light.GREEN: "#1a9850",
    Light.YELLOW: "#e0a800",
    Light.RED: "#d7191c",
}


def ego_color(index: int) -> str:
    """Returns the colour of the ego in row ``index``."""
    return EGOS[index % len(EGOS)]
