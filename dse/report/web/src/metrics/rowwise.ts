// What works on numbers and row by row alike; words and meanings are those of dse/metrics/compiler.py.

/** A number, or one for each row; truth is 1, all else 0. */
export type Column = number | Float64Array;

type Rowwise = (x: Column, y?: Column, z?: Column) => Column;

/** *f* of up to three columns, which have the same rows; of numbers alone it is a number. */
function rowwise(f: (a: number, b: number, c: number) => number): Rowwise {
  return (x, y = 0, z = 0) => {
    const waveform = [x, y, z].find((each) => typeof each !== "number");
    if (!waveform) return f(at(x, 0), at(y, 0), at(z, 0));
    const made = new Float64Array((waveform as Float64Array).length);
    for (let row = 0; row < made.length; row++) made[row] = f(at(x, row), at(y, row), at(z, row));
    return made;
  };
}

const at = (x: Column, row: number): number => (typeof x === "number" ? x : x[row]!);

export const timeToCollision = rowwise((gap, closing) => (closing <= 0 ? Infinity : gap / closing));

/** By the words of the expression language. A comparison with NaN is false, also "!=". */
export const ROWWISE: Record<string, Rowwise> = {
  negative: rowwise((a) => -a),
  not: rowwise((a) => Number(a === 0)),
  is_true: rowwise((a) => Number(a !== 0)),
  select: rowwise((condition, yes, no) => (condition === 0 ? no : yes)),
  "+": rowwise((a, b) => a + b),
  "-": rowwise((a, b) => a - b),
  "*": rowwise((a, b) => a * b),
  "/": rowwise((a, b) => a / b),
  "^": rowwise(power),
  "<": rowwise((a, b) => Number(a < b)),
  "<=": rowwise((a, b) => Number(a <= b)),
  ">": rowwise((a, b) => Number(a > b)),
  ">=": rowwise((a, b) => Number(a >= b)),
  "==": rowwise((a, b) => Number(a === b)),
  "!=": rowwise((a, b) => Number(a < b || a > b)),
  and: rowwise((a, b) => Number(a !== 0 && b !== 0)),
  or: rowwise((a, b) => Number(a !== 0 || b !== 0)),
  xor: rowwise((a, b) => Number((a !== 0) !== (b !== 0))),
  implies: rowwise((a, b) => Number(a === 0 || b !== 0)),
  abs: rowwise(Math.abs),
  sqrt: rowwise(Math.sqrt),
  floor: rowwise(Math.floor),
  min: rowwise((a, b) => Math.min(a, b)),
  max: rowwise((a, b) => Math.max(a, b)),
};

// C's, where JavaScript's is NaN.
function power(a: number, b: number): number {
  return a === 1 || (a === -1 && Math.abs(b) === Infinity) ? 1 : a ** b;
}
