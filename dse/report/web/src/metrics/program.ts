// Measures and judges a run from its waveforms, as `MetricProgram.evaluate` of dse/metrics/machine.py does.

import { FAIL, type Mark, NOT_EXERCISED, PASS } from "../marks";
import { margin, type Threshold } from "../verdicts";
import { FUNCTIONS, type Rows } from "./functions";
import { type Column, ROWWISE } from "./rowwise";

type Value = Column | Rows;
type Register = number;

interface Check extends Threshold {
  requirement: string;
  metric: Register;
  /** The condition under which it is exercised, and the metrics that the condition uses. */
  exercised: Register | null;
  conditionMetrics: Register[];
}

/** What `program_as_data` of dse/metrics/program_data.py writes; the time is in register 0. */
export interface MetricProgram {
  size: number;
  signals: Record<string, Register>;
  constants: Record<string, Register>;
  literals: [Register, number][];
  instructions: [word: string, target: Register, ...args: Register[]][];
  metrics: Record<string, Register>;
  checks: Check[];
}

/** By metric and by requirement. */
export interface Measured {
  metrics: Record<string, number>;
  verdicts: Record<string, Mark>;
  margins: Record<string, number>;
  /** The bound that each margin is to. */
  bounds: Record<string, number>;
}

/**
 * The metrics of a run, and a verdict on each requirement with its margin; all in SI, NaN where undefined. Truth values
 * are given as 0 and 1, items of enumerations by their numbers. Throws if a waveform, a value or a function is missing.
 */
export function runProgram(
  program: MetricProgram,
  times: Float64Array,
  waveforms: Readonly<Record<string, Float64Array>>,
  values: Readonly<Record<string, number>>,
): Measured {
  const registers = registersOf(program, times, waveforms, values);
  const number = (register: Register): number => registers[register] as number;
  const found: Measured = { metrics: {}, verdicts: {}, margins: {}, bounds: {} };
  for (const [name, register] of Object.entries(program.metrics)) found.metrics[name] = number(register);
  for (const check of program.checks) {
    const value = number(check.metric);
    const by = margin(value, check);
    found.margins[check.requirement] = by;
    found.bounds[check.requirement] = by === value - (check.atLeast ?? NaN) ? check.atLeast! : (check.atMost ?? NaN);
    found.verdicts[check.requirement] = !isExercised(check, number) ? NOT_EXERCISED : by >= 0 ? PASS : FAIL;
  }
  return found;
}

/** The value of a *program* over single *values* alone, as `RowProgram.rows` of dse/metrics/rows.py gives one row. */
export function evaluate(program: MetricProgram, values: Readonly<Record<string, number>>): number {
  const registers = registersOf(
    { ...program, signals: {}, constants: program.signals },
    new Float64Array(1),
    {},
    values,
  );
  return registers[program.metrics.value!] as number;
}

function registersOf(
  program: MetricProgram,
  times: Float64Array,
  waveforms: Readonly<Record<string, Float64Array>>,
  values: Readonly<Record<string, number>>,
): Value[] {
  const registers: Value[] = new Array(program.size);
  registers[0] = times;
  for (const [register, value] of program.literals) registers[register] = value;
  for (const [name, register] of Object.entries(program.signals)) registers[register] = known(waveforms, name);
  for (const [name, register] of Object.entries(program.constants)) registers[register] = known(values, name);
  for (const [word, target, ...args] of program.instructions) {
    const step = known(STEPS, word) as (...values: Value[]) => Value;
    registers[target] = step(...args.map((register) => registers[register]!));
  }
  return registers;
}

const STEPS = { ...ROWWISE, ...FUNCTIONS };

/** Nothing follows from an undefined metric, not even by "not". */
function isExercised(check: Check, number: (register: Register) => number): boolean {
  if (check.exercised === null) return !Number.isNaN(number(check.metric));
  return !check.conditionMetrics.some((register) => Number.isNaN(number(register))) && number(check.exercised) !== 0;
}

function known<T>(things: Readonly<Record<string, T>>, name: string): T {
  if (!Object.hasOwn(things, name)) throw new Error(`a metric needs '${name}', which is missing`);
  return things[name]!;
}
