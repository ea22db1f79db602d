"""Figures of the models: one row each.

Lengths and widths are the bounding boxes that CARLA 0.9.16 reports for its blueprints, rounded to
the centimetre; wheelbases and masses are those of the real vehicles after which the blueprints are
modelled, if the box is about their size, else scaled to the box. Limits are per class: the
driving figures that SUMO documents for its vehicle classes (``emergencyDecel``, ``maxSpeed``) and,
for full throttle, ordinary road tests. Heights, which matter for occlusion, are those of
ordinary vehicles of the class (two-wheelers with their rider), people and things: chosen here, to
the decimetre.
"""

from __future__ import annotations

from typing import NamedTuple


class ClassLimits(NamedTuple):
    """m/s² from standstill, m/s² braking, radians at the wheels, m/s, height in metres."""

    max_acceleration: float
    max_deceleration: float
    max_steer: float
    max_speed: float
    height: float


class VehicleFigures(NamedTuple):
    """Name without ``vehicle.``, class, length, width, wheelbase in metres, mass in kilograms."""

    name: str
    vehicle_class: str
    length: float
    width: float
    wheelbase: float
    mass: float


class ObstacleFigures(NamedTuple):
    """Name without ``static.prop.``, length and width in metres."""

    name: str
    length: float
    width: float


CLASS_LIMITS: dict[str, ClassLimits] = {
    "car": ClassLimits(4.0, 8.5, 0.61, 55.0, 1.5),
    "van": ClassLimits(2.8, 8.0, 0.65, 45.0, 2.3),
    "truck": ClassLimits(1.5, 7.0, 0.75, 36.0, 3.2),
    "bus": ClassLimits(1.3, 7.0, 0.85, 30.0, 3.1),
    "motorcycle": ClassLimits(5.5, 8.5, 0.60, 50.0, 1.6),
    "bicycle": ClassLimits(1.2, 5.0, 0.80, 10.0, 1.7),
}

VEHICLES: tuple[VehicleFigures, ...] = (
    VehicleFigures("audi.a2", "car", 3.71, 1.79, 2.41, 1000.0),
    VehicleFigures("audi.etron", "car", 4.86, 2.03, 2.93, 2490.0),
    VehicleFigures("audi.tt", "car", 4.18, 1.99, 2.51, 1365.0),
    VehicleFigures("bh.crossbike", "bicycle", 1.51, 0.87, 1.05, 90.0),
    VehicleFigures("bmw.grandtourer", "car", 4.61, 2.24, 2.78, 1580.0),
    VehicleFigures("carlamotors.carlacola", "truck", 5.20, 2.63, 3.00, 5500.0),
    VehicleFigures("carlamotors.european_hgv", "truck", 7.94, 2.89, 4.50, 9000.0),
    VehicleFigures("carlamotors.firetruck", "truck", 8.47, 2.89, 4.80, 13000.0),
    VehicleFigures("chevrolet.impala", "car", 5.36, 2.03, 2.84, 1720.0),
    VehicleFigures("citroen.c3", "car", 3.99, 1.85, 2.54, 1100.0),
    VehicleFigures("diamondback.century", "bicycle", 1.66, 0.58, 1.00, 85.0),
    VehicleFigures("dodge.charger_2020", "car", 5.01, 1.88, 3.05, 1930.0),
    VehicleFigures("dodge.charger_police", "car", 4.97, 2.04, 3.05, 1980.0),
    VehicleFigures("dodge.charger_police_2020", "car", 5.24, 1.93, 3.05, 1980.0),
    VehicleFigures("ford.ambulance", "van", 6.37, 2.35, 3.60, 4600.0),
    VehicleFigures("ford.crown", "car", 5.37, 1.80, 2.91, 1850.0),
    VehicleFigures("ford.mustang", "car", 4.72, 1.89, 2.74, 1340.0),
    VehicleFigures("gazelle.omafiets", "bicycle", 1.84, 0.66, 1.15, 95.0),
    VehicleFigures("harley-davidson.low_rider", "motorcycle", 2.35, 0.77, 1.63, 380.0),
    VehicleFigures("jeep.wrangler_rubicon", "car", 3.87, 1.91, 2.42, 1830.0),
    VehicleFigures("kawasaki.ninja", "motorcycle", 2.04, 0.80, 1.40, 275.0),
    VehicleFigures("lincoln.mkz_2017", "car", 4.90, 2.13, 2.85, 1700.0),
    VehicleFigures("lincoln.mkz_2020", "car", 4.89, 1.84, 2.85, 1700.0),
    VehicleFigures("mercedes.coupe", "car", 5.03, 2.15, 2.87, 1735.0),
    VehicleFigures("mercedes.coupe_2020", "car", 4.67, 1.81, 2.84, 1570.0),
    VehicleFigures("mercedes.sprinter", "van", 5.92, 1.99, 3.67, 2350.0),
    VehicleFigures("micro.microlino", "car", 2.21, 1.48, 1.57, 520.0),
    VehicleFigures("mini.cooper_s", "car", 3.81, 1.97, 2.47, 1210.0),
    VehicleFigures("mini.cooper_s_2021", "car", 4.55, 2.10, 2.67, 1360.0),
    VehicleFigures("mitsubishi.fusorosa", "bus", 10.27, 3.94, 5.30, 9500.0),
    VehicleFigures("nissan.micra", "car", 3.63, 1.85, 2.43, 1010.0),
    VehicleFigures("nissan.patrol", "car", 4.60, 1.93, 2.65, 2280.0),
    VehicleFigures("nissan.patrol_2021", "car", 5.57, 2.15, 3.08, 2750.0),
    VehicleFigures("seat.leon", "car", 4.19, 1.82, 2.58, 1280.0),
    VehicleFigures("tesla.cybertruck", "car", 6.27, 2.39, 3.81, 3000.0),
    VehicleFigures("tesla.model3", "car", 4.79, 2.16, 2.88, 1830.0),
    VehicleFigures("toyota.prius", "car", 4.51, 2.01, 2.70, 1390.0),
    VehicleFigures("vespa.zx125", "motorcycle", 1.82, 0.87, 1.29, 185.0),
    VehicleFigures("volkswagen.t2", "van", 4.48, 2.07, 2.40, 1350.0),
    VehicleFigures("volkswagen.t2_2021", "van", 4.44, 1.77, 2.40, 1350.0),
    VehicleFigures("yamaha.yzf", "motorcycle", 2.19, 0.87, 1.38, 275.0),
)

VEHICLE_ALIASES: dict[str, str] = {
    # Blueprint names of CARLA before 0.9.12.
    "bmw.isetta": "micro.microlino",
    "dodge_charger.police": "dodge.charger_police",
    "mercedes-benz.coupe": "mercedes.coupe",
    "mini.cooperst": "mini.cooper_s",
    "mustang.mustang": "ford.mustang",
    # Blueprint names of CARLA 0.10.
    "ambulance.ford": "ford.ambulance",
    "carlacola.actors": "carlamotors.carlacola",
    "dodge.charger": "dodge.charger_2020",
    "dodgecop.charger": "dodge.charger_police_2020",
    "firetruck.actors": "carlamotors.firetruck",
    "fuso.mitsubishi": "mitsubishi.fusorosa",
    "lincoln.mkz": "lincoln.mkz_2020",
    "mini.cooper": "mini.cooper_s_2021",
    "sprinter.mercedes": "mercedes.sprinter",
    "taxi.ford": "ford.crown",
}

WALKER_COUNT = 52
"""``walker.pedestrian.0001`` to ``0052``."""
ADULT_SIZE = 0.38
CHILD_SIZE = 0.50
"""Metres; CARLA's capsules are square, and those of small children are wider."""
ADULT_HEIGHT = 1.7
CHILD_HEIGHT = 1.2
ADULT_MAX_SPEED = 10.0
CHILD_MAX_SPEED = 6.0
CHILDREN: frozenset[int] = frozenset((9, 10, 11, 12, 13, 14, 48, 49))
SMALL_CHILDREN: frozenset[int] = frozenset((9, 10, 11, 48, 49))

LOW_OBSTACLE_HEIGHT = 0.9
TALL_OBSTACLES: dict[str, float] = {
    "advertisement": 2.3,
    "atm": 1.8,
    "busstop": 2.6,
    "clothcontainer": 1.9,
    "container": 1.6,
    "foodcart": 2.4,
    "fountain": 1.8,
    "glasscontainer": 1.8,
    "haybale": 1.2,
    "kiosk_01": 2.5,
    "streetsign": 2.0,
    "streetsign01": 2.2,
    "streetsign04": 2.0,
    "swingcouch": 1.7,
    "trafficwarning": 2.5,
    "vendingmachine": 1.9,
}
"""Heights of tall obstacles, metres; all others are low."""

OBSTACLES: tuple[ObstacleFigures, ...] = (
    ObstacleFigures("advertisement", 1.55, 0.29),
    ObstacleFigures("atm", 0.71, 0.87),
    ObstacleFigures("barrel", 0.46, 0.47),
    ObstacleFigures("bench01", 1.54, 0.74),
    ObstacleFigures("bench02", 1.56, 0.54),
    ObstacleFigures("bench03", 1.58, 0.51),
    ObstacleFigures("bin", 0.55, 0.64),
    ObstacleFigures("box01", 0.65, 0.65),
    ObstacleFigures("box02", 0.65, 0.65),
    ObstacleFigures("box03", 0.66, 0.67),
    ObstacleFigures("briefcase", 0.54, 0.18),
    ObstacleFigures("busstop", 3.88, 1.89),
    ObstacleFigures("chainbarrier", 1.49, 0.24),
    ObstacleFigures("chainbarrierend", 0.24, 0.24),
    ObstacleFigures("clothcontainer", 1.24, 1.89),
    ObstacleFigures("constructioncone", 0.34, 0.34),
    ObstacleFigures("container", 1.93, 1.01),
    ObstacleFigures("creasedbox01", 0.81, 0.71),
    ObstacleFigures("creasedbox02", 1.63, 0.71),
    ObstacleFigures("creasedbox03", 1.67, 0.71),
    ObstacleFigures("dirtdebris01", 1.86, 1.51),
    ObstacleFigures("dirtdebris02", 1.86, 1.51),
    ObstacleFigures("dirtdebris03", 1.86, 1.51),
    ObstacleFigures("doghouse", 1.08, 1.27),
    ObstacleFigures("foodcart", 2.28, 4.64),
    ObstacleFigures("fountain", 8.40, 8.40),
    ObstacleFigures("glasscontainer", 1.95, 2.01),
    ObstacleFigures("gnome", 0.37, 0.38),
    ObstacleFigures("haybale", 1.25, 1.19),
    ObstacleFigures("ironplank", 1.45, 1.17),
    ObstacleFigures("kiosk_01", 1.63, 1.65),
    ObstacleFigures("mailbox", 0.53, 0.44),
    ObstacleFigures("maptable", 1.57, 0.62),
    ObstacleFigures("plantpot01", 1.09, 0.48),
    ObstacleFigures("plantpot02", 1.05, 0.43),
    ObstacleFigures("plantpot03", 1.05, 0.43),
    ObstacleFigures("plantpot04", 4.97, 0.74),
    ObstacleFigures("plantpot05", 0.40, 0.40),
    ObstacleFigures("plantpot06", 1.59, 1.59),
    ObstacleFigures("plantpot07", 0.49, 0.48),
    ObstacleFigures("plantpot08", 0.53, 0.53),
    ObstacleFigures("plasticchair", 0.73, 0.75),
    ObstacleFigures("plastictable", 2.48, 2.48),
    ObstacleFigures("platformgarbage01", 3.63, 1.71),
    ObstacleFigures("shoppingcart", 0.67, 1.21),
    ObstacleFigures("shoppingtrolley", 0.51, 0.33),
    ObstacleFigures("streetbarrier", 1.21, 0.37),
    ObstacleFigures("streetfountain", 0.29, 0.67),
    ObstacleFigures("streetsign", 1.06, 0.13),
    ObstacleFigures("streetsign01", 2.47, 0.30),
    ObstacleFigures("streetsign04", 1.17, 0.12),
    ObstacleFigures("swingcouch", 1.36, 2.36),
    ObstacleFigures("table", 2.16, 2.15),
    ObstacleFigures("trafficcone01", 0.88, 0.88),
    ObstacleFigures("trafficcone02", 0.46, 0.39),
    ObstacleFigures("trafficwarning", 2.37, 2.87),
    ObstacleFigures("trampoline", 4.13, 4.13),
    ObstacleFigures("trashbag", 0.38, 0.43),
    ObstacleFigures("trashcan01", 0.64, 0.57),
    ObstacleFigures("trashcan02", 0.52, 0.51),
    ObstacleFigures("trashcan03", 0.63, 0.55),
    ObstacleFigures("trashcan04", 0.79, 0.58),
    ObstacleFigures("trashcan05", 0.79, 0.58),
    ObstacleFigures("travelcase", 0.57, 0.33),
    ObstacleFigures("vendingmachine", 0.87, 1.10),
    ObstacleFigures("warningaccident", 1.31, 1.06),
    ObstacleFigures("warningconstruction", 1.31, 1.06),
)
