// Numbers as text: a true minus sign, digits that fit the range of a column, nothing that depends on the locale.

export function number(value: number, digits = 4): string {
  if (Number.isNaN(value)) return "undefined";
  if (!Number.isFinite(value)) return value > 0 ? "\u221e" : "\u2212\u221e";
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(digits));
  const text =
    size !== 0 && (size >= 1e7 || size < 1e-4)
      ? value.toExponential(digits - 1).replace(/\.?0*e\+?/, "e")
      : Math.abs(rounded) >= 10 ** digits
        ? value.toFixed(0)
        : String(rounded);
  return minus(text);
}

/** A formatter with the same number of decimals for every value of a column. */
export function columnText(values: Float64Array): (value: number) => string {
  let largest = 0;
  let whole = true;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    largest = Math.max(largest, Math.abs(value));
    whole &&= Number.isInteger(value);
  }
  if (largest >= 1e6 || (largest > 0 && largest < 1e-3)) return (value) => number(value, 4);
  const decimals = whole || largest === 0 ? 0 : Math.min(6, Math.max(0, 3 - Math.floor(Math.log10(largest))));
  return (value) => {
    if (!Number.isFinite(value)) return number(value);
    const text = value.toFixed(decimals);
    // A small value beside a bound must not look like zero.
    return Number(text) === 0 && value !== 0 ? number(value, 1) : minus(text);
  };
}

// Of a value with an error bar; a bar below them is rounding.
const MOST_DIGITS = 10;

/** A value and its error bar of two digits, the value to the bar's last digit; `text` is for what has no bar. */
export function checked(value: number, error: number | null, text: (value: number) => string): string {
  if (error === null || !Number.isFinite(value)) return text(value);
  const sign = " \u00b1\u202f";
  if (Number.isNaN(error)) return `${text(value)}${sign}?`;
  if (error === 0 || error === Infinity) return text(value) + sign + number(error);
  const decimals = 1 - Math.floor(Math.log10(error));
  const digits = decimals + Math.floor(Math.log10(Math.max(Math.abs(value), error))) + 1;
  if (decimals < 0 || digits > MOST_DIGITS) return number(value, MOST_DIGITS) + sign + number(error, 2);
  return minus(value.toFixed(decimals)) + sign + error.toFixed(decimals);
}

// Marks that turn the direction of the text after them.
const TURNING = /[\u200e\u200f\u061c\u202a-\u202e\u2066-\u2069]/g;

/** *text* without marks that turn around what stands after them. */
export function straight(text: string): string {
  return text.replace(TURNING, "");
}

/** *text* without marks that turn it around, and with an ellipsis after its first *most* letters. */
export function shortened(text: string, most: number): string {
  const letters = Array.from(straight(text.slice(0, 4 * most)));
  return letters.length > most
    ? `${letters
        .slice(0, most - 1)
        .join("")
        .trimEnd()}\u2026`
    : letters.join("");
}

export function withUnit(text: string, unit: string): string {
  return unit ? `${text}\u202f${unit}` : text;
}

export function percent(part: number, whole: number): string {
  if (!whole) return "0\u202f%";
  const share = (100 * part) / whole;
  const text =
    share > 0 && share < 0.1
      ? "<0.1"
      : share < 100 && share > 99.9
        ? ">99.9"
        : share.toFixed(share < 10 || (share >= 98.5 && share < 100) ? 1 : 0);
  return `${text}\u202f%`;
}

export function count(value: number, singular: string): string {
  return `${group(value)} ${singular}${value === 1 ? "" : "s"}`;
}

export function group(value: number): string {
  return String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

function minus(text: string): string {
  return text.replace(/-/g, "\u2212");
}
