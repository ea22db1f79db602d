import type { Json } from "./pointers";

/** Returns a value as the text of its field. */
export function textOf(value: Json | undefined): string {
  if (value === undefined || value === null) return "";
  if (typeof value === "string") return value;
  if (Array.isArray(value) && value.every((item) => typeof item !== "object"))
    return value.join(", ");
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

/**
 * Returns what was typed as a number; "" is no value.
 *
 * What is no number stays the text that it is: who reads the document says what is wrong with it,
 * and nothing that was typed is lost.
 */
export function numberTyped(text: string): number | string | undefined {
  const trimmed = text.trim();
  if (trimmed === "") return undefined;
  const value = Number(trimmed);
  return Number.isFinite(value) ? value : trimmed;
}

/** Returns what was typed as a list, separated by commas; "" is no value. */
export function listTyped(text: string, ofNumbers: boolean): readonly Json[] | undefined {
  const parts = text
    .split(",")
    .map((part) => part.trim())
    .filter(Boolean);
  if (parts.length === 0) return undefined;
  return ofNumbers ? parts.map((part) => numberTyped(part) ?? part) : parts;
}

/** Returns what was typed as JSON; text that is not JSON stays text. */
export function jsonTyped(text: string): Json | undefined {
  if (text.trim() === "") return undefined;
  try {
    return JSON.parse(text) as Json;
  } catch {
    return text;
  }
}

/**
 * Returns the next number up or down within the bounds.
 *
 * A step is 1 for whole numbers, and for others a tenth of their size: 0.4 goes to 0.5, 12 to 13.
 */
export function stepped(
  value: number,
  direction: 1 | -1,
  {
    isWhole,
    least = Number.NEGATIVE_INFINITY,
    most = Number.POSITIVE_INFINITY,
  }: { isWhole: boolean; least?: number | undefined; most?: number | undefined },
): number {
  const size = Math.abs(value) || 1;
  const step = isWhole ? 1 : 10 ** Math.min(Math.floor(Math.log10(size)) - (size < 1 ? 0 : 1), 0);
  const next = isWhole ? Math.round(value) + direction : value + direction * step;
  const digits = isWhole ? 0 : Math.max(0, Math.ceil(-Math.log10(step)) + 1);
  return Math.min(Math.max(Number(next.toFixed(Math.min(digits, 12))), least), most);
}

/** Returns whether two values of JSON are equal, in whatever order their keys are. */
export function isSame(a: Json | undefined, b: Json | undefined): boolean {
  if (a === b) return true;
  if (typeof a !== "object" || typeof b !== "object" || a === null || b === null) return false;
  if (Array.isArray(a) !== Array.isArray(b)) return false;
  const [first, second] = [a as Record<string, Json>, b as Record<string, Json>];
  const keys = Object.keys(first);
  return (
    keys.length === Object.keys(second).length &&
    keys.every((key) => key in second && isSame(first[key], second[key]))
  );
}
