/** A sentence of the API, in which backticks enclose names of code. */
export function Prose({ text }: { readonly text: string }) {
  // Every second part stood between two backticks.
  return text.split("`").map((part, place) =>
    // biome-ignore lint/suspicious/noArrayIndexKey: the parts of a sentence never move
    place % 2 ? <code key={place}>{part}</code> : part,
  );
}
