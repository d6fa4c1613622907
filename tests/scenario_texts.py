"""OpenSCENARIO as the tests write it: short, with what each of them is about."""

from __future__ import annotations

from collections.abc import Mapping

HEADER = '<FileHeader revMajor="1" revMinor="2" date="2026-11-28T00:00:00" description="" author=""/>'


def declared(**parameters: object) -> str:
    """Parameters of type double, or string if the value is a text that is no expression."""
    types = {
        name: "string" if isinstance(value, str) and value[:1] != "$" else "double"
        for name, value in parameters.items()
    }
    return "".join(
        f'<ParameterDeclaration name="{name}" parameterType="{types[name]}" value="{value}"/>\n'
        for name, value in parameters.items()
    )


def car(name: str, length: float = 4.0, centre: float = 1.0) -> str:
    """An entity without limits of its speed."""
    box = f'<Center x="{centre}" y="0" z="0.75"/><Dimensions width="2" length="{length}" height="1.5"/>'
    vehicle = f'<Vehicle name="car" vehicleCategory="car"><BoundingBox>{box}</BoundingBox></Vehicle>'
    return f'<ScenarioObject name="{name}">{vehicle}</ScenarioObject>\n'


def lane(s: object, lane: object = -1, road: object = 0, offset: object = 0) -> str:
    return f'<Position><LanePosition roadId="{road}" laneId="{lane}" s="{s}" offset="{offset}"/></Position>'


def world(x: object, y: object, h: object = 0) -> str:
    return f'<Position><WorldPosition x="{x}" y="{y}" h="{h}"/></Position>'


def teleport(position: str) -> str:
    return f"<PrivateAction><TeleportAction>{position}</TeleportAction></PrivateAction>"


def speed(target: object, shape: str = "step", value: object = 0, dimension: str = "time") -> str:
    dynamics = f'<SpeedActionDynamics dynamicsShape="{shape}" dynamicsDimension="{dimension}" value="{value}"/>'
    wanted = f'<SpeedActionTarget><AbsoluteTargetSpeed value="{target}"/></SpeedActionTarget>'
    return _action("LongitudinalAction", "SpeedAction", dynamics + wanted)


def lane_change(lane: int, shape: str = "sinusoidal", value: object = 4, dimension: str = "time") -> str:
    dynamics = f'<LaneChangeActionDynamics dynamicsShape="{shape}" dynamicsDimension="{dimension}" value="{value}"/>'
    target = f'<LaneChangeTarget><AbsoluteTargetLane value="{lane}"/></LaneChangeTarget>'
    return _action("LateralAction", "LaneChangeAction", dynamics + target)


def trajectory(shape: str, timing: str = "<None/>") -> str:
    line = f'<Trajectory name="line" closed="false"><Shape>{shape}</Shape></Trajectory>'
    mode = f'<TimeReference>{timing}</TimeReference><TrajectoryFollowingMode followingMode="position"/>'
    return _action("RoutingAction", "FollowTrajectoryAction", line + mode)


def _action(group: str, tag: str, inside: str) -> str:
    return f"<PrivateAction><{group}><{tag}>{inside}</{tag}></{group}></PrivateAction>"


def private(entity: str, *actions: str) -> str:
    """What an entity does in the init of the storyboard."""
    return f'<Private entityRef="{entity}">{"".join(actions)}</Private>\n'


def after(time: object) -> str:
    return by_value(f'<SimulationTimeCondition value="{time}" rule="greaterOrEqual"/>')


def by_entity(entity: str, condition: str) -> str:
    who = f'<TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="{entity}"/></TriggeringEntities>'
    return trigger(f"<ByEntityCondition>{who}<EntityCondition>{condition}</EntityCondition></ByEntityCondition>")


def by_value(condition: str) -> str:
    return trigger(f"<ByValueCondition>{condition}</ByValueCondition>")


def trigger(condition: str, tag: str = "StartTrigger") -> str:
    inside = f'<Condition name="c" delay="0" conditionEdge="none">{condition}</Condition>'
    return f"<{tag}><ConditionGroup>{inside}</ConditionGroup></{tag}>"


def event(name: str, action: str, start: str = "") -> str:
    return f'<Event name="{name}" priority="parallel"><Action name="{name}Action">{action}</Action>{start}</Event>\n'


def story(actor: str, *events: str, group: str = "") -> str:
    """A story of one act, which starts at 0 s, with a group for *actor*."""
    actors = f'<Actors selectTriggeringEntities="false"><EntityRef entityRef="{actor}"/></Actors>'
    maneuver = f'<Maneuver name="{actor}M">{"".join(events)}</Maneuver>' if events else ""
    inside = f'<ManeuverGroup name="{actor}G" maximumExecutionCount="1">{actors}{group}{maneuver}</ManeuverGroup>'
    return f'<Story name="{actor}S"><Act name="{actor}A">{inside}{after(0)}</Act></Story>\n'


def scenario(
    entities: str = "", init: str = "", stories: str = "", *, parameters: str = "", road: str = "", catalogs: str = "",
    more: str = "",
) -> str:  # fmt: skip
    """A scenario file; *road* is the path of the road network, *more* the stop trigger."""
    network = f'<RoadNetwork><LogicFile filepath="{road}"/></RoadNetwork>' if road else "<RoadNetwork/>"
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<OpenSCENARIO>
{HEADER}
<ParameterDeclarations>
{parameters}</ParameterDeclarations>
<CatalogLocations>{catalogs}</CatalogLocations>
{network}
<Entities>
{entities}</Entities>
<Storyboard>
<Init><Actions>
{init}</Actions></Init>
{stories}{more or "<StopTrigger/>"}
</Storyboard>
</OpenSCENARIO>
"""


def catalog(name: str, *entries: str) -> str:
    return f'<OpenSCENARIO>{HEADER}<Catalog name="{name}">{"".join(entries)}</Catalog></OpenSCENARIO>'


def variation(scenario: str, *distributions: str, stochastic: int = 0) -> str:
    """A file that distributes the parameters of *scenario*; *stochastic* is its number of runs, 0: deterministic."""
    inside = "".join(f"{each}\n" for each in distributions)
    tag, runs = ("Stochastic", f' numberOfTestRuns="{stochastic}"') if stochastic else ("Deterministic", "")
    file = f'<ScenarioFile filepath="{scenario}"/>'
    definition = f"<ParameterValueDistribution>\n{file}\n<{tag}{runs}>\n{inside}</{tag}>\n</ParameterValueDistribution>"
    return f"<OpenSCENARIO>\n{HEADER}\n{definition}\n</OpenSCENARIO>\n"


def listed(name: str, *values: object) -> str:
    elements = "".join(f'<Element value="{value}"/>' for value in values)
    return single(name, f"<DistributionSet>{elements}</DistributionSet>")


def ranged(name: str, low: object, high: object, step: object) -> str:
    limits = f'<Range lowerLimit="{low}" upperLimit="{high}"/>'
    return single(name, f'<DistributionRange stepWidth="{step}">{limits}</DistributionRange>')


def single(name: str, inside: str) -> str:
    tag = "DeterministicSingleParameterDistribution"
    return f'<{tag} parameterName="{name}">{inside}</{tag}>'


def together(*sets: Mapping[str, object]) -> str:
    """Sets of values of several parameters."""
    inside = "".join(
        "<ParameterValueSet>"
        + "".join(f'<ParameterAssignment parameterRef="{name}" value="{value}"/>' for name, value in each.items())
        + "</ParameterValueSet>"
        for each in sets
    )
    tag = "DeterministicMultiParameterDistribution"
    return f"<{tag}><ValueSetDistribution>{inside}</ValueSetDistribution></{tag}>"


def stochastic(name: str, inside: str) -> str:
    return f'<StochasticDistribution parameterName="{name}">{inside}</StochasticDistribution>'
