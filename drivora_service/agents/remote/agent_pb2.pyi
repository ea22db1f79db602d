from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Light(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    LIGHT_NONE: _ClassVar[Light]
    LIGHT_GREEN: _ClassVar[Light]
    LIGHT_YELLOW: _ClassVar[Light]
    LIGHT_RED: _ClassVar[Light]
LIGHT_NONE: Light
LIGHT_GREEN: Light
LIGHT_YELLOW: Light
LIGHT_RED: Light

class DescribeRequest(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class Description(_message.Message):
    __slots__ = ("protocol", "name")
    PROTOCOL_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    protocol: int
    name: str
    def __init__(self, protocol: _Optional[int] = ..., name: _Optional[str] = ...) -> None: ...

class SetupRequest(_message.Message):
    __slots__ = ("protocol", "run", "ego_id", "vehicle", "route", "lanes", "step_length", "friction", "seed", "parameters_json", "raster_channels")
    PROTOCOL_FIELD_NUMBER: _ClassVar[int]
    RUN_FIELD_NUMBER: _ClassVar[int]
    EGO_ID_FIELD_NUMBER: _ClassVar[int]
    VEHICLE_FIELD_NUMBER: _ClassVar[int]
    ROUTE_FIELD_NUMBER: _ClassVar[int]
    LANES_FIELD_NUMBER: _ClassVar[int]
    STEP_LENGTH_FIELD_NUMBER: _ClassVar[int]
    FRICTION_FIELD_NUMBER: _ClassVar[int]
    SEED_FIELD_NUMBER: _ClassVar[int]
    PARAMETERS_JSON_FIELD_NUMBER: _ClassVar[int]
    RASTER_CHANNELS_FIELD_NUMBER: _ClassVar[int]
    protocol: int
    run: str
    ego_id: str
    vehicle: Vehicle
    route: Route
    lanes: _containers.RepeatedCompositeFieldContainer[Lane]
    step_length: float
    friction: float
    seed: int
    parameters_json: str
    raster_channels: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, protocol: _Optional[int] = ..., run: _Optional[str] = ..., ego_id: _Optional[str] = ..., vehicle: _Optional[_Union[Vehicle, _Mapping]] = ..., route: _Optional[_Union[Route, _Mapping]] = ..., lanes: _Optional[_Iterable[_Union[Lane, _Mapping]]] = ..., step_length: _Optional[float] = ..., friction: _Optional[float] = ..., seed: _Optional[int] = ..., parameters_json: _Optional[str] = ..., raster_channels: _Optional[_Iterable[str]] = ...) -> None: ...

class SetupReply(_message.Message):
    __slots__ = ("log_names", "text", "rasters")
    LOG_NAMES_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    RASTERS_FIELD_NUMBER: _ClassVar[int]
    log_names: _containers.RepeatedScalarFieldContainer[str]
    text: str
    rasters: _containers.RepeatedCompositeFieldContainer[RasterRequest]
    def __init__(self, log_names: _Optional[_Iterable[str]] = ..., text: _Optional[str] = ..., rasters: _Optional[_Iterable[_Union[RasterRequest, _Mapping]]] = ...) -> None: ...

class RasterRequest(_message.Message):
    __slots__ = ("height", "width", "metres_per_pixel", "ego_from_top", "ego_from_left", "channels", "history")
    HEIGHT_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    METRES_PER_PIXEL_FIELD_NUMBER: _ClassVar[int]
    EGO_FROM_TOP_FIELD_NUMBER: _ClassVar[int]
    EGO_FROM_LEFT_FIELD_NUMBER: _ClassVar[int]
    CHANNELS_FIELD_NUMBER: _ClassVar[int]
    HISTORY_FIELD_NUMBER: _ClassVar[int]
    height: int
    width: int
    metres_per_pixel: float
    ego_from_top: float
    ego_from_left: float
    channels: _containers.RepeatedScalarFieldContainer[str]
    history: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, height: _Optional[int] = ..., width: _Optional[int] = ..., metres_per_pixel: _Optional[float] = ..., ego_from_top: _Optional[float] = ..., ego_from_left: _Optional[float] = ..., channels: _Optional[_Iterable[str]] = ..., history: _Optional[_Iterable[float]] = ...) -> None: ...

class Vehicle(_message.Message):
    __slots__ = ("model", "length", "width", "wheelbase", "mass", "max_acceleration", "max_deceleration", "max_steer", "max_speed")
    MODEL_FIELD_NUMBER: _ClassVar[int]
    LENGTH_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    WHEELBASE_FIELD_NUMBER: _ClassVar[int]
    MASS_FIELD_NUMBER: _ClassVar[int]
    MAX_ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_DECELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_STEER_FIELD_NUMBER: _ClassVar[int]
    MAX_SPEED_FIELD_NUMBER: _ClassVar[int]
    model: str
    length: float
    width: float
    wheelbase: float
    mass: float
    max_acceleration: float
    max_deceleration: float
    max_steer: float
    max_speed: float
    def __init__(self, model: _Optional[str] = ..., length: _Optional[float] = ..., width: _Optional[float] = ..., wheelbase: _Optional[float] = ..., mass: _Optional[float] = ..., max_acceleration: _Optional[float] = ..., max_deceleration: _Optional[float] = ..., max_steer: _Optional[float] = ..., max_speed: _Optional[float] = ...) -> None: ...

class Route(_message.Message):
    __slots__ = ("line", "arc", "speed_limits", "widths", "lane_ids", "signals", "runs", "stop_signs")
    LINE_FIELD_NUMBER: _ClassVar[int]
    ARC_FIELD_NUMBER: _ClassVar[int]
    SPEED_LIMITS_FIELD_NUMBER: _ClassVar[int]
    WIDTHS_FIELD_NUMBER: _ClassVar[int]
    LANE_IDS_FIELD_NUMBER: _ClassVar[int]
    SIGNALS_FIELD_NUMBER: _ClassVar[int]
    RUNS_FIELD_NUMBER: _ClassVar[int]
    STOP_SIGNS_FIELD_NUMBER: _ClassVar[int]
    line: _containers.RepeatedScalarFieldContainer[float]
    arc: _containers.RepeatedScalarFieldContainer[float]
    speed_limits: _containers.RepeatedScalarFieldContainer[float]
    widths: _containers.RepeatedScalarFieldContainer[float]
    lane_ids: _containers.RepeatedScalarFieldContainer[int]
    signals: _containers.RepeatedCompositeFieldContainer[Signal]
    runs: _containers.RepeatedCompositeFieldContainer[LaneRun]
    stop_signs: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, line: _Optional[_Iterable[float]] = ..., arc: _Optional[_Iterable[float]] = ..., speed_limits: _Optional[_Iterable[float]] = ..., widths: _Optional[_Iterable[float]] = ..., lane_ids: _Optional[_Iterable[int]] = ..., signals: _Optional[_Iterable[_Union[Signal, _Mapping]]] = ..., runs: _Optional[_Iterable[_Union[LaneRun, _Mapping]]] = ..., stop_signs: _Optional[_Iterable[float]] = ...) -> None: ...

class LaneRun(_message.Message):
    __slots__ = ("lane_ids",)
    LANE_IDS_FIELD_NUMBER: _ClassVar[int]
    lane_ids: _containers.RepeatedScalarFieldContainer[int]
    def __init__(self, lane_ids: _Optional[_Iterable[int]] = ...) -> None: ...

class Signal(_message.Message):
    __slots__ = ("s", "lane_id")
    S_FIELD_NUMBER: _ClassVar[int]
    LANE_ID_FIELD_NUMBER: _ClassVar[int]
    s: float
    lane_id: int
    def __init__(self, s: _Optional[float] = ..., lane_id: _Optional[int] = ...) -> None: ...

class Lane(_message.Message):
    __slots__ = ("id", "line", "width", "speed_limit", "successors", "left", "right", "may_change_left", "may_change_right", "in_junction")
    ID_FIELD_NUMBER: _ClassVar[int]
    LINE_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    SPEED_LIMIT_FIELD_NUMBER: _ClassVar[int]
    SUCCESSORS_FIELD_NUMBER: _ClassVar[int]
    LEFT_FIELD_NUMBER: _ClassVar[int]
    RIGHT_FIELD_NUMBER: _ClassVar[int]
    MAY_CHANGE_LEFT_FIELD_NUMBER: _ClassVar[int]
    MAY_CHANGE_RIGHT_FIELD_NUMBER: _ClassVar[int]
    IN_JUNCTION_FIELD_NUMBER: _ClassVar[int]
    id: int
    line: _containers.RepeatedScalarFieldContainer[float]
    width: float
    speed_limit: float
    successors: _containers.RepeatedScalarFieldContainer[int]
    left: int
    right: int
    may_change_left: bool
    may_change_right: bool
    in_junction: bool
    def __init__(self, id: _Optional[int] = ..., line: _Optional[_Iterable[float]] = ..., width: _Optional[float] = ..., speed_limit: _Optional[float] = ..., successors: _Optional[_Iterable[int]] = ..., left: _Optional[int] = ..., right: _Optional[int] = ..., may_change_left: bool = ..., may_change_right: bool = ..., in_junction: bool = ...) -> None: ...

class StepRequest(_message.Message):
    __slots__ = ("run", "time", "step", "ego", "speed", "acceleration", "steer", "route_s", "route_lateral", "objects", "object_sizes", "object_kinds", "object_ids", "light", "light_protected", "light_distance", "speed_limit", "rasters")
    RUN_FIELD_NUMBER: _ClassVar[int]
    TIME_FIELD_NUMBER: _ClassVar[int]
    STEP_FIELD_NUMBER: _ClassVar[int]
    EGO_FIELD_NUMBER: _ClassVar[int]
    SPEED_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    STEER_FIELD_NUMBER: _ClassVar[int]
    ROUTE_S_FIELD_NUMBER: _ClassVar[int]
    ROUTE_LATERAL_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    OBJECT_SIZES_FIELD_NUMBER: _ClassVar[int]
    OBJECT_KINDS_FIELD_NUMBER: _ClassVar[int]
    OBJECT_IDS_FIELD_NUMBER: _ClassVar[int]
    LIGHT_FIELD_NUMBER: _ClassVar[int]
    LIGHT_PROTECTED_FIELD_NUMBER: _ClassVar[int]
    LIGHT_DISTANCE_FIELD_NUMBER: _ClassVar[int]
    SPEED_LIMIT_FIELD_NUMBER: _ClassVar[int]
    RASTERS_FIELD_NUMBER: _ClassVar[int]
    run: str
    time: float
    step: int
    ego: _containers.RepeatedScalarFieldContainer[float]
    speed: float
    acceleration: float
    steer: float
    route_s: float
    route_lateral: float
    objects: _containers.RepeatedScalarFieldContainer[float]
    object_sizes: _containers.RepeatedScalarFieldContainer[float]
    object_kinds: _containers.RepeatedScalarFieldContainer[int]
    object_ids: _containers.RepeatedScalarFieldContainer[int]
    light: Light
    light_protected: bool
    light_distance: float
    speed_limit: float
    rasters: _containers.RepeatedScalarFieldContainer[bytes]
    def __init__(self, run: _Optional[str] = ..., time: _Optional[float] = ..., step: _Optional[int] = ..., ego: _Optional[_Iterable[float]] = ..., speed: _Optional[float] = ..., acceleration: _Optional[float] = ..., steer: _Optional[float] = ..., route_s: _Optional[float] = ..., route_lateral: _Optional[float] = ..., objects: _Optional[_Iterable[float]] = ..., object_sizes: _Optional[_Iterable[float]] = ..., object_kinds: _Optional[_Iterable[int]] = ..., object_ids: _Optional[_Iterable[int]] = ..., light: _Optional[_Union[Light, str]] = ..., light_protected: bool = ..., light_distance: _Optional[float] = ..., speed_limit: _Optional[float] = ..., rasters: _Optional[_Iterable[bytes]] = ...) -> None: ...

class StepReply(_message.Message):
    __slots__ = ("pedals", "acceleration", "pose", "trajectory", "values", "text", "plan")
    class ValuesEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: float
        def __init__(self, key: _Optional[str] = ..., value: _Optional[float] = ...) -> None: ...
    PEDALS_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    TRAJECTORY_FIELD_NUMBER: _ClassVar[int]
    VALUES_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    PLAN_FIELD_NUMBER: _ClassVar[int]
    pedals: Pedals
    acceleration: Acceleration
    pose: Pose
    trajectory: Trajectory
    values: _containers.ScalarMap[str, float]
    text: str
    plan: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, pedals: _Optional[_Union[Pedals, _Mapping]] = ..., acceleration: _Optional[_Union[Acceleration, _Mapping]] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., trajectory: _Optional[_Union[Trajectory, _Mapping]] = ..., values: _Optional[_Mapping[str, float]] = ..., text: _Optional[str] = ..., plan: _Optional[_Iterable[float]] = ...) -> None: ...

class Pedals(_message.Message):
    __slots__ = ("throttle", "brake", "steer")
    THROTTLE_FIELD_NUMBER: _ClassVar[int]
    BRAKE_FIELD_NUMBER: _ClassVar[int]
    STEER_FIELD_NUMBER: _ClassVar[int]
    throttle: float
    brake: float
    steer: float
    def __init__(self, throttle: _Optional[float] = ..., brake: _Optional[float] = ..., steer: _Optional[float] = ...) -> None: ...

class Acceleration(_message.Message):
    __slots__ = ("acceleration", "steer")
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    STEER_FIELD_NUMBER: _ClassVar[int]
    acceleration: float
    steer: float
    def __init__(self, acceleration: _Optional[float] = ..., steer: _Optional[float] = ...) -> None: ...

class Pose(_message.Message):
    __slots__ = ("x", "y", "yaw", "speed")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    YAW_FIELD_NUMBER: _ClassVar[int]
    SPEED_FIELD_NUMBER: _ClassVar[int]
    x: float
    y: float
    yaw: float
    speed: float
    def __init__(self, x: _Optional[float] = ..., y: _Optional[float] = ..., yaw: _Optional[float] = ..., speed: _Optional[float] = ...) -> None: ...

class Trajectory(_message.Message):
    __slots__ = ("points",)
    POINTS_FIELD_NUMBER: _ClassVar[int]
    points: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, points: _Optional[_Iterable[float]] = ...) -> None: ...
