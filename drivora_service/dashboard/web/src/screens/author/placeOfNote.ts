/** Returns the JSON pointer that a note begins with, and its other words; "": it has no place. */
export function placeOfNote(note: string): { pointer: string; words: string } {
  const found = /^(\/[^\s:]+): (.*)$/su.exec(note);
  return found?.[1] && found[2]
    ? { pointer: found[1], words: found[2] }
    : { pointer: "", words: note };
}
