"""The trajectory message of line-marking robots, as JSON."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from optplan.schema.base import Model, Point


class LineModel(Model):
    """A straight line, m."""

    start: Point
    end: Point


class ArcModel(Model):
    """An arc: m and rad, left positive."""

    start: Point
    center: Point
    sweep_angle: float


class ClothoidModel(Model):
    """A piece whose curvature grows linearly: m, rad, 1/m, 1/m^2, m."""

    start: Point
    heading: float
    curvature: float
    sharpness: float
    length: float = Field(gt=0)


class CurveKind(Model):
    """0 none, 1 line, 2 arc, 3 clothoid (only where it was asked for)."""

    value: Literal[0, 1, 2, 3]


class CurveModel(Model):
    """What a segment is; the list that its type names holds one entry, the others none."""

    type: CurveKind
    line: list[LineModel] = Field(default_factory=list, max_length=1)
    arc: list[ArcModel] = Field(default_factory=list, max_length=1)
    clothoid: list[ClothoidModel] | None = Field(None, max_length=1)


class DirectionModel(Model):
    """1 forwards, -1 backwards, 0 on the spot."""

    value: Literal[-1, 0, 1]


class SegmentModel(Model):
    """A piece of the path of the robot's reference point."""

    id: int = Field(ge=0)
    label: str
    curve: CurveModel
    direction: DirectionModel


class PathModel(Model):
    """Segments in driving order, each beginning where the one before ends."""

    segments: list[SegmentModel]


class ActuationKind(Model):
    """0 none, 1 pump, 2 valve, 3 spray, 4 disc, 7 all."""

    value: int = Field(ge=0, le=127)


class ActuationModel(Model):
    """From this arc length on, m."""

    arc_length: float = Field(ge=0)
    actuation: ActuationKind


class ActuationProfile(Model):
    """Changes of the tool in order."""

    parameters: list[ActuationModel]


class VelocityKind(Model):
    """0 none, 1 linear (m/s), 2 angular (rad/s)."""

    value: Literal[0, 1, 2]


class SpeedModel(Model):
    """A speed; linear ones change evenly with time from one entry to the next."""

    type: VelocityKind
    value: float = Field(ge=0)


class VelocityModel(Model):
    """At this arc length, m."""

    arc_length: float = Field(ge=0)
    velocity: SpeedModel


class VelocityProfile(Model):
    """Speeds in driving order."""

    parameters: list[VelocityModel]


class TrajectoryMessage(Model):
    """A trajectory for a robot that follows lines and arcs."""

    path: PathModel
    actuation_profile: ActuationProfile
    velocity_profile: VelocityProfile
