/* The FMI functions that go over the bridge, and how: FMI 2.0.4, chapters 2 to 4, and FMI 3.0.1, chapters 2 to 4.
 *
 * A letter for each parameter: i 64 bits as they are, n 32 bits, b a byte, d a double, s a string, u where the resources
 * are; L callbacks of FMI 2; G environment, l logger and m intermediate update of FMI 3. An array that is given is < and
 * one that is filled in is >, followed by the bytes of an element (E: fmi2EventInfo; s: strings; x: binaries, whose sizes
 * are the parameter before) and the parameter that counts them, as a letter from a on (-: there is one). */
#ifndef DSE_FMU_BRIDGE_FUNCTIONS_H
#define DSE_FMU_BRIDGE_FUNCTIONS_H

#define FMI2_ACCESS(F, type, element) F(fmi2Get##type, "i<4ci>" element "c") F(fmi2Set##type, "i<4ci<" element "c")
#define FMI3_ACCESS(F, type, element) F(fmi3Get##type, "i<4ci>" element "ei") F(fmi3Set##type, "i<4ci<" element "ei")

#define FUNCTIONS(F) \
    F(fmi2Instantiate, "snsuLnn") F(fmi2FreeInstance, "i") F(fmi2Reset, "i") F(fmi2Terminate, "i") \
    F(fmi2SetupExperiment, "inddnd") F(fmi2EnterInitializationMode, "i") F(fmi2ExitInitializationMode, "i") \
    FMI2_ACCESS(F, Real, "8") FMI2_ACCESS(F, Integer, "4") FMI2_ACCESS(F, Boolean, "4") FMI2_ACCESS(F, String, "s") \
    F(fmi2GetFMUstate, "i>8-") F(fmi2SetFMUstate, "ii") F(fmi2FreeFMUstate, "i>8-") \
    F(fmi2SerializedFMUstateSize, "ii>8-") F(fmi2SerializeFMUstate, "ii>1di") F(fmi2DeSerializeFMUstate, "i<1ci>8-") \
    F(fmi2GetDirectionalDerivative, "i<4ci<4ei<8e>8c") F(fmi2SetRealInputDerivatives, "i<4ci<4c<8c") \
    F(fmi2DoStep, "iddn") \
    F(fmi2GetStatus, "in>4-") F(fmi2GetRealStatus, "in>8-") F(fmi2GetBooleanStatus, "in>4-") \
    F(fmi2EnterEventMode, "i") F(fmi2NewDiscreteStates, "i>E-") F(fmi2EnterContinuousTimeMode, "i") \
    F(fmi2SetTime, "id") F(fmi2SetContinuousStates, "i<8ci") F(fmi2GetContinuousStates, "i>8ci") \
    F(fmi2GetDerivatives, "i>8ci") F(fmi2GetEventIndicators, "i>8ci") F(fmi2GetNominalsOfContinuousStates, "i>8ci") \
    F(fmi2CompletedIntegratorStep, "in>4->4-") \
    F(fmi3InstantiateCoSimulation, "ssubbbb<4iiGlm") F(fmi3InstantiateModelExchange, "ssubbGl") \
    F(fmi3FreeInstance, "i") F(fmi3Reset, "i") F(fmi3Terminate, "i") \
    F(fmi3EnterInitializationMode, "ibddbd") F(fmi3ExitInitializationMode, "i") \
    F(fmi3EnterConfigurationMode, "i") F(fmi3ExitConfigurationMode, "i") F(fmi3EnterStepMode, "i") \
    F(fmi3EnterEventMode, "i") F(fmi3UpdateDiscreteStates, "i>1->1->1->1->1->8-") \
    F(fmi3EnterContinuousTimeMode, "i") \
    FMI3_ACCESS(F, Float64, "8") FMI3_ACCESS(F, Float32, "4") FMI3_ACCESS(F, Int64, "8") FMI3_ACCESS(F, UInt64, "8") \
    FMI3_ACCESS(F, Int32, "4") FMI3_ACCESS(F, UInt32, "4") FMI3_ACCESS(F, Int16, "2") FMI3_ACCESS(F, UInt16, "2") \
    FMI3_ACCESS(F, Int8, "1") FMI3_ACCESS(F, UInt8, "1") FMI3_ACCESS(F, Boolean, "1") FMI3_ACCESS(F, String, "s") \
    F(fmi3GetBinary, "i<4ci>8f>xfi") F(fmi3SetBinary, "i<4ci<8f<xfi") \
    F(fmi3GetClock, "i<4ci>1c") F(fmi3SetClock, "i<4ci<1c") \
    F(fmi3GetIntervalDecimal, "i<4ci>8c>4c") F(fmi3SetIntervalDecimal, "i<4ci<8c") \
    F(fmi3GetShiftDecimal, "i<4ci>8c") F(fmi3GetIntervalFraction, "i<4ci>8c>8c>4c") F(fmi3GetShiftFraction, "i<4ci>8c>8c") \
    F(fmi3GetFMUState, "i>8-") F(fmi3SetFMUState, "ii") F(fmi3FreeFMUState, "i>8-") \
    F(fmi3SerializedFMUStateSize, "ii>8-") F(fmi3SerializeFMUState, "ii>1di") F(fmi3DeserializeFMUState, "i<1ci>8-") \
    F(fmi3GetDirectionalDerivative, "i<4ci<4ei<8gi>8ii") \
    F(fmi3DoStep, "iddb>1->1->1->8-") \
    F(fmi3SetTime, "id") F(fmi3SetContinuousStates, "i<8ci") F(fmi3GetContinuousStates, "i>8ci") \
    F(fmi3GetContinuousStateDerivatives, "i>8ci") F(fmi3GetEventIndicators, "i>8ci") \
    F(fmi3GetNominalsOfContinuousStates, "i>8ci") F(fmi3CompletedIntegratorStep, "ib>1->1-") \
    F(fmi3GetNumberOfContinuousStates, "i>8-") F(fmi3GetNumberOfEventIndicators, "i>8-")

enum {
#define NUMBERED(name, parameters) NUMBER_OF_##name,
    FUNCTIONS(NUMBERED)
#undef NUMBERED
    N_FUNCTIONS
};

#endif
