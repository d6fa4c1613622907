"""Driven paths as an OpenSCENARIO file: every entity follows a trajectory with times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_DATE = "2026-01-01T00:00:00"  # the same input gives the same bytes
_CATEGORIES = {1: "car", 2: "truck", 3: "motorbike", 4: "bicycle"}
_PEDESTRIAN = 5


@dataclass(frozen=True, slots=True, eq=False)
class DrivenEntity:
    """A road user that was there at *times* (s): its *class* as ``actor_class`` counts, size in m, poses in m and rad.

    *x* and *y* are those of the middle of its box, *z* is that of the road below it.
    """

    name: str
    class_: int
    size: tuple[float, float, float]
    times: Floats
    x: Floats
    y: Floats
    z: Floats
    heading: Floats


def scenario_text(entities: Sequence[DrivenEntity], road: str, title: str) -> str:
    """An OpenSCENARIO 1.2 file on the road network *road*, whose stop trigger is true at the last time of all.

    A road user that is there from the start is placed at the start; another one is added and deleted at its times.
    """
    end = max(float(each.times[-1]) for each in entities)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        "<OpenSCENARIO>",
        f'  <FileHeader revMajor="1" revMinor="2" date="{_DATE}" author="dse" description={quoteattr(title)}/>',
        "  <ParameterDeclarations/>",
        "  <CatalogLocations/>",
        f"  <RoadNetwork><LogicFile filepath={quoteattr(road)}/></RoadNetwork>",
        "  <Entities>",
        *(f"    {line}" for each in entities for line in _object(each)),
        "  </Entities>",
        "  <Storyboard>",
        "    <Init><Actions>",
        *(f"      {line}" for each in entities if each.times[0] <= 0 for line in _start(each)),
        "    </Actions></Init>",
        '    <Story name="driven">',
        *(f"      {line}" for each in entities for line in _act(each, end)),
        "    </Story>",
        f"    <StopTrigger>{_at_time('end', end)}</StopTrigger>",
        "  </Storyboard>",
        "</OpenSCENARIO>",
        "",
    ]
    return "\n".join(lines)


def _object(each: DrivenEntity) -> Iterator[str]:
    length, width, height = each.size
    box = (
        f'<BoundingBox><Center x="0" y="0" z="{height / 2:.6g}"/>'
        f'<Dimensions length="{length:.6g}" width="{width:.6g}" height="{height:.6g}"/></BoundingBox>'
    )
    yield f"<ScenarioObject name={quoteattr(each.name)}>"
    if each.class_ in _CATEGORIES:
        axle = 'maxSteering="0.5" wheelDiameter="0.65" trackWidth="1.5" positionZ="0.32"'
        yield f'  <Vehicle name="{_CATEGORIES[each.class_]}" vehicleCategory="{_CATEGORIES[each.class_]}">{box}'
        yield '    <Performance maxSpeed="100" maxAcceleration="20" maxDeceleration="20"/>'
        # Players place the rear axle where the position is, and move the box with it: so its middle is there.
        front = f'{axle} positionX="{0.4 * length:.6g}"'
        yield f'    <Axles><FrontAxle {front}/><RearAxle {axle} positionX="0"/></Axles>'
        yield "    <Properties/></Vehicle>"
    elif each.class_ == _PEDESTRIAN:
        kind = 'name="pedestrian" mass="75" pedestrianCategory="pedestrian" model="pedestrian"'
        yield f"  <Pedestrian {kind}>{box}<Properties/></Pedestrian>"
    else:
        kind = 'name="obstacle" mass="100" miscObjectCategory="obstacle"'
        yield f"  <MiscObject {kind}>{box}<Properties/></MiscObject>"
    yield "</ScenarioObject>"


def _position(each: DrivenEntity, row: int) -> str:
    place = f'x="{each.x[row]:.6f}" y="{each.y[row]:.6f}" z="{each.z[row]:.6f}" h="{each.heading[row]:.6f}"'
    return f"<Position><WorldPosition {place}/></Position>"


def _start(each: DrivenEntity) -> Iterator[str]:
    yield f"<Private entityRef={quoteattr(each.name)}>"
    yield f"  <PrivateAction><TeleportAction>{_position(each, 0)}</TeleportAction></PrivateAction>"
    yield f"  <PrivateAction>{''.join(_trajectory(each))}</PrivateAction>"
    yield "</Private>"


def _trajectory(each: DrivenEntity) -> Iterator[str]:
    yield "<RoutingAction><FollowTrajectoryAction>"
    yield f'<TrajectoryRef><Trajectory name={quoteattr(each.name)} closed="false"><Shape><Polyline>'
    for row, time in enumerate(each.times):
        yield f'\n        <Vertex time="{time:.6f}">{_position(each, row)}</Vertex>'
    yield "</Polyline></Shape></Trajectory></TrajectoryRef>"
    yield '<TimeReference><Timing domainAbsoluteRelative="absolute" scale="1" offset="0"/></TimeReference>'
    yield '<TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction>'


def _at_time(name: str, time: float) -> str:
    condition = f'<SimulationTimeCondition value="{time:.6f}" rule="greaterOrEqual"/>'
    return (
        f'<ConditionGroup><Condition name={quoteattr(name)} delay="0" conditionEdge="none">'
        f"<ByValueCondition>{condition}</ByValueCondition></Condition></ConditionGroup>"
    )


def _act(each: DrivenEntity, end: float) -> Iterator[str]:
    """Events of a road user that is not there from the start to the end."""
    events = []
    reference = quoteattr(each.name)
    if each.times[0] > 0:
        added = f"<AddEntityAction>{_position(each, 0)}</AddEntityAction>"
        add = f"<EntityAction entityRef={reference}>{added}</EntityAction>"
        actions = [
            f"<GlobalAction>{add}</GlobalAction>",
            f"<PrivateAction>{''.join(_trajectory(each))}</PrivateAction>",
        ]
        events.append(("appears", float(each.times[0]), actions))
    if each.times[-1] < end:
        delete = f"<EntityAction entityRef={reference}><DeleteEntityAction/></EntityAction>"
        events.append(("disappears", float(each.times[-1]), [f"<GlobalAction>{delete}</GlobalAction>"]))
    if not events:
        return
    yield f"<Act name={reference}>"
    yield f'  <ManeuverGroup name={reference} maximumExecutionCount="1">'
    yield f'    <Actors selectTriggeringEntities="false"><EntityRef entityRef={reference}/></Actors>'
    yield f"    <Maneuver name={reference}>"
    for name, time, actions in events:
        yield f'      <Event name={quoteattr(f"{each.name} {name}")} priority="parallel">'
        for number, action in enumerate(actions):
            yield f"        <Action name={quoteattr(f'{each.name} {name} {number}')}>{action}</Action>"
        yield f"        <StartTrigger>{_at_time(name, time)}</StartTrigger>"
        yield "      </Event>"
    yield "    </Maneuver>"
    yield "  </ManeuverGroup>"
    yield f"  <StartTrigger>{_at_time('start', 0.0)}</StartTrigger>"
    yield "</Act>"
