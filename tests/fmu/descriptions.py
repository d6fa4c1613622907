"""Descriptions that use most of what each version of FMI offers; tests take them apart."""

from __future__ import annotations

FMI_1 = """<?xml version="1.0" encoding="ISO-8859-1"?>
<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="{g}" numberOfContinuousStates="1"
  numberOfEventIndicators="0" generationTool="Maker">
  <UnitDefinitions>
    <BaseUnit unit="rad"><DisplayUnitDefinition displayUnit="deg" gain="57.29"/></BaseUnit>
  </UnitDefinitions>
  <TypeDefinitions>
    <Type name="Angle"><RealType unit="rad" min="-1" max="1" nominal="0.1"/></Type>
    <Type name="Gear"><EnumerationType><Item name="P"/><Item name="D"/></EnumerationType></Type>
  </TypeDefinitions>
  <DefaultExperiment startTime="0" stopTime="2" tolerance="1e-4"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="1" causality="input">
      <Real declaredType="Angle" start="0"/>
    </ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/>
      <DirectDependency><Name>u</Name><Name>k</Name></DirectDependency>
    </ScalarVariable>
    <ScalarVariable name="z" valueReference="2" causality="output" alias="negatedAlias"><Real/>
      <DirectDependency/>
    </ScalarVariable>
    <ScalarVariable name="w" valueReference="2" alias="alias"><Real/></ScalarVariable>
    <ScalarVariable name="gear" valueReference="5" causality="input">
      <Enumeration declaredType="Gear" start="2"/>
    </ScalarVariable>
    <ScalarVariable name="k" valueReference="6" variability="parameter"><Real start="3"/></ScalarVariable>
    <ScalarVariable name="2k" valueReference="7" variability="parameter"><Real/></ScalarVariable>
    <ScalarVariable name="pi" valueReference="8" variability="constant"><Real start="3.14"/></ScalarVariable>
    <ScalarVariable name="on" valueReference="9" causality="none"><Boolean/></ScalarVariable>
    <ScalarVariable name="text" valueReference="9" causality="output"><String/></ScalarVariable>
  </ModelVariables>
  <Implementation>
    <CoSimulation_StandAlone>
      <Capabilities canHandleVariableCommunicationStepSize="true" canInterpolateInputs="true"/>
    </CoSimulation_StandAlone>
  </Implementation>
</fmiModelDescription>
"""

FMI_2 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{g}" generationTool="Maker 1.0" numberOfEventIndicators="2">
  <ModelExchange modelIdentifier="m_me" providesDirectionalDerivative="true" completedIntegratorStepNotNeeded="true"/>
  <CoSimulation modelIdentifier="m" canBeInstantiatedOnlyOncePerProcess="true" canInterpolateInputs="1"/>
  <UnitDefinitions>
    <Unit name="km/h"><BaseUnit m="1" s="-1" factor="0.2777777777777778"/></Unit>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
    <Unit name="EUR"/>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Speed"><Real unit="km/h" min="0" max="200" nominal="100"/></SimpleType>
    <SimpleType name="Gear"><Enumeration><Item name="P" value="-1"/><Item name="D" value="4"/></Enumeration>
    </SimpleType>
  </TypeDefinitions>
  <DefaultExperiment startTime="1" stopTime="5" stepSize="0.002" tolerance="1e-5"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="v" valueReference="2" causality="output">
      <Real declaredType="Speed" max="90"/>
    </ScalarVariable>
    <ScalarVariable name="x" valueReference="3"><Real unit="m" start="2.5" relativeQuantity="true"/></ScalarVariable>
    <ScalarVariable name="der(x)" valueReference="4"><Real derivative="3"/></ScalarVariable>
    <ScalarVariable name="gear" valueReference="0" causality="input">
      <Enumeration declaredType="Gear" start="4"/>
    </ScalarVariable>
    <ScalarVariable name="file" valueReference="0" causality="parameter"><String start=" a b.txt"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="5" causality="parameter" variability="tunable" description="gain">
      <Real start="1"/>
    </ScalarVariable>
    <ScalarVariable name="n" valueReference="6" variability="continuous"><Integer/></ScalarVariable>
    <ScalarVariable name="w" valueReference="7" causality="output" initial="exact"><Boolean start="1"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>
      <Unknown index="2" dependencies="1 3" dependenciesKind="dependent constant"/>
      <Unknown index="9"/>
    </Outputs>
    <Derivatives><Unknown index="4" dependencies="1"/></Derivatives>
    <InitialUnknowns><Unknown index="2" dependencies="1 7"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""

FMI_3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="m" description="The model" instantiationToken="{g}">
  <ModelExchange modelIdentifier="m" needsCompletedIntegratorStep="true"/>
  <CoSimulation modelIdentifier="m" fixedInternalStepSize="0.01" canGetAndSetFMUState="true" hasEventMode="true"
    mightReturnEarlyFromDoStep="true" providesIntermediateUpdate="true" providesDirectionalDerivatives="true"/>
  <TypeDefinitions>
    <Float64Type name="Length" unit="m"/>
    <EnumerationType name="Mode"><Item name="off" value="0"/><Item name="far" value="5000000000"/></EnumerationType>
    <ClockType name="Tick" intervalVariability="triggered"/>
  </TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" start="2"/>
    <Int8 name="three" valueReference="2" variability="constant" start="3"/>
    <Float64 name="u" valueReference="3" causality="input" start="1 2 3 4 5 6" intermediateUpdate="true">
      <Dimension valueReference="1"/><Dimension valueReference="2"/>
      <Alias name="other u" description="another name"/>
    </Float64>
    <Float64 name="x" valueReference="4" causality="output" declaredType="Length" start="0" initial="exact">
      <Dimension valueReference="1"/><Alias name="y"/>
    </Float64>
    <Float64 name="der(x)" valueReference="5" derivative="4"><Dimension valueReference="1"/></Float64>
    <Float32 name="f" valueReference="6" start="0.5"/>
    <UInt16 name="i" valueReference="7" causality="output"/>
    <Boolean name="b" valueReference="8" causality="parameter" start="true false"><Dimension start="2"/></Boolean>
    <String name="s" valueReference="9" causality="parameter">
      <Dimension start="2"/><Start value="a b"/><Start value=""/>
    </String>
    <Binary name="d" valueReference="10" causality="input"><Start value="00fF"/></Binary>
    <Enumeration name="e" valueReference="11" causality="input" declaredType="Mode" start="5000000000"/>
    <Clock name="tick" valueReference="12" causality="input" declaredType="Tick" intervalVariability="triggered"/>
    <Float64 name="sampled" valueReference="13" clocks="12" variability="discrete"/>
    <Float64 name="z" valueReference="14"><Dimension valueReference="1"/></Float64>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="4" dependencies=""/>
    <Output valueReference="7" dependencies="3 6" dependenciesKind="dependent dependent"/>
    <ContinuousStateDerivative valueReference="5"/>
    <InitialUnknown valueReference="7" dependencies="8 11"/>
    <EventIndicator valueReference="14"/>
  </ModelStructure>
</fmiModelDescription>
"""
