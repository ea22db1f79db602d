import type { Schemas } from "../api/client";

type Definition = Schemas["StatedDefinition"];

/** The violations that can count as failures, in words. */
export const COUNTED_WORDS: Readonly<Record<Schemas["Counted"], string>> = {
  accountable: "that an ego is accountable for",
  preventable: "that an ego is accountable for, or a careful driver avoids",
  at_fault: "that an ego is accountable for, or at fault in",
  possibly_at_fault: "not known to be another's fault",
  any: "of any fault",
};

const ORIGINS: Readonly<Record<Definition["origin"], string>> = {
  request: "as chosen here",
  posted: "as defined where the runs were posted",
  default: "the default",
};

/** Returns what numbers count, in a sentence. */
export function definitionSentence({ words, origin }: Definition): string {
  return `Failures are ${words}: ${ORIGINS[origin]}.`;
}

/** Returns one of the words of `counts`; undefined for another text. */
export function countedOf(word: string): Schemas["Counted"] | undefined {
  return word in COUNTED_WORDS ? (word as Schemas["Counted"]) : undefined;
}

/** The choices of a control that switches what counts; the first leaves it as it was defined. */
export const COUNTED_CHOICES: readonly { readonly value: string; readonly text: string }[] = [
  { value: "", text: "as defined for the runs" },
  ...Object.entries(COUNTED_WORDS).map(([value, text]) => ({ value, text })),
];
