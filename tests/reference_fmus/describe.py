"""modelDescription.xml of the reference FMUs, for each version of FMI."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from xml.sax.saxutils import quoteattr

from reference_fmus.declared import Declared, Numbered, ReferenceModel, numbered

FMI2_NAMES = {"Float64": "Real", "Int32": "Integer", "Enumeration": "Enumeration"}
BOTH = ("CoSimulation", "ModelExchange")


def description(model: ReferenceModel, version: int, interfaces: Sequence[str], token: str) -> str:
    """The XML text; *interfaces* in FMI's words."""
    write = {1: _fmi1, 2: _fmi2, 3: _fmi3}[version]
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + "\n".join(write(model, interfaces, token)) + "\n"


def _tag(element: str, /, **attributes: object) -> str:
    """A tag without its angle brackets; attributes that are None are left out."""
    return " ".join([element, *(f"{key}={quoteattr(_text(x))}" for key, x in attributes.items() if x is not None)])


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, float) else str(value)


def _leaf(element: str, /, **attributes: object) -> str:
    return f"<{_tag(element, **attributes)}/>"


def _node(head: str, children: Iterable[str]) -> list[str]:
    inner = [f"  {line}" for line in children]
    return [f"<{head}>", *inner, f"</{head.split(maxsplit=1)[0]}>"] if inner else [f"<{head}/>"]


def _units(model: ReferenceModel) -> list[str]:
    return _node(
        "UnitDefinitions",
        chain(
            *(
                _node(_tag("Unit", name=u.name), [_leaf("BaseUnit", **u.exponents, factor=u.factor)])
                for u in model.units
            )
        ),
    )


def _experiment(model: ReferenceModel) -> str:
    return _leaf("DefaultExperiment", startTime=0.0, stopTime=model.stop, stepSize=model.step)


def _type_name(variable: Declared) -> str:
    return f"{variable.name.split('_')[0]}Options"


def _enumerations(variables: Sequence[Numbered]) -> dict[str, Declared]:
    return {_type_name(v.declared): v.declared for v in variables if v.declared.items}


# FMI 1.0: a slave of its own ("stand alone"), no model structure.


def _fmi1(model: ReferenceModel, interfaces: Sequence[str], token: str) -> list[str]:
    if list(interfaces) != ["CoSimulation"]:
        raise ValueError("the reference FMUs of FMI 1.0 are for co-simulation")
    variables = numbered(model, 1)
    states = sum(bool(n.declared.derivative_of) for n in variables)
    head = _tag(
        "fmiModelDescription",
        fmiVersion="1.0",
        modelName=model.name,
        modelIdentifier=model.name,
        guid=token,
        description=model.description,
        variableNamingConvention="structured",
        numberOfContinuousStates=states,
        numberOfEventIndicators=len(model.indicators),
    )
    types = chain(
        *(
            _node(
                _tag("Type", name=name),
                # FMI 1.0 has no values of its own for items: they are numbered from 1.
                _node(_tag("EnumerationType", min=1, max=len(v.items)), [_leaf("Item", name=i) for i in v.items]),
            )
            for name, v in _enumerations(variables).items()
        )
    )
    units = [_leaf("BaseUnit", unit=u.name) for u in model.units]
    return _node(
        head,
        chain(
            _node("UnitDefinitions", units) if units else [],
            _node("TypeDefinitions", types) if _enumerations(variables) else [],
            [_leaf("DefaultExperiment", startTime=0.0, stopTime=model.stop)],
            _node("ModelVariables", chain(*(_fmi1_variable(n) for n in variables))),
            _node(
                "Implementation",
                _node(
                    "CoSimulation_StandAlone",
                    [
                        _leaf(
                            "Capabilities",
                            canHandleVariableCommunicationStepSize=True,
                            canHandleEvents=True,
                            maxOutputDerivativeOrder=0,
                        )
                    ],
                ),
            ),
        ),
    )


def _fmi1_variable(numbered_one: Numbered) -> list[str]:
    variable = numbered_one.declared
    is_parameter = variable.causality in {"parameter", "calculatedParameter"}
    causality = variable.causality if variable.causality in {"input", "output"} else "internal"
    has_start = variable.has_start
    typed = _leaf(
        FMI2_NAMES.get(variable.type, variable.type),
        declaredType=_type_name(variable) if variable.items else None,
        unit=variable.unit or None,
        start=_start(variable) if has_start else None,
        fixed=True if has_start and causality != "input" else None,
    )
    return _node(
        _tag(
            "ScalarVariable",
            name=variable.name,
            valueReference=numbered_one.reference,
            variability="parameter" if is_parameter else variable.variability,
            causality=causality,
        ),
        [typed],
    )


def _start(variable: Declared) -> str | None:
    return variable.start[0] if variable.start else None


# FMI 2.0


def _fmi2(model: ReferenceModel, interfaces: Sequence[str], token: str) -> list[str]:
    variables = numbered(model, 2)
    head = _tag(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model.name,
        guid=token,
        description=model.description,
        variableNamingConvention="structured",
        numberOfEventIndicators=len(model.indicators),
    )
    common = {
        "modelIdentifier": model.name,
        "canGetAndSetFMUstate": True,
        "canSerializeFMUstate": True,
        "providesDirectionalDerivative": model.partial_derivatives,
    }
    elements = {
        "ModelExchange": _leaf("ModelExchange", **common),
        "CoSimulation": _leaf("CoSimulation", canHandleVariableCommunicationStepSize=True, **common),
    }
    types = chain(
        *(
            _node(
                _tag("SimpleType", name=name),
                _node("Enumeration", [_leaf("Item", name=i, value=value) for i, value in v.items.items()]),
            )
            for name, v in _enumerations(variables).items()
        )
    )
    return _node(
        head,
        chain(
            [elements[name] for name in sorted(interfaces, reverse=True)],
            _units(model) if model.units else [],
            _node("TypeDefinitions", types) if _enumerations(variables) else [],
            _node("LogCategories", [_leaf("Category", name="logStatusError")]),
            [_experiment(model)],
            _node("ModelVariables", chain(*(_fmi2_variable(n, variables) for n in variables))),
            _node("ModelStructure", _fmi2_structure(model, variables)),
        ),
    )


def _fmi2_variable(numbered_one: Numbered, variables: Sequence[Numbered]) -> list[str]:
    variable = numbered_one.declared
    typed = _leaf(
        FMI2_NAMES.get(variable.type, variable.type),
        declaredType=_type_name(variable) if variable.items else None,
        unit=variable.unit or None,
        min=variable.minimum,
        start=_start(variable) if variable.has_start else None,
        derivative=_index(variables, _state_of(variable)) if variable.derivative_of else None,
    )
    return _node(
        _tag(
            "ScalarVariable",
            name=variable.name,
            valueReference=numbered_one.reference,
            causality=variable.causality,
            variability=variable.variability,
            initial=variable.initial or None,
        ),
        [typed],
    )


def _state_of(variable: Declared) -> str:
    """der(x[2]) is the derivative of x[2]."""
    return variable.name.removeprefix("der(").removesuffix(")")


def _index(variables: Sequence[Numbered], name: str) -> int:
    return next(i for i, n in enumerate(variables, start=1) if n.declared.name == name)


def _fmi2_structure(model: ReferenceModel, variables: Sequence[Numbered]) -> Iterable[str]:
    def unknowns(tag: str, chosen: Iterable[Numbered], initially: bool) -> list[str]:
        found = [
            _leaf(
                "Unknown",
                index=_index(variables, n.declared.name),
                dependencies=_fmi2_depends(n.declared, variables, initially),
            )
            for n in chosen
        ]
        return _node(tag, found) if found else []

    outputs = [n for n in variables if n.declared.causality == "output"]
    derivatives = [n for n in variables if n.declared.derivative_of]
    first = [
        n
        for n in variables
        if n.declared.initial == "calculated" and (n in outputs or n in derivatives or _is_state_or_parameter(n, model))
    ]
    return chain(
        unknowns("Outputs", outputs, False),
        unknowns("Derivatives", derivatives, False),
        unknowns("InitialUnknowns", first, True),
    )


def _is_state_or_parameter(numbered_one: Numbered, model: ReferenceModel) -> bool:
    stem = numbered_one.declared.name.split("[")[0]
    states = {v.derivative_of for v in model.variables if v.derivative_of}
    return stem in states or numbered_one.declared.causality == "calculatedParameter"


def _fmi2_depends(variable: Declared, variables: Sequence[Numbered], initially: bool) -> str | None:
    """Indices; None for all there are. While running, dependencies are on inputs and states only."""
    if variable.depends is None:
        return None
    by_stem = [(n.declared.name.split("[")[0], n.declared) for n in variables]
    names = [v.name for stem, v in by_stem if stem in variable.depends and _counts(v, variables, initially)]
    # Of an array's value, only the value at the same place counts.
    place = variable.name.partition("[")[2]
    chosen = [name for name in names if not place or name.endswith(place)]
    return " ".join(str(_index(variables, name)) for name in chosen)


def _counts(variable: Declared, variables: Sequence[Numbered], initially: bool) -> bool:
    states = {_state_of(n.declared) for n in variables if n.declared.derivative_of}
    running = variable.causality == "input" or variable.name in states
    return running or (initially and variable.causality == "parameter")


# FMI 3.0


def _fmi3(model: ReferenceModel, interfaces: Sequence[str], token: str) -> list[str]:
    variables = numbered(model, 3)
    head = _tag(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=model.name,
        instantiationToken=token,
        description=model.description,
        variableNamingConvention="structured",
    )
    common = {
        "modelIdentifier": model.name,
        "canGetAndSetFMUState": True,
        "canSerializeFMUState": True,
        "providesDirectionalDerivatives": model.partial_derivatives,
    }
    elements = {
        "ModelExchange": _leaf("ModelExchange", **common),
        "CoSimulation": _leaf(
            "CoSimulation",
            **common,
            canHandleVariableCommunicationStepSize=True,
            providesIntermediateUpdate=True,
            mightReturnEarlyFromDoStep=model.event_mode,
            canReturnEarlyAfterIntermediateUpdate=True,
            hasEventMode=model.event_mode,
            fixedInternalStepSize=model.step / 10,
        ),
    }
    types = chain(
        *(
            _node(
                _tag("EnumerationType", name=name),
                [_leaf("Item", name=i, value=value) for i, value in v.items.items()],
            )
            for name, v in _enumerations(variables).items()
        )
    )
    return _node(
        head,
        chain(
            [elements[name] for name in sorted(interfaces, reverse=True)],
            _units(model) if model.units else [],
            _node("TypeDefinitions", types) if _enumerations(variables) else [],
            _node("LogCategories", [_leaf("Category", name="logStatusError")]),
            [_experiment(model)],
            _node("ModelVariables", chain(*(_fmi3_variable(n, variables) for n in variables))),
            _node("ModelStructure", _fmi3_structure(model, variables)),
        ),
    )


def _fmi3_variable(numbered_one: Numbered, variables: Sequence[Numbered]) -> list[str]:
    variable = numbered_one.declared
    spelled_out = variable.type in {"String", "Binary"}
    intermediate = variable.type.startswith("Float") and variable.variability == "continuous"
    head = _tag(
        variable.type,
        name=variable.name,
        valueReference=numbered_one.reference,
        causality=variable.causality,
        variability=variable.variability,
        initial=variable.initial or None,
        intermediateUpdate=True if intermediate and variable.causality in {"input", "output"} else None,
        declaredType=_type_name(variable) if variable.items else None,
        unit=variable.unit or None,
        min=variable.minimum,
        start=" ".join(variable.start) if variable.has_start and not spelled_out else None,
        derivative=_reference(variables, variable.derivative_of) if variable.derivative_of else None,
    )
    sizes = [
        _leaf("Dimension", start=s)
        if isinstance(s, int)
        else _leaf("Dimension", valueReference=_reference(variables, s))
        for s in variable.shape
    ]
    starts = [_leaf("Start", value=text) for text in variable.start] if variable.has_start and spelled_out else []
    return _node(head, [*sizes, *starts])


def _reference(variables: Sequence[Numbered], name: str) -> int:
    return next(n.reference for n in variables if n.declared.name == name)


def _fmi3_structure(model: ReferenceModel, variables: Sequence[Numbered]) -> list[str]:
    def unknown(tag: str, n: Numbered, initially: bool) -> str:
        depends = n.declared.depends
        if depends is None:
            return _leaf(tag, valueReference=n.reference)
        chosen = [k for k in variables if k.declared.name in depends and _counts(k.declared, variables, initially)]
        return f'<{tag} valueReference="{n.reference}" dependencies="{" ".join(str(k.reference) for k in chosen)}"/>'

    outputs = [n for n in variables if n.declared.causality == "output"]
    derivatives = [n for n in variables if n.declared.derivative_of]
    first = [
        n
        for n in variables
        if n.declared.initial == "calculated" and (n in outputs or n in derivatives or _is_state_or_parameter(n, model))
    ]
    return [
        *(unknown("Output", n, False) for n in outputs),
        *(unknown("ContinuousStateDerivative", n, False) for n in derivatives),
        *(unknown("InitialUnknown", n, True) for n in first),
        *(
            f'<EventIndicator valueReference="{n.reference}"/>'
            for n in variables
            if n.declared.name in model.indicators
        ),
    ]
